#include "formats/mesh/mesh_imported.h"

#include <string.h>

#include "formats/base/text.h"
#include "formats/input/foreign.h"
#include "formats/input/importing.h"
#include "formats/mesh/mesh_choice.h"
#include "formats/mesh/mesh_stream.h"

typedef struct imported {
    mem *m;
    const mesh_source *source;
    importing at;
    json_t *list; /* what import-X --list told */
    uint32_t steps;
    double *times;    /* NULL: unknown */
    mesh_hints hints; /* of the stream, whose fields have been chosen */
} imported;

static bool known(const char *path, const uint8_t *start, size_t size) {
    const foreign_format *f = foreign_find(path, start, size, UINT64_MAX);
    return f && f->importer && f->mesh;
}

/* ---- its fields ---- */

static const json_t *fields_of(const imported *x) {
    return json_object_get(x->list, "fields");
}

static const char *name_of(const imported *x, size_t i) {
    return json_string_value(json_object_get(json_array_get(fields_of(x), i), "name"));
}

static status read_steps(imported *x) {
    x->steps = importing_steps(json_array_get(fields_of(x), 0));
    return importing_times(x->m, json_object_get(x->list, "times"), x->steps, &x->times);
}

static bool of_cells(const imported *x, size_t i) {
    return json_is_true(json_object_get(json_array_get(fields_of(x), i), "of_cells"));
}

/* Returns whether field i can be taken as the hints ask: it is of the points, or of the cells. */
static bool fits(const imported *x, size_t i) {
    return name_of(x, i) && of_cells(x, i) == x->source->hints.cells_to_points;
}

static bool is_there(const imported *x, const char *name) {
    bool is = false;
    for (size_t i = 0; i < json_array_size(fields_of(x)); i++)
        is =
            is || (fits(x, i) && (!name || text_same_name(name, name_of(x, i), MESH_NAME_MAX + 1)));
    return is;
}

static status check_field(const imported *x, const char *name) {
    mesh_hints asked = x->source->hints;
    name_list points = {0}, cells = {0};
    asked.field = name;
    for (size_t i = 0; i < json_array_size(fields_of(x)); i++)
        if (name_of(x, i))
            name_list_add(of_cells(x, i) ? &cells : &points, name_of(x, i));
    const status st =
        is_there(x, name) ? ST_OK : mesh_choice_missing(x->source->path, &asked, &points, &cells);
    if (st != ST_OK)
        return st;
    return mesh_choice_component(x->source->path, &asked, name ? name : "", 1);
}

static status take_fields(void *state, const char *const *names, uint32_t count) {
    imported *x = state;
    status st = ST_OK;
    for (uint32_t i = 0; i < count && st == ST_OK; i++)
        st = check_field(x, names[i]);
    return st == ST_OK ? importing_take(&x->at, names, count) : st;
}

static void tell_fields(const void *state, mesh_field_taker *take, void *ctx) {
    const imported *x = state;
    for (size_t i = 0; i < json_array_size(fields_of(x)); i++)
        if (fits(x, i))
            take(ctx, name_of(x, i), 1);
}

static uint32_t tell_steps(const void *state, const double **times) {
    const imported *x = state;
    *times = x->times;
    return x->steps;
}

/* ---- opening and reading ---- */

static void close_file(void *state) {
    imported *x = state;
    if (!x)
        return;
    json_decref(x->list);
    mem_free(x->m, x->times);
    importing_release(&x->at);
    mem_free(x->m, x);
}

static status open_file(mesh_source *source, void **state) {
    const uint8_t *bytes;
    size_t size;
    status st = byte_stream_peek(source->data, FOREIGN_PEEK, &bytes, &size);
    if (st != ST_OK)
        return st;
    const char *kind = byte_stream_kind(source->data);
    const foreign_format *f = foreign_find(kind, bytes, size, UINT64_MAX);
    if (strcmp(source->path, "-") == 0 || strcmp(source->path, kind) != 0)
        return status_describe(ST_UNSUPPORTED,
                               "%s: this is %s, whose library needs a file that is not packed",
                               byte_stream_name(source->data), f->name);
    source->format = f->name;
    imported *x = *state = mem_zalloc(source->m, sizeof *x);
    if (!x)
        return ST_NOMEM;
    x->m = source->m;
    x->source = source;
    st = importing_init(&x->at, x->m, f, source->path);
    x->at.step = source->hints.step;
    x->at.trust = source->hints.trust;
    x->at.by_corners = source->hints.by_corners;
    x->at.cells_to_points = source->hints.cells_to_points;
    if (st == ST_OK)
        st = importing_list(&x->at, &x->list);
    const char *name = json_string_value(json_object_get(x->list, "name"));
    if (st == ST_OK && name)
        text_name(source->name, sizeof source->name, name);
    return st == ST_OK ? read_steps(x) : st;
}

/* Read the stream of an importer that has begun. */
static status read_stream(imported *x, byte_stream *data, mesh_feed *feed) {
    mesh_source stream = {.m = x->m, .path = x->source->path, .data = data, .hints = x->hints};
    const uint32_t count = x->at.field_count ? (uint32_t)x->at.field_count : 1;
    const char *const none[1] = {NULL};
    void *state = NULL;
    status st = mesh_stream_reader.open(&stream, &state);
    if (st == ST_OK)
        st = mesh_stream_reader.take(
            state, x->at.field_count ? (const char *const *)x->at.fields : none, count);
    if (st == ST_OK)
        st = mesh_stream_reader.read(state, feed);
    mesh_stream_reader.close(state);
    return st;
}

static status read_file(void *state, mesh_feed *feed) {
    static const char *const words[3] = {"-o", "-", NULL};
    imported *x = state;
    byte_stream *data = NULL;
    status st = importing_stream(&x->at, words, NULL, NULL, &data);
    if (st == ST_OK)
        st = read_stream(x, data, feed);
    byte_stream_close(data);
    return st;
}

const mesh_reader mesh_imported_reader = {
    .format = "imported",
    .known = known,
    .open = open_file,
    .read = read_file,
    .close = close_file,
    .take = take_fields,
    .fields = tell_fields,
    .steps = tell_steps,
};
