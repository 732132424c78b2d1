/* vtk_cells.h - the cells of one piece of a VTK grid, in order: their types and the ids of their
 * points.
 */
#ifndef FORMATS_MESH_VTK_CELLS_H
#define FORMATS_MESH_VTK_CELLS_H

#include "formats/base/mem.h"
#include "formats/mesh/mesh_sink.h"
#include "formats/mesh/vtk_faces.h"
#include "formats/vtk/vtk_array.h"

/* The arrays that hold the cells. */
typedef struct vtk_cells_source {
    vtk_lists lists;
    vtk_array types;
    vtk_faces_source faces;  /* of polyhedra. None: they are among the ids (legacy files) */
    const vtk_array *ghosts; /* vtkGhostType or vtkGhostLevels; NULL: there is none */
    bool by_corners;         /* mesh_hints.by_corners */
    bool quadratic;          /* quadratic tets are taken as they are; without by_corners */
} vtk_cells_source;

typedef struct vtk_cell {
    bool volume;     /* false: vertices, lines or surfaces; kind and ids are not set */
    cell_shape kind; /* vertices in the order of mesh_sink.h */
    int count;       /* number of ids; 0 for polyhedra */
    uint64_t ids[CELL_VERTICES_MAX];
    mesh_polyhedron polyhedron; /* of no faces: it is none. Valid up to the next cell */
    bool bent;                  /* of higher order: the ids are those of its corners */
    bool copied;                /* another piece has it, too */
    bool hidden;                /* not to be drawn: finer cells are in its place, say */
} vtk_cell;

typedef struct vtk_cells vtk_cells;

/* vtk_cells_open() - open the cells of a source, which must outlive them, and check that its arrays
 * are there. */
CHECKED status vtk_cells_open(mem *m, const vtk_cells_source *source, vtk_cells **out);
void vtk_cells_close(vtk_cells *c); /* NULL is fine */

/* vtk_cells_next() - read the next of source->count cells. ST_CORRUPT for impossible types, offsets
 * or numbers of points; ST_UNSUPPORTED for volumes with curved edges. */
CHECKED status vtk_cells_next(vtk_cells *c, vtk_cell *cell);

/* vtk_cells_may_hold_polyhedra() - false: the source has none. */
CHECKED status vtk_cells_may_hold_polyhedra(mem *m, const vtk_cells_source *s, bool *out);

/* vtk_cells_finish() - check, behind the last cell, that the arrays end there. */
CHECKED status vtk_cells_finish(vtk_cells *c);

#endif
