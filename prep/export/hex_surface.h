/* hex_surface.h - isosurfaces of cells that are hexahedra, treelet by treelet: marching cubes in
 * each cell's parameters.
 *
 * Inside is f >= isovalue. A cell with a value that is not finite has no surface. Vertices lie on
 * edges, where position and value are linear; centres (marching_cell.h) are found by bisection. So
 * all lie on the interpolant's surface up to rounding of doubles. Cells that share a face have the
 * same lines on it. A normal is the mean of the interpolant's gradients in the treelet's cells
 * around, weighted by the volume of their edges there. Corners that are the same node make
 * triangles that have the same vertex twice: these are left out.
 */
#ifndef PREP_EXPORT_HEX_SURFACE_H
#define PREP_EXPORT_HEX_SURFACE_H

#include "prep/export/cell_choice.h"
#include "prep/export/piece.h"

/* hex_surface_create() - release *out. surfaces of the choice's first field. isovalues: count of
 * them. Pieces are ordered by isovalue, then by treelet. choice and isovalues must outlive it. */
CHECKED status hex_surface_create(mem *m, const cell_choice *choice, const double *isovalues,
                                  uint32_t count, int threads, piece_source *out);

/* hex_surface_worker() - bytes that each thread needs besides its piece. */
uint64_t hex_surface_worker(const cell_choice *choice);

#endif
