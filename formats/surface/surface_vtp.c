#include "formats/surface/surface_vtp.h"

#include <stdio.h>
#include <string.h>

#include "formats/base/text.h"
#include "formats/surface/surface_vtk.h"
#include "formats/vtk/vtk_cursor.h"
#include "formats/vtk/vtk_xml.h"

/* Our kinds of elements. How an element's children are read depends on its kind; those of cells
 * follow, in the order of surface_vtk_kind. */
enum {
    ELEMENT_DATA = VTK_XML_OWN,
    ELEMENT_PIECE,
    ELEMENT_POINTS,
    ELEMENT_POINT_DATA,
    ELEMENT_CELL_DATA,
    ELEMENT_CELLS
};

typedef struct scan {
    surface_vtk *to;
    surface_vtk_piece *piece;
    char normals[VTK_NAME_MAX]; /* the points' array of that name; "": not told */
} scan;

static status on_piece(vtk_xml *x, const char **attributes) {
    static const char *const counts[SURFACE_VTK_KINDS] = {"NumberOfVerts", "NumberOfLines",
                                                          "NumberOfPolys", "NumberOfStrips"};
    scan *s = vtk_xml_user(x);
    status st = surface_vtk_add_piece(s->to, &s->piece);
    if (st == ST_OK)
        st = vtk_xml_count(x, attributes, "NumberOfPoints", -1, 0, &s->piece->points);
    for (int i = 0; st == ST_OK && i < SURFACE_VTK_KINDS; i++) {
        s->piece->cells[i].ids_size = VTK_CURSOR_ANY;
        st = vtk_xml_count(x, attributes, counts[i], 0, 0, &s->piece->cells[i].count);
    }
    return st;
}

static status on_point_data(vtk_xml *x, const char **attributes) {
    scan *s = vtk_xml_user(x);
    const char *name = vtk_xml_attribute(attributes, "Normals");
    snprintf(s->normals, sizeof s->normals, "%s", name ? name : "");
    return ST_OK;
}

static status on_points(vtk_xml *x, surface_vtk_piece *p, const vtk_array *a) {
    if (p->position.type != VTK_ABSENT)
        return vtk_xml_fault(x, ST_CORRUPT, "the points come twice");
    p->position = *a;
    p->position.role = "points";
    return ST_OK;
}

static status on_cells(vtk_xml *x, vtk_lists *c, const char *name, const vtk_array *a) {
    const bool ids = strcmp(name, "connectivity") == 0;
    vtk_array *to = ids ? &c->ids : &c->offsets;
    if (!ids && strcmp(name, "offsets") != 0)
        return ST_OK;
    if (to->type != VTK_ABSENT)
        return vtk_xml_fault(x, ST_CORRUPT, "%s comes twice", name);
    *to = *a;
    to->role = ids ? "connectivity" : "offsets";
    return ST_OK;
}

static status on_array(vtk_xml *x, int element, const char *name, const vtk_array *a) {
    const scan *s = vtk_xml_user(x);
    vtk_array of = *a;
    if (element == ELEMENT_POINTS)
        return on_points(x, s->piece, a);
    of.normal = element == ELEMENT_POINT_DATA && s->normals[0] && strcmp(name, s->normals) == 0;
    if (element == ELEMENT_POINT_DATA || element == ELEMENT_CELL_DATA)
        return vtk_fields_add(&s->piece->fields, s->to->m,
                              element == ELEMENT_CELL_DATA ? VTK_OF_CELLS : VTK_OF_POINTS, name,
                              &of);
    return element >= ELEMENT_CELLS
               ? on_cells(x, &s->piece->cells[element - ELEMENT_CELLS], name, a)
               : ST_OK;
}

static void locate_arrays(const surface_vtk *v, const vtk_appended *appended) {
    for (size_t i = 0; i < v->count; i++) {
        surface_vtk_piece *p = &v->pieces[i];
        vtk_xml_locate(appended, &p->position);
        for (int k = 0; k < SURFACE_VTK_KINDS; k++) {
            vtk_xml_locate(appended, &p->cells[k].ids);
            vtk_xml_locate(appended, &p->cells[k].offsets);
        }
        vtk_xml_locate_fields(appended, &p->fields);
    }
}

/* Check that offsets are there. Without them the ids would be read in the legacy form. */
static status check_cells(const surface_vtk *v) {
    const char *file = byte_stream_name(v->source->data);
    for (size_t i = 0; i < v->count; i++)
        for (int k = 0; k < SURFACE_VTK_KINDS; k++)
            if (v->pieces[i].cells[k].count > 0 && v->pieces[i].cells[k].offsets.type == VTK_ABSENT)
                return status_describe(
                    ST_CORRUPT, "%s: piece %zu: expected the offsets of its cells", file, i + 1);
    return v->count ? ST_OK : status_describe(ST_CORRUPT, "%s: expected a Piece in PolyData", file);
}

static status scan_file(surface_vtk *v) {
    static const vtk_xml_element elements[] = {
        {VTK_XML_FILE, "PolyData", ELEMENT_DATA, NULL},
        {ELEMENT_DATA, "Piece", ELEMENT_PIECE, on_piece},
        {ELEMENT_PIECE, "Points", ELEMENT_POINTS, NULL},
        {ELEMENT_PIECE, "PointData", ELEMENT_POINT_DATA, on_point_data},
        {ELEMENT_PIECE, "CellData", ELEMENT_CELL_DATA, NULL},
        {ELEMENT_PIECE, "Verts", ELEMENT_CELLS + SURFACE_VTK_VERTICES, NULL},
        {ELEMENT_PIECE, "Lines", ELEMENT_CELLS + SURFACE_VTK_LINES, NULL},
        {ELEMENT_PIECE, "Polys", ELEMENT_CELLS + SURFACE_VTK_POLYGONS, NULL},
        {ELEMENT_PIECE, "Strips", ELEMENT_CELLS + SURFACE_VTK_STRIPS, NULL},
        {0, NULL, 0, NULL},
    };
    static const vtk_xml_reader reader = {"PolyData", elements, on_array};
    scan s = {.to = v};
    vtk_appended appended;
    status st = vtk_xml_scan(v->m, v->source->path, v->source->data, &reader, &s, &appended);
    if (st != ST_OK)
        return st;
    locate_arrays(v, &appended);
    return check_cells(v);
}

/* ---- the reader ---- */

/* A file that does not say its type is broken. Its suffix then makes it one of ours. */
static bool known(const char *path, const uint8_t *start, size_t size) {
    char type[VTK_XML_TYPE_MAX];
    if (vtk_xml_type(start, size, type))
        return strcmp(type, "PolyData") == 0;
    return text_ends_in(path, ".vtp");
}

static status open_file(mesh_source *source, void **state) {
    return surface_vtk_open(source, scan_file, state);
}

const mesh_reader surface_vtp_reader = {.format = "VTP",
                                        .known = known,
                                        .open = open_file,
                                        .read = surface_vtk_read,
                                        .close = surface_vtk_close,
                                        .take = surface_vtk_take,
                                        .fields = surface_choice_fields,
                                        .counts = surface_vtk_counts};
