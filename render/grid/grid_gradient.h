/* grid_gradient.h - the gradient along a ray's piece in a cell of a grid (segments.h).
 *
 * It is the trilinear form of eight gradients at the cell's corners, so a cubic along the ray:
 * central differences, where there is a halo and all neighbours are finite; else, and where the
 * scene asks for analytic normals, those of the cell's own trilinear form. Which cell it is says
 * the middle of the piece.
 */
#ifndef RENDER_GRID_GRID_GRADIENT_H
#define RENDER_GRID_GRID_GRADIENT_H

#include "render/ray/segments.h"

/* grid_gradient() - the row's `gradient`. tr->own: a walk_scene. */
void grid_gradient(const tracer *tr, const treelet *at, const ray *r, const segment *s,
                   segment_gradient *out);

#endif
