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
    return vtk_legacy_points(v, &s->has_points, &s->p->points, &s->p->position);
}

static status read_cells(vtk_legacy *v, surface_vtk_kind kind, const char *role) {
    scan *s = v->user;
    return vtk_legacy_lists(v, role, &s->has[kind], &s->p->cells[kind]);
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
