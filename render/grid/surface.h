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

/* surface_gradients() - sets gradients[corner x + 2y + 4z][axis] to the central differences at a
 * cell's corners, and [3] to 0. Grid space, one-sided at the volume's ends. Needs a halo. */
void surface_gradients(const walk_scene *scene, const resident_grid *tr, const uint32_t cell[3],
                       double gradients[8][4]);

/* surface_cell_of() - converts a cell's global index to its place on each axis. */
void surface_cell_of(const level_planes *planes, uint64_t index, uint32_t cell[3]);

/* surface_trilinear() - returns the value of a cell's trilinear form at cell coordinates `at`, and
 * its gradient in grid space. inverse: 1 / the cell's width on each axis. */
double surface_trilinear(const float samples[8], const double at[3], const double inverse[3],
                         double gradient[3]);

#endif
