/* mesh_walk.h - one ray through one treelet of a mesh: the nearest hit with the selected
 * isosurfaces.
 *
 * The implicit BVH (W07 5): nodes without active tets below are passed over, the others
 * are visited front to back as far as the ray meets their boxes; in the leaves every active tet
 * goes to the kernel.
 */
#ifndef RENDER_MESH_MESH_WALK_H
#define RENDER_MESH_MESH_WALK_H

#include "render/mesh/tet_kernel.h"
#include "render/ray/tracer.h"
#include "stream/mesh_resident.h"

/* mesh_walk() - lower state->best to the first hit in this treelet that counts, in the order of
 * tet_less(), if there is a lesser one; where any hit will do, to some. Returns whether it changed.
 *
 * A tet's isopolygon is flat: a ray that begins there (state->origin) does not meet it again. */
bool mesh_walk(const isovalue_list *isos, const resident_mesh *tr, const ray *r, trace_state *state,
               ray_counters *counters);

/* mesh_walk_each() - visit() with every active tet of the treelet whose box the ray meets, as far
 * as it is not left before `after` or entered behind `nearest`; in no order. Of a node only the
 * children that choose() says, a bit each; NULL: all. `among`: others than the active tets. */
typedef struct mesh_walk_visitor {
    void (*visit)(void *ctx, const resident_mesh *tr, uint32_t local, const tet *x);
    unsigned (*choose)(void *ctx, const resident_mesh *tr, uint32_t node);
    void *ctx;
    const mesh_active *among;
} mesh_walk_visitor;
void mesh_walk_each(const resident_mesh *tr, const ray *r, const hit *after, double nearest,
                    const mesh_walk_visitor *v, ray_counters *counters);

/* mesh_walk_tet() - a tet of the treelet by its local number. */
tet mesh_walk_tet(const resident_mesh *tr, uint32_t local);

/* mesh_walk_gradients() - those at its vertices; for treelets that have them. */
void mesh_walk_gradients(const resident_mesh *tr, uint32_t local, float gradients[4][3]);

/* mesh_walk_find() - the first tet that holds a point of its treelet's box, boundary included, by
 * exact signs, and the point's barycentric coordinates there: 0 exactly for vertices that have no
 * part in it. Flat tets hold none. */
bool mesh_walk_find(const resident_mesh *tr, const double point[3], uint32_t *local,
                    double weights[4]);

/* Kernel and boxes round differently; what is given away is a millionth of the distance
 * (render/ray/ray_box.h). */
#define MESH_GENEROSITY 0x1p-20

/* The part of a ray's [t0, t1] in a box, generously: never less than the t of what the kernel finds
 * in it. */
typedef struct mesh_interval {
    double t_in, t_out;
} mesh_interval;

/* A ray as boxes see it. */
typedef struct mesh_slabs {
    double o[3], inverse[3]; /* of d; 0: d = 0 */
    double t0, t1;
} mesh_slabs;

mesh_slabs mesh_slabs_of(const ray *r);

/* mesh_interval_in() - false when the ray passes the box by. Monotone: what lies within another box
 * begins no earlier. */
bool mesh_interval_in(const mesh_slabs *s, const double lo[3], const double hi[3],
                      mesh_interval *out);

/* mesh_walk_slack() - more than what a t about this one errs by, among the tets in these bounds.
 */
double mesh_walk_slack(const float bounds[6], const ray *r, double t);

/* mesh_walk_behind() - what a ray leaves before this t holds no hit behind `after`, if it is among
 * the tets in these bounds. */
double mesh_walk_behind(const float bounds[6], const ray *r, const hit *after);

#endif
