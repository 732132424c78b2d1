#include "render/tracer.h"

#include "render/grid/octree_step.h"
#include "render/mesh/mesh_tracer.h"

/* Cut [t0, t1] by n . (o + t d) + w >= 0. */
static bool cut(const double plane[4], const double o[3], const double d[3], double *t0,
                double *t1) {
    const double at_origin = plane[0] * o[0] + plane[1] * o[1] + plane[2] * o[2] + plane[3];
    const double slope = plane[0] * d[0] + plane[1] * d[1] + plane[2] * d[2];
    if (slope == 0.0)
        return at_origin >= 0.0;
    const double t = -at_origin / slope;
    if (slope > 0.0 && t > *t0)
        *t0 = t;
    if (slope < 0.0 && t < *t1)
        *t1 = t;
    return *t0 <= *t1;
}

/* The part of [t0, t1] in which the ray is in the volume's closed box. */
static bool box_interval(const tracer *tr, const ray *r, double *t0, double *t1) {
    for (int a = 0; a < 3; a++) {
        if (r->d[a] == 0.0) {
            if (r->o[a] < tr->box[0][a] || r->o[a] > tr->box[1][a])
                return false;
            continue;
        }
        const double near = (tr->box[r->d[a] < 0.0][a] - r->o[a]) / r->d[a];
        const double far = (tr->box[r->d[a] > 0.0][a] - r->o[a]) / r->d[a];
        *t0 = near > *t0 ? near : *t0;
        *t1 = far < *t1 ? far : *t1;
    }
    return *t0 <= *t1;
}

bool tracer_ray(const tracer *tr, const double origin[3], const double direction[3], double t0,
                double t1, ray *out) {
    for (int i = 0; i < tr->clip_count; i++)
        if (!cut(tr->clip[i], origin, direction, &t0, &t1))
            return false;
    affine_point_to_grid(&tr->space, origin, out->o);
    affine_vector_to_grid(&tr->space, direction, out->d);
    for (int a = 0; a < 3; a++) {
        out->d[a] += 0.0; /* -0 becomes +0 */
        const double below_end = nextafter(tr->box[1][a], tr->box[0][a]);
        out->held[a] = out->o[a] < below_end ? out->o[a] : below_end;
    }
    /* Coarse levels reach past the volume: there the box is a clip interval like any other. */
    if ((tr->preview || tr->stop || tr->target_level > 0) && !box_interval(tr, out, &t0, &t1))
        return false;
    out->t0 = t0;
    out->t1 = t1;
    return true;
}

trace_state trace_begin(const hit *after) {
    return (trace_state){
        .after = *after, .best = hit_none(), .t_from = -INFINITY, .blocked = LEAF_NO_TREELET};
}

/* A subtree of the directory still to be visited; octants != 0: instead, these eighths of the
 * treelet itself. */
typedef struct pending {
    double t_in, t_out;
    uint32_t t;
    uint32_t octants;
} pending;

static void split_planes(const tracer *tr, uint32_t t, double middle[3]) {
    const leaf_layout *layout = tr->layout;
    const uint32_t level = layout->level_of[t], half = 1u << (layout->cells_log2 - 1);
    for (int a = 0; a < 3; a++)
        middle[a] =
            tr->scene.levels[level].at[a][(layout->place[t][a] << layout->cells_log2) + half];
}

/* Push what of treelet t's children holds a surface and is passed, the nearest last. */
static int push_children(const tracer *tr, const ray *r, const pending *node, pending *stack,
                         int top, bool *provisional) {
    const leaf_layout *layout = tr->layout;
    const unsigned active = tr->treelets->children[node->t];
    const unsigned existing = leaf_layout_children(layout, node->t);
    double middle[3];
    octree_child children[4];
    split_planes(tr, node->t, middle);
    for (int i = octree_step(r, middle, node->t_in, node->t_out, children); i-- > 0;) {
        const unsigned o = children[i].octant;
        if (!(active >> o & 1u))
            continue;
        const uint32_t rank = (uint32_t)__builtin_popcount(existing & ((1u << o) - 1u));
        pending p = {children[i].t_in, children[i].t_out, layout->first_child[node->t] + rank, 0};
        if (tr->preview && tr->treelets->own[p.t] && !loader_lookup(tr->treelets, p.t)) {
            /* The finest resident ancestor stands in, as far as this one is above it. */
            *provisional = true;
            if (!loader_lookup(tr->treelets, node->t))
                continue;
            p.t = node->t;
            p.octants = 1u << o;
        }
        stack[top++] = p;
    }
    return top;
}

surface_point tracer_surface(const tracer *tr, const treelet *at, const ray *r, const hit *h) {
    return tr->tree ? mesh_tracer_surface(tr, at, r, h)
                    : surface_at(&tr->scene, &tr->space, at, r, h, tr->analytic_normals);
}

static void walk_resident(const tracer *tr, const ray *r, const treelet *at, const pending *node,
                          trace_state *state, ray_counters *counters) {
    if (!atomic_load_explicit(&tr->touched[node->t], memory_order_relaxed))
        atomic_store_explicit(&tr->touched[node->t], 1, memory_order_relaxed);
    const unsigned octants = node->octants ? node->octants : 255u;
    if (tr->walk(&tr->scene, at, r, node->t_in, node->t_out, octants, &state->after, &state->best,
                 counters))
        state->point = tracer_surface(tr, at, r, &state->best);
}

enum { STACK_MAX = 4 * LEAF_LEVELS_MAX };

trace_result tracer_next(const tracer *tr, const ray *r, trace_state *state,
                         ray_counters *counters) {
    if (tr->tree)
        return mesh_tracer_next(tr, r, state, counters);
    double t_in = fmax(fmax(r->t0, state->after.t), state->t_from), t_out = r->t1;
    if (!box_interval(tr, r, &t_in, &t_out))
        return hit_exists(&state->best) ? TRACE_HIT : TRACE_MISS;
    /* Up to the treelet that blocked, everything in the way has been walked. */
    bool resuming = state->blocked != LEAF_NO_TREELET;
    pending stack[STACK_MAX];
    int top = 0;
    stack[top++] = (pending){t_in, t_out, 0, 0};
    while (top > 0) {
        const pending node = stack[--top];
        if (node.t_in > state->best.t)
            break;
        const bool drawn = node.octants || tr->layout->level_of[node.t] == tr->target_level ||
                           (tr->stop && tr->stop[node.t]);
        if (!drawn) {
            counters->nodes++;
            top = push_children(tr, r, &node, stack, top, &state->provisional);
            continue;
        }
        if (!tr->treelets->own[node.t] || (resuming && node.t != state->blocked))
            continue;
        const treelet *at = loader_lookup(tr->treelets, node.t);
        if (!at && tr->preview) {
            state->provisional = true;
            continue;
        }
        if (!at) {
            state->t_from = node.t_in;
            state->blocked = node.t;
            return TRACE_BLOCKED;
        }
        resuming = false;
        walk_resident(tr, r, at, &node, state, counters);
    }
    return hit_exists(&state->best) ? TRACE_HIT : TRACE_MISS;
}
