/* cgns_cells.h - the cells of a CGNS file: hexahedra of structured zones, elements of unstructured
 * ones.
 */
#ifndef PREP_IMPORT_CGNS_CGNS_CELLS_H
#define PREP_IMPORT_CGNS_CGNS_CELLS_H

#include "formats/base/cell_shape.h"
#include "prep/import/cgns/cgns_faces.h"

/* What elements of a type are. */
typedef struct cgns_element {
    bool known;  /* it was looked up */
    bool volume; /* it is a cell, of this shape */
    cell_shape shape;
    int nodes;
} cgns_element;

/* Elements of a zone: all of one type; or mixed: each is its type, then its nodes; or polyhedra. */
typedef struct cgns_section {
    int zone, number;    /* the second is the library's, from 1 */
    cgsize_t start, end; /* the elements' numbers */
    bool mixed, polyhedra;
    cgns_element element; /* of one that is neither */
    cgns_numbers numbers; /* of a mixed one */
    cgns_lists lists;     /* of polyhedra: their faces */
} cgns_section;

typedef struct cgns_cells {
    cgns_file *f;
    bool by_corners;
    cgns_element types[NofValidElementTypes];
    cgns_section *sections; /* by zones, and in a zone by their numbers */
    size_t count, room;
    cgns_faces faces;
    uint64_t of[CELL_SHAPES];
    uint64_t polyhedra, numbers, middles; /* as mesh_stream_header has them */
    uint64_t *in_zone;                    /* cells of each zone */
    uint64_t higher, skipped;             /* cells of higher order; elements that are no cells */
} cgns_cells;

/* cgns_cells_open() - find the sections, and count. ST_UNSUPPORTED: polyhedra without
 * NFACE_n, or elements of higher order, but for tets of ten nodes, unless by_corners. Release c in
 * any case. */
CHECKED status cgns_cells_open(cgns_file *f, bool by_corners, cgns_cells *c);
void cgns_cells_release(cgns_cells *c);

enum { CGNS_WALK_IDS = 8192, CGNS_ALL = -1, CGNS_POLYHEDRA = CELL_SHAPES };

/* A walk over cells in the file's order, of all shapes or of one. */
typedef struct cgns_walk {
    cgns_cells *c;
    int shape; /* or CGNS_ALL, or CGNS_POLYHEDRA */
    int zone;
    size_t section;
    uint64_t at;    /* of the zone's cells, or the section's elements; mixed: of its numbers */
    uint64_t begun; /* what is in the buffer, likewise: the first, and how many */
    size_t held;
    cgsize_t ids[CGNS_WALK_IDS];
    cgns_lists_walk lists;
} cgns_walk;

typedef struct cgns_cell {
    cell_shape shape;
    int zone;
    uint32_t ids[CELL_VERTICES_MAX]; /* from 0; UINT32_MAX: no node */
    mesh_polyhedron
        polyhedron; /* in their place, valid until the next cell; of no faces: it is none */
} cgns_cell;

/* cgns_walk_begin() - shape: as the walk has it. cgns_walk_next() - the next cell; *more: false
 * behind the last. */
void cgns_walk_begin(cgns_walk *w, cgns_cells *c, int shape);
CHECKED status cgns_walk_next(cgns_walk *w, cgns_cell *cell, bool *more);

#endif
