#include "formats/grid/imported.h"

#include <dirent.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/sibling.h"
#include "formats/grid/heights_slices.h"
#include "formats/grid/imported_chunks.h"
#include "formats/grid/layout_slices.h"
#include "formats/grid/nrrd.h"
#include "formats/grid/sample_place.h"
#include "formats/grid/tile_stream.h"
#include "formats/input/foreign.h"
#include "formats/input/importing.h"

typedef struct import {
    importing at;
    char place[GRID_PLACE_MAX], fields[GRID_FIELDS_MAX];
    uint32_t dims[3];
    sample_type type; /* of the grid's samples in a treelet file */
    imported_chunks chunks;
} import;

static void close_import(void *ctx) {
    import *x = ctx;
    mem *m = x->at.m;
    imported_chunks_release(&x->chunks);
    importing_release(&x->at);
    mem_free(m, x);
}

static status open_import(mem *m, const foreign_format *f, const char *path,
                          const volume_hints *hints, import **out, byte_stream **data) {
    static const char *const samples[3] = {"--tiles", "-o", "-"};
    import *x = mem_zalloc(m, sizeof *x);
    if (!x)
        return ST_NOMEM;
    status st = importing_init(&x->at, m, f, path);
    if (st == ST_OK)
        st = importing_take(&x->at, &hints->field, 1);
    if (st != ST_OK) {
        close_import(x);
        return st;
    }
    x->at.component = hints->component;
    x->at.step = hints->step;
    x->at.trust = hints->trust;
    *out = x;
    return importing_stream(&x->at, samples, close_import, x, data);
}

/* ---- what fields there are ---- */

/* Tell the fields that can be read. */
static status tell_items(mem *m, const json_t *items, const slice_fields *to) {
    status st = ST_OK;
    for (size_t i = 0; st == ST_OK && i < json_array_size(items); i++) {
        const json_t *item = json_array_get(items, i);
        const char *name = json_string_value(json_object_get(item, "name"));
        slice_field one = {.name = name,
                           .steps = importing_steps(item),
                           .taken = json_is_true(json_object_get(item, "taken"))};
        one.components = (uint32_t)json_integer_value(json_object_get(item, "components"));
        one.component = (uint32_t)json_integer_value(json_object_get(item, "component"));
        one.colours = json_is_true(json_object_get(item, "colours"));
        double *times = NULL;
        if (!name || !json_is_true(json_object_get(item, "readable")))
            continue;
        st = importing_times(m, json_object_get(item, "times"), one.steps, &times);
        one.times = times;
        one.time_unit = json_string_value(json_object_get(item, "time_unit"));
        if (st == ST_OK)
            st = to->take(to->ctx, &one);
        if (times)
            mem_free(m, times);
    }
    return st;
}

static status tell_fields(void *ctx, const slice_fields *to) {
    import *x = ctx;
    json_t *root = json_loads(x->fields, 0, NULL);
    status st = ST_OK;
    if (!json_is_array(json_object_get(root, "fields"))) {
        json_decref(root);
        st = importing_list(&x->at, &root);
    }
    if (st == ST_OK)
        st = tell_items(x->at.m, json_object_get(root, "fields"), to);
    json_decref(root);
    return st;
}

/* Start the importer again, which tells where the chunks are. */
static status ask_for_chunks(import *x, sample_place *out) {
    static const char *const words[3] = {"--chunks", "-o", "-"};
    byte_stream *s = NULL;
    status st = importing_stream(&x->at, words, NULL, NULL, &s);
    x->chunks.m = x->at.m;
    if (st == ST_OK)
        st = imported_chunks_read(s, x->at.path, x->dims, x->type, &x->chunks, out);
    byte_stream_close(s);
    return st;
}

static bool find_place(void *ctx, sample_place *out) {
    import *x = ctx;
    const size_t refused = sizeof SAMPLE_PLACE_REFUSED - 1;
    *out = (sample_place){.path = x->at.path};
    if (strncmp(x->place, SAMPLE_PLACE_REFUSED, refused) == 0)
        out->refused = x->place + refused;
    else if (sample_place_is_chunks(x->place) && ask_for_chunks(x, out) != ST_OK)
        out->refused = status_text();
    else if (!out->chunks && !sample_place_parse(x->place, out))
        return false;
    out->path = x->at.path;
    return true;
}

/* Open what the importer writes: NRRD, or a tile stream where it knows of quiet parts. */
static status open_slices(mem *m, const foreign_format *f, const char *path,
                          const volume_hints *hints, slice_source *out) {
    volume_layout l = {.m = m};
    uint8_t quiet[SLICE_SAMPLE_MAX];
    bool tiles = false;
    import *x = NULL;
    status st = open_import(m, f, path, hints, &x, &l.data);
    if (st == ST_OK)
        st = tile_stream_known(&l, &tiles, quiet);
    if (st == ST_OK)
        st = nrrd_reader.layout(&l, hints);
    if (st == ST_OK) /* the importer has applied the hints */
        st = volume_layout_settle(&l, &(volume_hints){0});
    if (st == ST_OK && !tiles && (hints->heights || l.g.terrain))
        heights_layout(&l);
    if (st == ST_OK)
        st = volume_layout_check(&l);
    if (st == ST_OK) {
        memcpy(x->place, l.g.place, sizeof x->place);
        memcpy(x->fields, l.g.fields, sizeof x->fields);
        memcpy(x->dims, l.g.dims, sizeof x->dims);
        x->type = sample_stored(l.g.type);
    }
    if (st == ST_OK)
        st = tiles ? tile_stream_open(&l, quiet, out) : layout_slices_open(&l, out);
    volume_layout_release(&l);
    out->format = f->name;
    out->importer = f->importer;
    out->has_fields = true;
    out->fields = tell_fields;
    out->fields_ctx = x;
    out->place = find_place;
    out->place_ctx = x;
    return st;
}

/* ---- a file ---- */

static bool known(const char *path, const uint8_t *start_, size_t size) {
    const foreign_format *f = foreign_find(path, start_, size, UINT64_MAX);
    return f && f->importer && !f->mesh;
}

static status open_file(volume_layout *l, const volume_hints *hints, slice_source *out) {
    const uint8_t *bytes;
    size_t size;
    status st = byte_stream_peek(l->data, FOREIGN_PEEK, &bytes, &size);
    if (st != ST_OK)
        return st;
    const char *kind = byte_stream_kind(l->data);
    const foreign_format *f = foreign_find(kind, bytes, size, UINT64_MAX);
    if (strcmp(l->path, "-") == 0 || strcmp(l->path, kind) != 0)
        return status_describe(ST_UNSUPPORTED,
                               "%s: this is %s, whose library needs a file that is not packed",
                               byte_stream_name(l->data), f->name);
    return open_slices(l->m, f, l->path, hints, out);
}

const grid_reader imported_reader = {.format = "imported", .known = known, .slices = open_file};

/* ---- a folder ---- */

static const foreign_format *format_of(mem *m, const char *folder, const char *name) {
    char path[SIBLING_PATH];
    const foreign_format *f = NULL;
    const uint8_t *bytes;
    size_t size;
    byte_stream *s = NULL;
    if (snprintf(path, sizeof path, "%s/%s", folder, name) >= (int)sizeof path)
        return NULL;
    if (byte_stream_open_stored(m, path, &s) == ST_OK &&
        byte_stream_peek(s, FOREIGN_PEEK, &bytes, &size) == ST_OK)
        f = foreign_find(path, bytes, size, UINT64_MAX);
    byte_stream_close(s);
    return f && f->importer && !f->mesh ? f : NULL;
}

static int visible(const struct dirent *entry) {
    return entry->d_name[0] != '.' && entry->d_type != DT_DIR && entry->d_type != DT_FIFO;
}

status imported_folder(mem *m, const char *path, const volume_hints *hints, slice_source *out) {
    struct dirent **names = NULL;
    const foreign_format *f = NULL;
    const int count = scandir(path, &names, visible, alphasort);
    for (int i = 0; i < count; i++) {
        f = f ? f : format_of(m, path, names[i]->d_name);
        free(names[i]);
    }
    free(names);
    if (f)
        return open_slices(m, f, path, hints, out);
    return status_describe(ST_UNSUPPORTED,
                           "%s: a folder without a file of a known format: expected the slices of "
                           "an image stack or of a DICOM series",
                           path);
}
