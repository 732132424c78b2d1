/* mesh_walk.h - one ray through one treelet of a mesh: finds the nearest hit with the selected
 * isosurfaces.
 *
 * The implicit BVH (W07 5): nodes without active tets below are skipped. The others are visited
 * front to back if the ray meets their boxes. In the leaves every active tet goes to the kernel.
 */
#ifndef RENDER_MESH_MESH_WALK_H
#define RENDER_MESH_MESH_WALK_H

#include "render/mesh/tet_kernel.h"
#include "render/ray/tracer.h"
#include "render/walk/box_interval.h"
#include "stream/mesh_resident.h"

/* mesh_walk() - lowers state->best to the first hit in this treelet that counts, in the order of
 * flat_polygon_less(); if any hit will do, to some hit. Returns whether state->best changed.
 *
 * A tet's isopolygon is flat: a ray that begins on it (state->origin) does not meet it again. */
bool mesh_walk(const isovalue_list *isos, const resident_mesh *tr, const ray *r, trace_state *state,
               ray_counters *counters);

/* mesh_walk_each() - calls visit() for every active tet of the treelet whose box the ray meets, in
 * no order. Leaves out boxes that the ray leaves before `after` or enters behind `nearest`.
 * choose() returns which children of a node to visit, a bit each; NULL: all. among: masks to use
 * instead of the active tets; NULL: the active tets. */
typedef struct mesh_walk_visitor {
    void (*visit)(void *ctx, const resident_mesh *tr, uint32_t local, const tet *x);
    unsigned (*choose)(void *ctx, const resident_mesh *tr, uint32_t node);
    void *ctx;
    const mesh_active *among;
} mesh_walk_visitor;
void mesh_walk_each(const resident_mesh *tr, const ray *r, const hit *after, double nearest,
                    const mesh_walk_visitor *v, ray_counters *counters);

/* mesh_walk_tet() - returns a tet of the treelet by its local number. */
tet mesh_walk_tet(const resident_mesh *tr, uint32_t local);

/* mesh_walk_gradients() - copies the gradients at a tet's vertices; for treelets that have them. */
void mesh_walk_gradients(const resident_mesh *tr, uint32_t local, float gradients[4][3]);

/* mesh_walk_find() - finds the first tet of the treelet that holds a point of its box, boundary
 * included, by exact signs. Also gives the point's barycentric coordinates in it: exactly 0 for
 * vertices that have no part. Flat tets hold no point. */
bool mesh_walk_find(const resident_mesh *tr, const double point[3], uint32_t *local,
                    double weights[4]);

#endif
