#include "formats/grid/vtk_grid_xml.h"

#include <string.h>

#include "formats/base/text.h"
#include "formats/grid/vtk_grid.h"
#include "formats/input/named_file.h"
#include "formats/vtk/vtk_xml.h"

/* Our kinds of elements. How an element's children are read depends on its kind. */
enum {
    ELEMENT_GRID = VTK_XML_OWN,
    ELEMENT_PIECE,
    ELEMENT_POINT_DATA,
    ELEMENT_CELL_DATA,
    ELEMENT_COORDINATES,
    ELEMENT_POINTS,
    ELEMENT_PARALLEL, /* a grid whose pieces are files */
    ELEMENT_SOURCE,   /* one of these files */
};

/* The types of a VTKFile that are grids. */
typedef struct grid_kind {
    const char *type, *suffix;
    const char *format; /* for messages */
    const char *pieces; /* the type of the pieces' files; NULL: they are in this one */
    vtk_geometry geometry;
} grid_kind;

static const grid_kind kinds[] = {
    {"ImageData", ".vti", "VTK image data", NULL, VTK_REGULAR},
    {"RectilinearGrid", ".vtr", "VTK rectilinear grid", NULL, VTK_RECTILINEAR},
    {"StructuredGrid", ".vts", "VTK structured grid", NULL, VTK_STRUCTURED},
    {"PImageData", ".pvti", "VTK image data in pieces", "ImageData", VTK_REGULAR},
    {"PRectilinearGrid", ".pvtr", "VTK rectilinear grid in pieces", "RectilinearGrid",
     VTK_RECTILINEAR},
    {"PStructuredGrid", ".pvts", "VTK structured grid in pieces", "StructuredGrid", VTK_STRUCTURED},
};

enum { KINDS = sizeof kinds / sizeof *kinds };

/* A piece that is a file. */
typedef struct source {
    const char *path; /* owned by the grid */
    vtk_extent extent;
} source;

typedef struct scan {
    vtk_grid *g;
    const char *path; /* of this file */
    vtk_frame frame;
    bool framed; /* the grid's element was there */
    bool follow_links;
    bool in_piece; /* in the grid's last piece; false: in a piece without nodes */
    source *sources;
    size_t count, room;
} scan;

/* ---- elements ---- */

static status on_grid(vtk_xml *x, const char **attributes) {
    scan *s = vtk_xml_user(x);
    if (s->framed)
        return vtk_xml_fault(x, ST_CORRUPT, "the grid comes twice");
    s->framed = true;
    vtk_frame_init(&s->frame);
    status st = vtk_xml_extent(x, attributes, "WholeExtent", &s->frame.whole);
    if (st == ST_OK)
        st = vtk_xml_numbers(x, attributes, "Origin", 3, s->frame.origin, NULL);
    if (st == ST_OK)
        st = vtk_xml_numbers(x, attributes, "Spacing", 3, s->frame.spacing, NULL);
    if (st == ST_OK)
        st = vtk_xml_numbers(x, attributes, "Direction", 9, s->frame.direction[0],
                             &s->frame.has_direction);
    return st;
}

static status on_piece(vtk_xml *x, const char **attributes) {
    scan *s = vtk_xml_user(x);
    vtk_extent extent;
    vtk_grid_piece *p;
    status st = vtk_xml_extent(x, attributes, "Extent", &extent);
    s->in_piece = st == ST_OK && !vtk_extent_is_empty(&extent);
    if (!s->in_piece)
        return st;
    st = vtk_grid_add_piece(s->g, &p);
    if (st == ST_OK)
        *p = (vtk_grid_piece){.path = s->path, .extent = extent};
    return st;
}

static status on_source(vtk_xml *x, const char **attributes) {
    scan *s = vtk_xml_user(x);
    const char *name = vtk_xml_attribute(attributes, "Source");
    source new = {0};
    status st = vtk_xml_extent(x, attributes, "Extent", &new.extent);
    if (st == ST_OK && !name)
        st = vtk_xml_fault(x, ST_CORRUPT, "expected the attribute Source");
    if (st != ST_OK || vtk_extent_is_empty(&new.extent))
        return st;
    char *path = NULL;
    st = named_file_find(s->g->m, s->path, name, s->follow_links, &path);
    if (st == ST_OK)
        st = vtk_grid_add_path(s->g, path, &new.path);
    mem_free(s->g->m, path);
    if (st == ST_OK)
        st = mem_grow(s->g->m, &s->sources, sizeof new, s->count, 16, &s->room);
    if (st == ST_OK)
        s->sources[s->count++] = new;
    return st;
}

/* Take the coordinates of the next axis: they come in the order x, y, z. */
static status on_coordinates(vtk_xml *x, vtk_grid_piece *p, const vtk_array *a) {
    static const char *const roles[] = {"x coordinates", "y coordinates", "z coordinates"};
    for (int i = 0; i < 3; i++)
        if (p->axis[i].type == VTK_ABSENT) {
            p->axis[i] = *a;
            p->axis[i].role = roles[i];
            return ST_OK;
        }
    return vtk_xml_fault(x, ST_CORRUPT, "coordinates of more than three axes");
}

static status on_points(vtk_xml *x, vtk_grid_piece *p, const vtk_array *a) {
    if (p->points.type != VTK_ABSENT)
        return vtk_xml_fault(x, ST_CORRUPT, "the points come twice");
    p->points = *a;
    p->points.role = "points";
    return ST_OK;
}

static status on_array(vtk_xml *x, int element, const char *name, const vtk_array *a) {
    const scan *s = vtk_xml_user(x);
    if (!s->in_piece)
        return ST_OK;
    vtk_grid_piece *p = &s->g->pieces[s->g->count - 1];
    switch (element) {
    case ELEMENT_POINT_DATA: return vtk_fields_add(&p->fields, s->g->m, VTK_OF_POINTS, name, a);
    case ELEMENT_CELL_DATA: return vtk_fields_add(&p->fields, s->g->m, VTK_OF_CELLS, name, a);
    case ELEMENT_COORDINATES: return on_coordinates(x, p, a);
    case ELEMENT_POINTS: return on_points(x, p, a);
    default: return ST_OK;
    }
}

static const vtk_xml_element elements[] = {
    {VTK_XML_FILE, "ImageData", ELEMENT_GRID, on_grid},
    {VTK_XML_FILE, "RectilinearGrid", ELEMENT_GRID, on_grid},
    {VTK_XML_FILE, "StructuredGrid", ELEMENT_GRID, on_grid},
    {ELEMENT_GRID, "Piece", ELEMENT_PIECE, on_piece},
    {ELEMENT_PIECE, "PointData", ELEMENT_POINT_DATA, NULL},
    {ELEMENT_PIECE, "CellData", ELEMENT_CELL_DATA, NULL},
    {ELEMENT_PIECE, "Coordinates", ELEMENT_COORDINATES, NULL},
    {ELEMENT_PIECE, "Points", ELEMENT_POINTS, NULL},
    {VTK_XML_FILE, "PImageData", ELEMENT_PARALLEL, on_grid},
    {VTK_XML_FILE, "PRectilinearGrid", ELEMENT_PARALLEL, on_grid},
    {VTK_XML_FILE, "PStructuredGrid", ELEMENT_PARALLEL, on_grid},
    {ELEMENT_PARALLEL, "Piece", ELEMENT_SOURCE, on_source},
    {0, NULL, 0, NULL},
};

/* ---- files ---- */

/* Scan the XML of one file. Append its pieces to s->g. Set s->frame to its place in space, and
 * s->sources to the files of pieces that it names. */
static status scan_file(scan *s, byte_stream *data, const char *type) {
    const vtk_xml_reader reader = {type, elements, on_array};
    const size_t before = s->g->count;
    vtk_appended appended;
    status st = vtk_xml_scan(s->g->m, s->path, data, &reader, s, &appended);
    if (st == ST_OK && !s->framed)
        st = status_describe(ST_CORRUPT, "%s: expected an element %s", s->path, type);
    for (size_t i = before; st == ST_OK && i < s->g->count; i++) {
        vtk_xml_locate_fields(&appended, &s->g->pieces[i].fields);
        for (int a = 0; a < 3; a++)
            vtk_xml_locate(&appended, &s->g->pieces[i].axis[a]);
        vtk_xml_locate(&appended, &s->g->pieces[i].points);
    }
    return st;
}

/* Scan the file of a piece. It gives the directions where the parallel file, as VTK writes it, does
 * not. */
static status scan_source(vtk_grid *g, const source *from, const char *type) {
    scan s = {.g = g, .path = from->path};
    const size_t before = g->count;
    byte_stream *data;
    status st = byte_stream_open(g->m, from->path, &data);
    if (st != ST_OK)
        return st;
    st = vtk_array_check_file(from->path);
    if (st == ST_OK)
        st = scan_file(&s, data, type);
    byte_stream_close(data);
    for (size_t i = before; st == ST_OK && i < g->count; i++)
        if (!vtk_extent_holds(&from->extent, &g->pieces[i].extent))
            st = status_describe(ST_CORRUPT, "%s: its extent is not the one that %s says", s.path,
                                 g->paths[0]);
    if (st == ST_OK && !g->frame.has_direction) {
        g->frame.has_direction = true;
        memcpy(g->frame.direction, s.frame.direction, sizeof s.frame.direction);
    }
    return st;
}

static status scan_all(vtk_grid *g, byte_stream *data, const grid_kind *kind,
                       const volume_hints *hints) {
    scan s = {.g = g, .path = g->paths[0], .follow_links = hints->trust.follow_links};
    status st = scan_file(&s, data, kind->type);
    g->frame = s.frame;
    for (size_t i = 0; st == ST_OK && i < s.count; i++)
        st = scan_source(g, &s.sources[i], kind->pieces);
    mem_free(g->m, s.sources);
    return st;
}

/* ---- the reader ---- */

/* Find the kind by the type that the file states. A file without a type goes by its suffix: it is
 * broken, and the reader reports that. */
static const grid_kind *find_kind(const char *path, const uint8_t *start, size_t size) {
    char type[VTK_XML_TYPE_MAX];
    const bool says = vtk_xml_type(start, size, type);
    for (int i = 0; i < KINDS; i++)
        if (says ? strcmp(type, kinds[i].type) == 0 : text_ends_in(path, kinds[i].suffix))
            return &kinds[i];
    return NULL;
}

static bool known(const char *path, const uint8_t *start, size_t size) {
    return find_kind(path, start, size) != NULL;
}

static status open_grid(vtk_grid *g, volume_layout *l, const grid_kind *kind,
                        const volume_hints *hints, slice_source *out) {
    const char *path;
    g->geometry = kind->geometry;
    status st = vtk_array_check_file(l->path);
    if (st == ST_OK)
        st = vtk_grid_add_path(g, l->path, &path);
    if (st == ST_OK)
        st = scan_all(g, l->data, kind, hints);
    return st == ST_OK ? vtk_grid_open(g, hints, out) : st;
}

status vtk_grid_xml_open(volume_layout *l, const volume_hints *hints, vtk_parts *parts,
                         slice_source *out) {
    const uint8_t *start;
    size_t size;
    vtk_grid *g;
    status st = vtk_grid_create(l->m, &g);
    if (st != ST_OK) {
        vtk_parts_release(parts, l->m);
        return st;
    }
    g->parts = *parts;
    *parts = (vtk_parts){0};
    st = byte_stream_peek(l->data, GRID_READER_PEEK, &start, &size);
    if (st != ST_OK) {
        vtk_grid_close(g);
        return st;
    }
    const grid_kind *kind = find_kind(byte_stream_kind(l->data), start, size);
    st = open_grid(g, l, kind, hints, out);
    if (st != ST_OK)
        vtk_grid_close(g);
    out->format = kind->format;
    return st;
}

static status open_slices(volume_layout *l, const volume_hints *hints, slice_source *out) {
    return vtk_grid_xml_open(l, hints, &(vtk_parts){0}, out);
}

const grid_reader vtk_grid_xml_reader = {
    .format = "VTK grid", .known = known, .slices = open_slices};
