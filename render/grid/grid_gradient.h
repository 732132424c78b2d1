/* grid_gradient.h - the gradient along a ray's piece in a cell of a grid (segments.h).
 *
 * The gradient is the trilinear form of eight gradients at the cell's corners, so a cubic along the
 * ray. These are central differences where there is a halo and all neighbours are finite.
 * Elsewhere, and where the scene asks for analytic normals, they are the gradients of the cell's
 * own trilinear form. The middle of the piece tells which cell it is.
 */
#ifndef RENDER_GRID_GRID_GRADIENT_H
#define RENDER_GRID_GRID_GRADIENT_H

#include "render/ray/segments.h"

/* grid_gradient() - the kind's `gradient` (kind.h). tr->own: a walk_scene. */
void grid_gradient(const tracer *tr, const treelet *at, const ray *r, const segment *s,
                   segment_gradient *out);

#endif
