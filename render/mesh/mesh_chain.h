/* mesh_chain.h - finds the tets of a treelet on a ray's way, from tet to tet through their faces
 * (M08 6.3): an alternative to going down the tree to each (mesh_walk_each()).
 *
 * A chain begins at an outer face (mesh_faces.h) by which the ray comes in, and ends at one by
 * which it leaves. The tree is searched only for such faces. A treelet that is not convex, or has
 * holes, gives several chains. Faces are chosen by exact signs, so no tet is lost or met twice,
 * whatever the ray runs through or along. t and values are those of tet_segment(), to the bit, but
 * computed once a face.
 */
#ifndef RENDER_MESH_MESH_CHAIN_H
#define RENDER_MESH_MESH_CHAIN_H

#include "render/mesh/mesh_faces.h"
#include "render/mesh/tet_segment.h"
#include "render/ray/counters.h"

/* mesh_chain_each() - calls visit() for each active tet of the treelet that the ray crosses, with
 * its piece of the ray, in no order. Leaves out tets that begin behind `nearest` by more than
 * rounding. */
typedef void mesh_chain_visit(void *ctx, const resident_mesh *at, uint32_t local,
                              const tet_piece *p);
void mesh_chain_each(const resident_mesh *at, const ray *r, double nearest, mesh_chain_visit *visit,
                     void *ctx, ray_counters *counters);

#endif
