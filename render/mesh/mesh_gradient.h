/* mesh_gradient.h - the gradient along a ray's piece in a tet (segments.h): the tet's own, or if
 * the scene asks for smooth normals, the vertices' gradients in barycentric interpolation.
 */
#ifndef RENDER_MESH_MESH_GRADIENT_H
#define RENDER_MESH_MESH_GRADIENT_H

#include "render/ray/segments.h"

/* mesh_gradient() - the row's `gradient`. tr->own: a mesh_rays. */
void mesh_gradient(const tracer *tr, const treelet *at, const ray *r, const segment *s,
                   segment_gradient *out);

#endif
