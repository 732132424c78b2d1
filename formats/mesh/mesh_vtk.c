#include "formats/mesh/mesh_vtk.h"

#include <stdio.h>
#include <strings.h>

#include "formats/base/text.h"
#include "formats/mesh/vtk_unstructured.h"
#include "formats/vtk/vtk_legacy.h"

typedef struct scan {
    vtk_piece *p;
    bool has_points, has_cells, has_types;
} scan;

static status on_points(vtk_legacy *v) {
    scan *s = v->user;
    return vtk_legacy_points(v, &s->has_points, &s->p->points, &s->p->position);
}

static status on_cells(vtk_legacy *v) {
    scan *s = v->user;
    return vtk_legacy_lists(v, "CELLS", &s->has_cells, &s->p->cells.lists);
}

static status on_cell_types(vtk_legacy *v) {
    scan *s = v->user;
    vtk_cells_source *c = &s->p->cells;
    uint64_t count = 0;
    status st = vtk_legacy_need_words(v, 2, "CELL_TYPES n");
    if (st == ST_OK)
        st = vtk_legacy_once(v, &s->has_types);
    if (st == ST_OK)
        st = vtk_legacy_count(v, 1, &count);
    if (st == ST_OK && (!s->has_cells || count != c->lists.count))
        st = vtk_legacy_fault(v, ST_CORRUPT, "%llu cell types, expected those of %llu cells",
                              (unsigned long long)count, (unsigned long long)c->lists.count);
    return st == ST_OK ? vtk_legacy_array(v, VTK_I32, "CELL_TYPES", count, &c->types) : st;
}

static const vtk_legacy_keyword keywords[] = {
    {"POINTS", on_points}, {"CELLS", on_cells}, {"CELL_TYPES", on_cell_types}, {NULL, NULL}};
static const vtk_legacy_dataset sets[] = {{"UNSTRUCTURED_GRID", keywords}, {NULL, NULL}};

static status check_parts(const scan *s, byte_stream *data) {
    if (!s->has_points || (s->p->cells.lists.count > 0 && !s->has_types))
        return status_describe(ST_CORRUPT, "%s: ends at byte %llu without %s",
                               byte_stream_name(data),
                               (unsigned long long)byte_stream_position(data),
                               s->has_points ? "CELL_TYPES" : "POINTS");
    return ST_OK;
}

static status scan_file(vtk_unstructured *g, byte_stream *data) {
    scan s = {0};
    status st = vtk_unstructured_add_piece(g, g->source->path, &s.p);
    if (st != ST_OK)
        return st;
    vtk_legacy v = {
        .m = g->m, .path = g->source->path, .s = data, .fields = &s.p->fields, .user = &s};
    st = vtk_legacy_scan(&v, sets);
    return st == ST_OK ? check_parts(&s, data) : st;
}

/* ---- the reader ---- */

/* A file that does not name its data set is broken. Its first bytes or its suffix then make it one
 * of ours. */
static bool known(const char *path, const uint8_t *start, size_t size) {
    char name[VTK_LEGACY_NAME_MAX];
    if (vtk_legacy_names(start, size, name))
        return strcasecmp(name, sets->name) == 0;
    return vtk_legacy_known(start, size) || text_ends_in(path, ".vtk");
}

static status open_file(mesh_source *source, void **state) {
    return vtk_unstructured_open(source, scan_file, state);
}

const mesh_reader mesh_vtk_reader = {
    .format = "VTK",
    .known = known,
    .open = open_file,
    .read = vtk_unstructured_read,
    .close = vtk_unstructured_close,
    .take = vtk_unstructured_take,
    .fields = vtk_unstructured_fields,
};
