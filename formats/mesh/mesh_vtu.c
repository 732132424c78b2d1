#include "formats/mesh/mesh_vtu.h"

#include <string.h>

#include "formats/base/text.h"
#include "formats/vtk/vtk_cursor.h"
#include "formats/vtk/vtk_xml.h"

/* Our kinds of elements. How an element's children are read depends on its kind. */
enum {
    ELEMENT_GRID = VTK_XML_OWN,
    ELEMENT_PIECE,
    ELEMENT_POINTS,
    ELEMENT_CELLS,
    ELEMENT_POINT_DATA,
    ELEMENT_CELL_DATA,
};

typedef struct scan {
    vtk_unstructured *g;
    const char *path; /* of this file */
    vtk_piece *piece;
} scan;

static status on_piece(vtk_xml *x, const char **attributes) {
    scan *s = vtk_xml_user(x);
    status st = vtk_unstructured_add_piece(s->g, s->path, &s->piece);
    if (st == ST_OK)
        st = vtk_xml_count(x, attributes, "NumberOfPoints", -1, 0, &s->piece->points);
    if (st == ST_OK)
        st = vtk_xml_count(x, attributes, "NumberOfCells", -1, 0, &s->piece->cells.lists.count);
    if (st == ST_OK)
        s->piece->cells.lists.ids_size = VTK_CURSOR_ANY;
    return st;
}

static status on_points(vtk_xml *x, vtk_piece *p, const vtk_array *a) {
    if (p->position.type != VTK_ABSENT)
        return vtk_xml_fault(x, ST_CORRUPT, "the points come twice");
    p->position = *a;
    p->position.role = "points";
    return ST_OK;
}

static status on_cells(vtk_xml *x, vtk_piece *p, const char *name, const vtk_array *a) {
    const struct {
        const char *name;
        vtk_array *to;
    } parts[] = {{"connectivity", &p->cells.lists.ids},
                 {"offsets", &p->cells.lists.offsets},
                 {"types", &p->cells.types},
                 {"faces", &p->cells.faces.faces},
                 {"faceoffsets", &p->cells.faces.faceoffsets},
                 {"face_connectivity", &p->cells.faces.ids},
                 {"face_offsets", &p->cells.faces.ends},
                 {"polyhedron_to_faces", &p->cells.faces.cell_faces},
                 {"polyhedron_offsets", &p->cells.faces.cell_ends}};
    size_t i = 0, count = sizeof parts / sizeof *parts;
    while (i < count && strcmp(name, parts[i].name) != 0)
        i++;
    if (i == count)
        return ST_OK;
    if (parts[i].to->type != VTK_ABSENT)
        return vtk_xml_fault(x, ST_CORRUPT, "%s comes twice", name);
    *parts[i].to = *a;
    parts[i].to->role = parts[i].name;
    return ST_OK;
}

static status on_array(vtk_xml *x, int element, const char *name, const vtk_array *a) {
    const scan *s = vtk_xml_user(x);
    switch (element) {
    case ELEMENT_POINTS: return on_points(x, s->piece, a);
    case ELEMENT_CELLS: return on_cells(x, s->piece, name, a);
    case ELEMENT_POINT_DATA:
        return vtk_fields_add(&s->piece->fields, s->g->m, VTK_OF_POINTS, name, a);
    case ELEMENT_CELL_DATA:
        return vtk_fields_add(&s->piece->fields, s->g->m, VTK_OF_CELLS, name, a);
    default: return ST_OK;
    }
}

/* ---- the file ---- */

/* Locate the arrays of the pieces from `before` on. */
static void locate_arrays(const vtk_unstructured *g, size_t before, const vtk_appended *appended) {
    for (size_t i = before; i < g->count; i++) {
        vtk_piece *p = &g->pieces[i];
        vtk_xml_locate(appended, &p->position);
        vtk_xml_locate(appended, &p->cells.lists.ids);
        vtk_xml_locate(appended, &p->cells.lists.offsets);
        vtk_xml_locate(appended, &p->cells.types);
        vtk_faces_source *faces = &p->cells.faces;
        vtk_array *const of_faces[] = {&faces->faces, &faces->faceoffsets, &faces->ids,
                                       &faces->ends,  &faces->cell_faces,  &faces->cell_ends};
        for (size_t k = 0; k < sizeof of_faces / sizeof *of_faces; k++)
            vtk_xml_locate(appended, of_faces[k]);
        vtk_xml_locate_fields(appended, &p->fields);
    }
}

/* Check that offsets are there. Without them the ids would be read in the legacy form. */
static status check_cells(const vtk_unstructured *g, size_t before, const char *path) {
    for (size_t i = before; i < g->count; i++) {
        const vtk_cells_source *c = &g->pieces[i].cells;
        if (c->lists.count > 0 && c->lists.offsets.type == VTK_ABSENT)
            return status_describe(ST_CORRUPT, "%s: piece %zu: expected the offsets of its cells",
                                   path, i - before + 1);
    }
    if (g->count == before)
        return status_describe(ST_CORRUPT, "%s: expected a Piece in an UnstructuredGrid", path);
    return ST_OK;
}

status mesh_vtu_scan(vtk_unstructured *g, const char *path, byte_stream *data) {
    static const vtk_xml_element elements[] = {
        {VTK_XML_FILE, "UnstructuredGrid", ELEMENT_GRID, NULL},
        {ELEMENT_GRID, "Piece", ELEMENT_PIECE, on_piece},
        {ELEMENT_PIECE, "Points", ELEMENT_POINTS, NULL},
        {ELEMENT_PIECE, "Cells", ELEMENT_CELLS, NULL},
        {ELEMENT_PIECE, "PointData", ELEMENT_POINT_DATA, NULL},
        {ELEMENT_PIECE, "CellData", ELEMENT_CELL_DATA, NULL},
        {0, NULL, 0, NULL},
    };
    static const vtk_xml_reader reader = {"UnstructuredGrid", elements, on_array};
    scan s = {.g = g, .path = path};
    const size_t before = g->count;
    vtk_appended appended;
    status st = vtk_xml_scan(g->m, path, data, &reader, &s, &appended);
    if (st != ST_OK)
        return st;
    locate_arrays(g, before, &appended);
    return check_cells(g, before, path);
}

static status scan_file(vtk_unstructured *g, byte_stream *data) {
    return mesh_vtu_scan(g, g->source->path, data);
}

/* ---- the reader ---- */

/* A file that does not say its type is broken. Its suffix then makes it one of ours. */
static bool known(const char *path, const uint8_t *start, size_t size) {
    char type[VTK_XML_TYPE_MAX];
    if (vtk_xml_type(start, size, type))
        return strcmp(type, "UnstructuredGrid") == 0;
    return text_ends_in(path, ".vtu");
}

static status open_file(mesh_source *source, void **state) {
    return vtk_unstructured_open(source, scan_file, state);
}

const mesh_reader mesh_vtu_reader = {
    .format = "VTU",
    .known = known,
    .open = open_file,
    .read = vtk_unstructured_read,
    .close = vtk_unstructured_close,
    .take = vtk_unstructured_take,
    .fields = vtk_unstructured_fields,
};
