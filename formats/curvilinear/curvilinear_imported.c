#include "formats/curvilinear/curvilinear_imported.h"

#include <string.h>

#include "formats/base/name_list.h"
#include "formats/base/text.h"
#include "formats/curvilinear/curvilinear_stream.h"
#include "formats/input/foreign.h"
#include "formats/input/importing.h"

typedef struct imported {
    mem *m;
    importing at;
    json_t *list;    /* what import-X --list told */
    uint32_t *field; /* of the list: each that can be taken */
    uint32_t fields;
    uint32_t *taken; /* of `field` */
    uint32_t taken_count;
    uint32_t (*nodes)[3];
    uint32_t steps;
    double *times;              /* NULL: unknown */
    curvilinear_stream *stream; /* of the step, with the fields that are taken; NULL: not yet */
} imported;

/* ---- what its importer tells ---- */

static const char *const importers[] = {"cgns", "netcdf"};
enum { BY_ITSELF = 1, IMPORTERS = 2 }; /* the first ones need not be asked for */

static const foreign_format *format_of(const char *path, const uint8_t *start, size_t size,
                                       int count) {
    const foreign_format *f = foreign_find(path, start, size, UINT64_MAX);
    for (int i = 0; i < count && f && f->importer; i++)
        if (strcmp(f->importer, importers[i]) == 0)
            return f;
    return NULL;
}

static bool known(const char *path, const uint8_t *start, size_t size, uint64_t bytes) {
    (void)bytes;
    return format_of(path, start, size, BY_ITSELF) != NULL;
}

bool curvilinear_imported_is(mem *m, const char *path, const uint8_t *start, size_t size,
                             const input_trust *trust) {
    const foreign_format *f = format_of(path, start, size, BY_ITSELF);
    importing at = {0};
    json_t *list = NULL;
    if (!f)
        return false;
    status st = importing_init(&at, m, f, path);
    if (trust)
        at.trust = *trust;
    if (st == ST_OK)
        st = importing_list(&at, &list);
    const bool is = st == ST_OK && json_array_size(json_object_get(list, "zones")) > 0;
    json_decref(list);
    importing_release(&at);
    return is;
}

static const json_t *item_of(const imported *x, uint32_t field) {
    return json_array_get(json_object_get(x->list, "fields"), x->field[field]);
}

/* Returns whether an entry of the list can be taken: it is of the nodes, or of the cells. */
static bool fits(const imported *x, const json_t *item) {
    return json_string_value(json_object_get(item, "name")) &&
           json_is_true(json_object_get(item, "readable")) &&
           json_is_true(json_object_get(item, "of_cells")) == x->at.cells_to_points;
}

/* No field is of the nodes, or of the cells, as asked: name those of the others. */
static status refuse_fields(const imported *x) {
    name_list names = {0};
    const json_t *all = json_object_get(x->list, "fields");
    const char *name;
    for (size_t i = 0; i < json_array_size(all); i++)
        if ((name = json_string_value(json_object_get(json_array_get(all, i), "name"))))
            name_list_add(&names, name);
    return status_describe(ST_USAGE,
                           x->at.cells_to_points
                               ? "%s: no field of the cells; of the nodes it has %s"
                               : "%s: no field of the nodes; of the cells it has %s "
                                 "(--cells-to-points averages one to the nodes)",
                           x->at.path, name_list_print(&names));
}

/* Find the fields that can be taken; the one that the importer would take comes first. */
static status find_fields(imported *x) {
    const json_t *all = json_object_get(x->list, "fields");
    x->field = mem_array(x->m, json_array_size(all) + 1, sizeof *x->field);
    for (int taken = 1; x->field && taken >= 0; taken--)
        for (size_t i = 0; i < json_array_size(all); i++) {
            const json_t *item = json_array_get(all, i);
            if (fits(x, item) && json_is_true(json_object_get(item, "taken")) == (taken == 1))
                x->field[x->fields++] = (uint32_t)i;
        }
    if (x->field && x->fields == 0 && json_array_size(all) > 0)
        return refuse_fields(x);
    return x->field ? ST_OK : ST_NOMEM;
}

static status find_zones(imported *x, const char *format) {
    const json_t *zones = json_object_get(x->list, "zones");
    const size_t count = json_array_size(zones);
    if (count == 0)
        return status_describe(ST_UNSUPPORTED,
                               "%s: this is %s without any structured zone of its own", x->at.path,
                               format);
    x->nodes = mem_array(x->m, count, sizeof *x->nodes);
    for (size_t z = 0; x->nodes && z < count; z++)
        for (size_t a = 0; a < 3; a++)
            x->nodes[z][a] =
                (uint32_t)json_integer_value(json_array_get(json_array_get(zones, z), a));
    return x->nodes ? ST_OK : ST_NOMEM;
}

/* Times are told of all fields, or of the one that is taken. */
static status find_steps(imported *x) {
    const json_t *item = x->fields ? item_of(x, 0) : NULL;
    const json_t *times = json_object_get(x->list, "times");
    x->steps = importing_steps(item);
    return importing_times(x->m, times ? times : json_object_get(item, "times"), x->steps,
                           &x->times);
}

/* ---- opening ---- */

static void close_file(void *state) {
    imported *x = state;
    if (!x)
        return;
    curvilinear_stream_close(x->stream);
    json_decref(x->list);
    mem_free(x->m, x->field);
    mem_free(x->m, x->taken);
    mem_free(x->m, x->nodes);
    mem_free(x->m, x->times);
    importing_release(&x->at);
    mem_free(x->m, x);
}

/* What is to be placed is netCDF whatever its file is called, as wrfout_d01: HDF5, too. */
static bool may_be_netcdf(const uint8_t *start, size_t size) {
    return size >= 4 && (memcmp(start, "CDF", 3) == 0 || memcmp(start, "\x89HDF", 4) == 0);
}

static status find_format(const curvilinear_opening *o, const foreign_format **out) {
    const uint8_t *start;
    size_t size;
    const char *kind = byte_stream_kind(o->data), *named = kind;
    status st = byte_stream_peek(o->data, FOREIGN_PEEK, &start, &size);
    if (st != ST_OK)
        return st;
    if (o->hints.to && may_be_netcdf(start, size))
        named = "F.nc";
    *out = format_of(named, start, size, o->hints.to ? IMPORTERS : BY_ITSELF);
    const foreign_format *any = foreign_find(kind, start, size, UINT64_MAX);
    if (!*out || (o->hints.to && strcmp((*out)->importer, importers[IMPORTERS - 1]) != 0))
        return status_describe(ST_USAGE, "%s: --to: this is %s, expected netCDF",
                               byte_stream_name(o->data), any ? any->name : "of no known format");
    if (strcmp(byte_stream_path(o->data), "-") != 0 && strcmp(byte_stream_path(o->data), kind) == 0)
        return ST_OK;
    return status_describe(ST_UNSUPPORTED,
                           "%s: this is %s, whose library needs a file that is not packed",
                           byte_stream_name(o->data), (*out)->name);
}

/* Ask for the list again where a field decides which grid it is of. */
static status ask(imported *x, const curvilinear_opening *o) {
    const char *const one[1] = {o->hints.field};
    status st = o->hints.to && o->hints.field ? importing_take(&x->at, one, 1) : ST_OK;
    return st == ST_OK ? importing_list(&x->at, &x->list) : st;
}

static status open_list(imported *x, const curvilinear_opening *o, const foreign_format *f) {
    status st = importing_init(&x->at, x->m, f, byte_stream_path(o->data));
    x->at.step = o->hints.step;
    x->at.trust = o->hints.trust;
    x->at.cells_to_points = o->hints.cells_to_points && !o->hints.to;
    x->at.to = o->hints.to;
    x->at.exaggerate = o->hints.to ? o->hints.exaggerate : 0;
    x->at.zones = !o->hints.to;
    if (st == ST_OK)
        st = ask(x, o);
    if (st == ST_OK)
        st = find_fields(x);
    if (st == ST_OK)
        st = find_zones(x, f->name);
    return st == ST_OK ? find_steps(x) : st;
}

static void show(curvilinear_opening *o, const imported *x) {
    const char *name = json_string_value(json_object_get(x->list, "name"));
    o->zones = (uint32_t)json_array_size(json_object_get(x->list, "zones"));
    o->nodes = (const uint32_t(*)[3])x->nodes;
    o->blanked = json_is_true(json_object_get(x->list, "blanked"));
    o->still = json_is_true(json_object_get(x->list, "still"));
    o->fields = x->fields;
    const char *unit =
        x->fields ? json_string_value(json_object_get(item_of(x, 0), "time_unit")) : NULL;
    text_name(o->time_unit, sizeof o->time_unit, unit ? unit : "");
    text_name(o->name, sizeof o->name, name ? name : "");
}

static status open_file(curvilinear_opening *o, void **state) {
    const foreign_format *f = NULL;
    status st = find_format(o, &f);
    if (st != ST_OK)
        return st;
    imported *x = *state = mem_zalloc(o->m, sizeof *x);
    if (!x)
        return ST_NOMEM;
    x->m = o->m;
    st = open_list(x, o, f);
    o->format = f->name;
    if (st == ST_OK)
        show(o, x);
    return st;
}

/* ---- fields and steps ---- */

static const char *field(void *state, uint32_t number, uint32_t *components) {
    const imported *x = state;
    *components = 1;
    return json_string_value(json_object_get(item_of(x, number), "name"));
}

static const char *refused(void *state, const char *name) {
    const imported *x = state;
    const json_t *all = json_object_get(x->list, "fields");
    for (size_t i = 0; i < json_array_size(all); i++) {
        const json_t *item = json_array_get(all, i);
        const char *its = json_string_value(json_object_get(item, "name"));
        if (its && strcmp(its, name) == 0)
            return json_string_value(json_object_get(item, "why"));
    }
    return NULL;
}

static void drop_stream(imported *x) {
    curvilinear_stream_close(x->stream);
    x->stream = NULL;
}

static status take(void *state, const uint32_t *fields, uint32_t count) {
    imported *x = state;
    if (count == x->taken_count && x->taken &&
        memcmp(fields, x->taken, count * sizeof *fields) == 0)
        return ST_OK;
    drop_stream(x);
    mem_free(x->m, x->taken);
    x->taken_count = 0;
    x->taken = mem_array(x->m, (size_t)count + 1, sizeof *x->taken);
    if (!x->taken)
        return ST_NOMEM;
    memcpy(x->taken, fields, count * sizeof *fields);
    x->taken_count = count;
    return ST_OK;
}

static uint32_t tell_steps(const void *state, const double **times) {
    const imported *x = state;
    *times = x->times;
    return x->steps;
}

static status seek_step(curvilinear_opening *o, void *state) {
    imported *x = state;
    drop_stream(x);
    x->at.step = o->hints.step;
    show(o, x);
    return ST_OK;
}

/* ---- planes ---- */

/* Whether a step is what the list has said of the grid. */
static status check_stream(const imported *x) {
    const curvilinear_stream_header h = curvilinear_stream_header_of(x->stream);
    if (h.zones == json_array_size(json_object_get(x->list, "zones")) &&
        memcmp(h.nodes, x->nodes, h.zones * sizeof *x->nodes) == 0 &&
        h.field_count == x->taken_count &&
        h.blanked == json_is_true(json_object_get(x->list, "blanked")))
        return ST_OK;
    return status_describe(ST_CORRUPT, "%s: step %u has other zones, expected those of the first",
                           x->at.path, x->at.step);
}

/* Name what is taken, each field once, to the importer. */
static status name_fields(imported *x) {
    const char **names = mem_array(x->m, (size_t)x->taken_count + 1, sizeof *names);
    uint32_t components;
    if (!names)
        return ST_NOMEM;
    for (uint32_t i = 0; i < x->taken_count; i++)
        names[i] = field(x, x->taken[i], &components);
    const status st = importing_take(&x->at, names, x->taken_count);
    mem_free(x->m, names);
    return st;
}

static status import(imported *x) {
    static const char *const words[3] = {"-o", "-", NULL};
    byte_stream *data = NULL;
    if (x->stream)
        return ST_OK;
    status st = name_fields(x);
    if (st == ST_OK)
        st = importing_stream(&x->at, words, NULL, NULL, &data);
    if (st == ST_OK)
        st = curvilinear_stream_open(x->m, data, &x->stream);
    byte_stream_close(data);
    if (st == ST_OK)
        st = check_stream(x);
    if (st != ST_OK)
        drop_stream(x);
    return st;
}

static status places(void *state, uint32_t zone, uint32_t first, uint32_t count, float (*p)[3]) {
    imported *x = state;
    const status st = import(x);
    return st == ST_OK ? curvilinear_stream_read_places(x->stream, zone, first, count, p) : st;
}

static status values(void *state, uint32_t zone, uint32_t number, uint32_t component,
                     uint32_t first, uint32_t count, float *to) {
    imported *x = state;
    uint32_t k = 0;
    (void)component;
    const status st = import(x);
    while (st == ST_OK && x->taken[k] != number)
        k++;
    return st == ST_OK ? curvilinear_stream_read_values(x->stream, zone, k, first, count, to) : st;
}

static status blanks(void *state, uint32_t zone, uint32_t first, uint32_t count, uint8_t *is_node) {
    imported *x = state;
    const status st = import(x);
    return st == ST_OK ? curvilinear_stream_read_blanks(x->stream, zone, first, count, is_node)
                       : st;
}

const curvilinear_reader curvilinear_imported_reader = {.format = "imported",
                                                        .library = true,
                                                        .known = known,
                                                        .open = open_file,
                                                        .close = close_file,
                                                        .field = field,
                                                        .refused = refused,
                                                        .take = take,
                                                        .places = places,
                                                        .values = values,
                                                        .blanks = blanks,
                                                        .steps = tell_steps,
                                                        .seek = seek_step};
