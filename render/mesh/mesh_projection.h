/* mesh_projection.h - the projection of a mesh's boxes. Planes may lie anywhere, so each is
 * projected when it is met. */
#ifndef RENDER_MESH_MESH_PROJECTION_H
#define RENDER_MESH_MESH_PROJECTION_H

#include "render/look/projection.h"

/* mesh_projection_init() - bounds: of the mesh, lo x y z, hi x y z. Allocates nothing. */
void mesh_projection_init(projection *p, const float bounds[6], const camera *c);

#endif
