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
#include "stream/mesh_resident.h"

/* mesh_walk() - lowers state->best to the first hit in this treelet that counts, in the order of
 * tet_less(); if any hit will do, to some hit. Returns whether state->best changed.
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

/* Kernel and boxes round differently. So intervals are widened by a millionth of the distance
 * (render/ray/ray_box.h). */
#define MESH_GENEROSITY 0x1p-20

/* The part of a ray's [t0, t1] in a box, widened: it contains every t that the kernel finds in the
 * box. */
typedef struct mesh_interval {
    double t_in, t_out;
} mesh_interval;

/* A ray as boxes see it. */
typedef struct mesh_slabs {
    double o[3], inverse[3]; /* 1 / d; 0 where d = 0 */
    double t0, t1;
} mesh_slabs;

mesh_slabs mesh_slabs_of(const ray *r);

/* mesh_interval_in() - false if the ray misses the box. Monotone: the interval of a box within
 * another begins no earlier. */
bool mesh_interval_in(const mesh_slabs *s, const double lo[3], const double hi[3],
                      mesh_interval *out);

/* mesh_walk_slack() - returns more than the error of any t near this one, among the tets in these
 * bounds. */
double mesh_walk_slack(const float bounds[6], const ray *r, double t);

/* mesh_walk_behind() - returns a t: boxes within these bounds that the ray leaves before it hold no
 * hit behind `after`. */
double mesh_walk_behind(const float bounds[6], const ray *r, const hit *after);

#endif
