#include <stdio.h>
#include <strings.h>

#include "formats/surface/surface_vtk.h"
#include "formats/vtk/vtk_legacy.h"

typedef struct scan {
    surface_vtk_piece *p;
    bool has_points, has[SURFACE_VTK_KINDS];
} scan;

static status on_points(vtk_legacy *v) {
    scan *s = v->user;
    surface_vtk_piece *p = s->p;
    vtk_type type = VTK_ABSENT;
    status st = vtk_legacy_need_words(v, 3, "POINTS n type");
    if (st == ST_OK)
        st = vtk_legacy_once(v, &s->has_points);
    if (st == ST_OK)
        st = vtk_legacy_count(v, 1, &p->points);
    if (st == ST_OK)
        st = vtk_legacy_type(v, 2, &type);
    if (st != ST_OK)
        return st;
    v->tuples_there[VTK_OF_POINTS] = p->points;
    st = vtk_legacy_array(v, type, "POINTS", 3 * p->points, &p->position);
    p->position.components = 3;
    return st;
}

/* Read "OFFSETS type" or "CONNECTIVITY type" and count numbers. */
static status read_part(vtk_legacy *v, const char *keyword, uint64_t count, vtk_array *out) {
    vtk_type type = VTK_ABSENT;
    status st = vtk_legacy_next_line(v);
    if (st == ST_OK && (!vtk_legacy_says(v, keyword) || v->words < 2))
        return vtk_legacy_fault(v, ST_CORRUPT, "expected \"%s type\"", keyword);
    if (st == ST_OK)
        st = vtk_legacy_type(v, 1, &type);
    return st == ST_OK ? vtk_legacy_array(v, type, keyword, count, out) : st;
}

static status read_cells(vtk_legacy *v, surface_vtk_kind kind, const char *role) {
    scan *s = v->user;
    surface_vtk_cells *c = &s->p->cells[kind];
    uint64_t first = 0, second = 0;
    status st = vtk_legacy_need_words(v, 3, "POLYGONS n size");
    if (st == ST_OK)
        st = vtk_legacy_once(v, &s->has[kind]);
    if (st == ST_OK)
        st = vtk_legacy_count(v, 1, &first);
    if (st == ST_OK)
        st = vtk_legacy_count(v, 2, &second);
    if (st != ST_OK)
        return st;
    c->ids_size = second;
    c->from_zero = v->major >= 5;
    c->count = c->from_zero && first ? first - 1 : first;
    v->tuples_there[VTK_OF_CELLS] += c->count;
    if (!c->from_zero)
        return vtk_legacy_array(v, VTK_I32, role, second, &c->ids);
    st = read_part(v, "OFFSETS", first, &c->offsets);
    return st == ST_OK ? read_part(v, "CONNECTIVITY", second, &c->ids) : st;
}

static status on_vertices(vtk_legacy *v) {
    return read_cells(v, SURFACE_VTK_VERTICES, "VERTICES");
}

static status on_lines(vtk_legacy *v) {
    return read_cells(v, SURFACE_VTK_LINES, "LINES");
}

static status on_polygons(vtk_legacy *v) {
    return read_cells(v, SURFACE_VTK_POLYGONS, "POLYGONS");
}

static status on_strips(vtk_legacy *v) {
    return read_cells(v, SURFACE_VTK_STRIPS, "TRIANGLE_STRIPS");
}

static const vtk_legacy_keyword keywords[] = {
    {"POINTS", on_points},     {"VERTICES", on_vertices},      {"LINES", on_lines},
    {"POLYGONS", on_polygons}, {"TRIANGLE_STRIPS", on_strips}, {NULL, NULL}};
static const vtk_legacy_dataset sets[] = {{"POLYDATA", keywords}, {NULL, NULL}};

static status scan_file(surface_vtk *to) {
    scan s = {0};
    byte_stream *data = to->source->data;
    status st = surface_vtk_add_piece(to, &s.p);
    if (st != ST_OK)
        return st;
    vtk_legacy v = {
        .m = to->m, .path = to->source->path, .s = data, .fields = &s.p->fields, .user = &s};
    st = vtk_legacy_scan(&v, sets);
    if (st == ST_OK && !s.has_points)
        return status_describe(ST_CORRUPT, "%s: ends at byte %llu without POINTS",
                               byte_stream_name(data),
                               (unsigned long long)byte_stream_position(data));
    return st;
}

/* ---- the reader ---- */

/* A file that names no data set is left to the meshes' reader. */
static bool known(const char *path, const uint8_t *start, size_t size) {
    char name[VTK_LEGACY_NAME_MAX];
    (void)path;
    return vtk_legacy_names(start, size, name) && strcasecmp(name, sets->name) == 0;
}

static status open_file(mesh_source *source, void **state) {
    return surface_vtk_open(source, scan_file, state);
}

const mesh_reader surface_vtk_reader = {.format = "VTK surface",
                                        .known = known,
                                        .open = open_file,
                                        .read = surface_vtk_read,
                                        .close = surface_vtk_close,
                                        .take = surface_vtk_take,
                                        .fields = surface_choice_fields,
                                        .counts = surface_vtk_counts};
