#include "render/grid/grid_tracer.h"

#include "render/grid/octree_step.h"
#include "render/grid/surface.h"

/* A subtree of the directory still to be visited; octants != 0: instead, these eighths of the
 * treelet itself. */
typedef struct pending {
    double t_in, t_out;
    uint32_t t;
    uint32_t octants;
} pending;

static void split_planes(const tracer *tr, uint32_t t, double middle[3]) {
    const walk_scene *scene = tr->own;
    const leaf_layout *layout = tr->layout;
    const uint32_t level = layout->level_of[t], half = 1u << (layout->cells_log2 - 1);
    for (int a = 0; a < 3; a++)
        middle[a] = scene->levels[level].at[a][(layout->place[t][a] << layout->cells_log2) + half];
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

surface_point grid_tracer_surface(const tracer *tr, const treelet *at, const ray *r, const hit *h) {
    const walk_scene *scene = tr->own;
    return surface_at(scene, &tr->space, at, r, h, scene->analytic_normals);
}

static void walk_resident(const tracer *tr, const ray *r, const treelet *at, const pending *node,
                          trace_state *state, ray_counters *counters) {
    const walk_scene *scene = tr->own;
    const unsigned octants = node->octants ? node->octants : 255u;
    if (scene->walk(scene, at, r, node->t_in, node->t_out, octants, &state->after, &state->best,
                    counters))
        state->point = grid_tracer_surface(tr, at, r, &state->best);
}

enum { STACK_MAX = 4 * LEAF_LEVELS_MAX };

trace_result grid_tracer_next(const tracer *tr, const ray *r, trace_state *state,
                              ray_counters *counters) {
    double t_in = fmax(fmax(r->t0, state->after.t), state->t_from), t_out = r->t1;
    if (!tracer_box(tr, r, &t_in, &t_out))
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
        const treelet *at = tracer_enter(tr, node.t, node.t_in, state);
        if (!at && !tr->preview)
            return TRACE_BLOCKED;
        resuming = false;
        if (at)
            walk_resident(tr, r, at, &node, state, counters);
    }
    return hit_exists(&state->best) ? TRACE_HIT : TRACE_MISS;
}
