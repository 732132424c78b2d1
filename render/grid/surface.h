/* surface.h - the point where a ray met an isosurface in a cell of a grid. */
#ifndef RENDER_GRID_SURFACE_H
#define RENDER_GRID_SURFACE_H

#include <stdbool.h>

#include "render/grid/walk.h"
#include "render/ray/affine.h"
#include "render/ray/surface_point.h"

/* surface_at() - the point of hit h on ray r, whose cell lies in tr. analytic: take the normal from
 * the cell's own gradient (always so without a halo, or where a neighbour is not finite). */
surface_point surface_at(const walk_scene *scene, const affine *space, const resident_grid *tr,
                         const ray *r, const hit *h, bool analytic);

/* surface_gradients() - central differences at the corners of a cell, in grid space, one-sided at
 * the volume's ends: [corner x + 2y + 4z][axis], and a 0. Needs a halo. */
void surface_gradients(const walk_scene *scene, const resident_grid *tr, const uint32_t cell[3],
                       double gradients[8][4]);

/* surface_cell_of() - a cell's place from its global index. */
void surface_cell_of(const level_planes *planes, uint64_t index, uint32_t cell[3]);

/* surface_trilinear() - value and grid-space gradient of a cell's trilinear form at cell
 * coordinates. */
double surface_trilinear(const float samples[8], const double at[3], const double inverse[3],
                         double gradient[3]);

#endif
