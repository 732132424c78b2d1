/* grid_kind.h - the row of regular and rectilinear grids of voxels in the table of kinds. */
#ifndef RENDER_GRID_GRID_KIND_H
#define RENDER_GRID_GRID_KIND_H

#include "render/grid/cell_kernel.h"
#include "render/ray/kind.h"

extern const kind grid_kind;

/* grid_intersect_by() - draw an open grid with this cell intersector instead of the scene's, ray by
 * ray; NULL: with the scene's again. For benchmarks. */
void grid_intersect_by(leafcast *v, intersect_fn intersect);

#endif
