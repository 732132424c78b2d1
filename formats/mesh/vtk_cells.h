/* vtk_cells.h - the cells of one piece of a VTK grid, in order: their types and the ids of their
 * points.
 */
#ifndef FORMATS_MESH_VTK_CELLS_H
#define FORMATS_MESH_VTK_CELLS_H

#include "formats/base/mem.h"
#include "formats/mesh/mesh_sink.h"
#include "formats/vtk/vtk_array.h"

/* Where they are written. Without offsets, each cell's number of points stands in front of its ids.
 */
typedef struct vtk_cells_source {
    uint64_t count;
    vtk_array types, offsets, ids;
    const vtk_array *ghosts; /* vtkGhostType or vtkGhostLevels; NULL: there is none */
    bool from_zero;    /* the offsets start with a 0, so there is one more of them than cells */
    uint64_t ids_size; /* numbers in ids; VTK_CURSOR_ANY for as many as there are */
} vtk_cells_source;

typedef struct vtk_cell {
    bool volume;    /* else vertices, lines or surfaces, which have no kind and no ids here */
    mesh_cell kind; /* arranged as mesh_input.h has it */
    int count;      /* of ids */
    uint64_t ids[8];
    bool copied; /* another piece has it, too; or */
    bool hidden; /* nobody shall see it: finer ones are in its place, say */
} vtk_cell;

typedef struct vtk_cells vtk_cells;

/* vtk_cells_open() - of a source that must outlive it; checks that its arrays are there. */
CHECKED status vtk_cells_open(mem *m, const vtk_cells_source *source, vtk_cells **out);
void vtk_cells_close(vtk_cells *c); /* NULL is fine */

/* vtk_cells_next() - the next of source->count cells. ST_CORRUPT for types, offsets and numbers of
 * points that cannot be; ST_UNSUPPORTED for polyhedra and volumes with curved edges. */
CHECKED status vtk_cells_next(vtk_cells *c, vtk_cell *cell);

/* vtk_cells_finish() - behind the last cell: check that the arrays end there. */
CHECKED status vtk_cells_finish(vtk_cells *c);

#endif
