/* tracer.h - one ray through the whole volume, treelet by treelet, resumable.
 *
 * The directory is walked as an octree of treelets by its merged ranges; each treelet of the wanted
 * level that the ray meets is walked in turn. A ray that meets an active treelet which is not
 * resident suspends: its state says where to resume and what it has found so far. Since treelets
 * come front to back and a hit is final only when nothing unresolved can come before it, the answer
 * does not depend on what was resident when. For meshes it is mesh_tracer.h that does so.
 */
#ifndef RENDER_TRACER_H
#define RENDER_TRACER_H

#include <stdatomic.h>

#include "render/grid/surface.h"
#include "render/grid/walk.h"
#include "stream/loader.h"

typedef struct tracer {
    walk_scene scene;
    walk_fn walk;
    const loader *treelets;
    const leaf_layout *layout;
    const treelet_tree *tree; /* of a mesh; NULL for a grid */
    affine space;
    double box[2][3]; /* of the volume, grid space */
    bool analytic_normals;
    bool smooth_normals;   /* of a mesh: its treelets have gradients */
    bool preview;          /* draw the finest resident ancestor instead of suspending */
    uint32_t target_level; /* the level that is drawn; */
    const uint8_t *stop;   /* when not NULL, also at treelets with a 1 */
    atomic_uchar *touched; /* per treelet: set when a ray walked it */
    int clip_count;
    double clip[32][4]; /* world-space half-spaces n . p + d >= 0 */
} tracer;

typedef enum trace_result { TRACE_HIT, TRACE_MISS, TRACE_BLOCKED } trace_result;

/* A ray's search for its next hit. */
typedef struct trace_state {
    hit after;           /* only hits strictly behind this one count */
    hit best;            /* the nearest found so far; none: hit_none() */
    surface_point point; /* of best */
    double t_from;       /* where to resume; */
    uint32_t blocked;    /* at this treelet; LEAF_NO_TREELET: from the start */
    bool provisional;    /* preview: something was drawn coarser than wanted, or not yet at all */
    bool any;            /* any hit will do as best, and its point does not matter */
} trace_state;

/* tracer_ray() - a world-space ray for t in [t0, t1], cut by the clip planes. False when nothing of
 * it is left. */
bool tracer_ray(const tracer *tr, const double origin[3], const double direction[3], double t0,
                double t1, ray *out);

/* trace_begin() - look for the first hit strictly behind `after`. */
trace_state trace_begin(const hit *after);

/* tracer_next() - go on until the next hit is certain (state->best, state->point), nothing is left,
 * or the treelet state->blocked is needed. */
trace_result tracer_next(const tracer *tr, const ray *r, trace_state *state,
                         ray_counters *counters);

/* tracer_surface() - the point of hit h on ray r, which lies in this treelet. */
surface_point tracer_surface(const tracer *tr, const treelet *at, const ray *r, const hit *h);

#endif
