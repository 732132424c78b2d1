/* grid_surface.h - isosurfaces of a part of a treelet file's grid, treelet by treelet.
 *
 * Inside is f >= isovalue. A cell with a sample that is not finite has no surface. Vertices lie on
 * the grid's edges, where the interpolant is linear, so they are exact up to rounding of doubles.
 * Centres (marching_table.h) are found by bisection. A normal is the mean of the interpolant's
 * gradients in the cells around it that are in the treelet (with a halo: all).
 */
#ifndef PREP_EXPORT_GRID_SURFACE_H
#define PREP_EXPORT_GRID_SURFACE_H

#include "prep/export/grid_part.h"
#include "prep/export/piece.h"

/* grid_surface_create() - release *out. isovalues: count of them. Pieces are ordered by isovalue,
 * then by treelet. part and isovalues must outlive it. */
CHECKED status grid_surface_create(mem *m, leaf_file *f, const grid_part *part,
                                   const double *isovalues, uint32_t count, int threads,
                                   piece_source *out);

/* grid_surface_worker() - bytes that each thread needs besides its piece. */
uint64_t grid_surface_worker(const leaf_file *f);

#endif
