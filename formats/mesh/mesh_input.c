#include "formats/mesh/mesh_input.h"

#include <string.h>
#include <strings.h>

#include "formats/base/text.h"
#include "formats/input/dicom_mark.h"
#include "formats/input/foreign.h"
#include "formats/mesh/mesh_arrays.h"
#include "formats/mesh/mesh_feed.h"
#include "formats/mesh/mesh_gmsh.h"
#include "formats/mesh/mesh_imported.h"
#include "formats/mesh/mesh_reader.h"
#include "formats/mesh/mesh_stream.h"
#include "formats/mesh/mesh_tetgen.h"
#include "formats/mesh/mesh_vtk.h"
#include "formats/mesh/mesh_vtk_parts.h"
#include "formats/mesh/mesh_vtu.h"

struct mesh_input {
    mem *m;
    mesh_source source;
    const mesh_reader *reader;
    void *state;
    uint32_t fields;       /* number of fields taken */
    const mesh_feed *feed; /* set while the mesh is read */
    double share;          /* the last one returned */
};

/* The formats. The first that recognises a file reads it. */
static const mesh_reader *const readers[] = {
    &mesh_stream_reader, &mesh_tetgen_reader,    &mesh_gmsh_reader,    &mesh_vtk_reader,
    &mesh_vtu_reader,    &mesh_vtk_parts_reader, &mesh_imported_reader};

static const mesh_readers meshes = {
    readers, sizeof readers / sizeof *readers,
    "expected a mesh: TetGen (.node and .ele), VTK (.vtk, .vtu), Gmsh (.msh) or a mesh stream"};

/* ---- recognising ---- */

static const mesh_reader *find_reader(const mesh_readers *by, const char *path,
                                      const uint8_t *start, size_t size) {
    for (size_t i = 0; i < by->count && !dicom_mark_is_at(start, size); i++)
        if (by->items[i]->known(path, start, size))
            return by->items[i];
    return NULL;
}

status mesh_input_recognise(byte_stream *s, bool *known) {
    return mesh_input_recognise_by(&meshes, s, known);
}

status mesh_input_recognise_by(const mesh_readers *by, byte_stream *s, bool *known) {
    const uint8_t *start;
    size_t size;
    status st = byte_stream_peek(s, MESH_READER_PEEK, &start, &size);
    if (st == ST_OK)
        *known = find_reader(by, byte_stream_kind(s), start, size) != NULL;
    return st;
}

/* ---- opening ---- */

static status open_reader(mesh_input *x, const mesh_readers *by) {
    mesh_source *source = &x->source;
    const uint8_t *start;
    size_t size;
    status st = byte_stream_peek(source->data, MESH_READER_PEEK, &start, &size);
    if (st != ST_OK)
        return st;
    x->reader = find_reader(by, byte_stream_kind(source->data), start, size);
    if (!x->reader)
        return foreign_refuse(source->data, by->expected);
    if (!x->reader->steps && source->hints.step > 0)
        return status_describe(ST_USAGE, "%s: no step %u: there is 1, counted from 0",
                               byte_stream_name(source->data), source->hints.step);
    return x->reader->open(source, &x->state);
}

status mesh_input_open_stream(mem *m, byte_stream *s, const mesh_hints *hints, mesh_input **out) {
    return mesh_input_open_by(m, &meshes, s, hints, out);
}

status mesh_input_open_by(mem *m, const mesh_readers *by, byte_stream *s, const mesh_hints *hints,
                          mesh_input **out) {
    mesh_input *x = mem_zalloc(m, sizeof *x);
    if (!x) {
        byte_stream_close(s);
        return ST_NOMEM;
    }
    x->m = m;
    x->source = (mesh_source){.m = m, .path = byte_stream_path(s), .data = s};
    if (hints)
        x->source.hints = *hints;
    status st = open_reader(x, by);
    if (st == ST_OK)
        st = mesh_input_take(x, (const char *const[]){x->source.hints.field}, 1);
    if (st != ST_OK) {
        mesh_input_close(x);
        return st;
    }
    const char *name = x->source.hints.name;
    text_name(x->source.name, sizeof x->source.name, name ? name : x->source.name);
    *out = x;
    return ST_OK;
}

status mesh_input_open(mem *m, const char *path, const mesh_hints *hints, mesh_input **out) {
    byte_stream *s;
    status st = byte_stream_open(m, path, &s);
    return st == ST_OK ? mesh_input_open_stream(m, s, hints, out) : st;
}

status mesh_input_open_arrays(mem *m, const mesh_arrays *arrays, const char *name,
                              mesh_input **out) {
    mesh_input *x = mem_zalloc(m, sizeof *x);
    if (!x)
        return ST_NOMEM;
    x->m = m;
    x->fields = 1;
    x->source = (mesh_source){.m = m, .path = "arrays"};
    x->reader = &mesh_arrays_reader;
    status st = mesh_arrays_state(m, arrays, &x->state);
    if (st != ST_OK) {
        mesh_input_close(x);
        return st;
    }
    text_name(x->source.name, sizeof x->source.name, name ? name : "");
    *out = x;
    return ST_OK;
}

void mesh_input_close(mesh_input *x) {
    if (!x)
        return;
    if (x->reader)
        x->reader->close(x->state);
    byte_stream_close(x->source.data);
    mem_free(x->m, x);
}

const char *mesh_input_format(const mesh_input *x) {
    return x->source.format ? x->source.format : x->reader->format;
}

const char *mesh_input_name(const mesh_input *x) {
    return x->source.name;
}

typedef struct taker {
    mesh_field_taker *take;
    void *ctx;
} taker;

static void take_clean(void *ctx, const char *name, int components) {
    const taker *t = ctx;
    char clean[MESH_NAME_MAX + 1];
    text_name(clean, sizeof clean, name);
    t->take(t->ctx, clean, components);
}

void mesh_input_fields(const mesh_input *x, mesh_field_taker *take, void *ctx) {
    taker t = {take, ctx};
    x->reader->fields(x->state, take_clean, &t);
}

status mesh_input_take(mesh_input *x, const char *const *names, uint32_t count) {
    x->fields = count;
    return x->reader->take(x->state, names, count);
}

bool mesh_input_counts(const mesh_input *x, uint64_t *points, uint64_t *cells) {
    *points = *cells = UINT64_MAX;
    if (x->reader->counts)
        x->reader->counts(x->state, points, cells);
    return *points != UINT64_MAX;
}

bool mesh_input_names_files(const mesh_input *x) {
    return x->reader->file != NULL;
}

bool mesh_input_by_library(const mesh_input *x) {
    return x->reader == &mesh_imported_reader;
}

bool mesh_input_may_have_steps(const mesh_input *x) {
    return x->reader->steps != NULL;
}

const char *mesh_input_file(const mesh_input *x) {
    return x->reader->file ? x->reader->file(x->state) : x->source.path;
}

uint32_t mesh_input_steps(const mesh_input *x) {
    const double *times;
    return x->reader->steps ? x->reader->steps(x->state, &times) : 1;
}

const double *mesh_input_times(const mesh_input *x) {
    const double *times = NULL;
    if (x->reader->steps)
        x->reader->steps(x->state, &times);
    return times;
}

/* ---- reading ---- */

double mesh_input_share(mesh_input *x) {
    const double share = x->feed ? mesh_feed_share(x->feed) : x->share;
    x->share = share > x->share ? share : x->share;
    return x->share;
}

status mesh_input_read(mesh_input *x, const mesh_sink *sink, mesh_report *report) {
    mesh_feed feed;
    byte_stream *data = x->source.data;
    const char *name = data ? byte_stream_name(data) : x->source.path;
    status st = mesh_feed_begin(&feed, x->m, name, x->fields, sink, report);
    x->feed = &feed;
    if (st == ST_OK)
        st = x->reader->read(x->state, &feed);
    if (st == ST_OK)
        st = mesh_feed_end(&feed);
    text_name(report->field, sizeof report->field, report->field);
    x->feed = NULL;
    x->share = 1;
    mesh_feed_release(&feed);
    return st;
}
