/* mesh_chain.h - the tets of a treelet on a ray's way, from tet to tet through their faces (M08
 * 6.3): an alternative to going down the tree to each (mesh_walk_each()).
 *
 * A chain begins at an outer face (mesh_faces.h) by which the ray comes in, and goes on until it
 * leaves by one; the tree is searched for such faces alone. Where a treelet is not convex, or has
 * holes, there are several. Faces are taken by exact signs, so that no tet is lost or met twice,
 * whatever the ray runs through or along; t and values are those of tet_segment(), to the bit, but
 * found once a face.
 */
#ifndef RENDER_MESH_MESH_CHAIN_H
#define RENDER_MESH_MESH_CHAIN_H

#include "render/mesh/mesh_faces.h"
#include "render/mesh/tet_segment.h"
#include "render/ray/counters.h"

/* mesh_chain_each() - visit() with the active tets of a treelet that the ray crosses, and where,
 * but for those that begin behind `nearest` by more than rounding; in no order. */
typedef void mesh_chain_visit(void *ctx, const resident_mesh *at, uint32_t local,
                              const tet_piece *p);
void mesh_chain_each(const resident_mesh *at, const ray *r, double nearest, mesh_chain_visit *visit,
                     void *ctx, ray_counters *counters);

#endif
