#include "render/mesh_tracer.h"

#include "render/mesh_walk.h"

/* A treelet on a ray's way. */
typedef struct passage {
    double t_in;
    uint32_t t; /* LEAF_NO_TREELET: none */
} passage;

static bool passage_less(passage a, passage b) {
    return a.t_in != b.t_in ? a.t_in < b.t_in : a.t < b.t;
}

typedef struct tree_node {
    uint32_t level, i;
} tree_node;

enum { STACK_MAX = TREELET_TREE_LEVELS_MAX * TREELET_TREE_ARITY };

static bool meets(const treelet_tree *tree, tree_node node, const ray *r, double *t_in) {
    double lo[3], hi[3];
    mesh_interval in;
    for (int a = 0; a < 3; a++) {
        lo[a] = (double)tree->bounds[node.level][node.i][a];
        hi[a] = (double)tree->bounds[node.level][node.i][a + 3];
    }
    if (!mesh_interval_of(r, lo, hi, &in))
        return false;
    *t_in = in.t_in;
    return true;
}

/* The first active treelet behind `last` that the ray enters at `limit` or before. */
static passage next_passage(const treelet_tree *tree, const ray *r, passage last, double limit,
                            walk_counters *counters) {
    passage best = {limit, LEAF_NO_TREELET};
    tree_node stack[STACK_MAX];
    int top = 0;
    stack[top++] = (tree_node){tree->levels - 1, 0};
    while (top > 0) {
        const tree_node node = stack[--top];
        double t_in;
        if (!tree->active[node.level][node.i] || !meets(tree, node, r, &t_in) || t_in > best.t_in)
            continue;
        if (node.level == 0) {
            const passage p = {t_in, node.i};
            if (passage_less(last, p) && passage_less(p, best))
                best = p;
            continue;
        }
        uint32_t count, first = treelet_tree_children(tree, node.level, node.i, &count);
        counters->nodes++;
        for (uint32_t c = 0; c < count; c++)
            stack[top++] = (tree_node){node.level - 1, first + c};
    }
    return best;
}

static void touch(const tracer *tr, uint32_t t) {
    if (!atomic_load_explicit(&tr->touched[t], memory_order_relaxed))
        atomic_store_explicit(&tr->touched[t], 1, memory_order_relaxed);
}

trace_result mesh_tracer_next(const tracer *tr, const ray *r, trace_state *state,
                              walk_counters *counters) {
    bool resuming = state->blocked != LEAF_NO_TREELET;
    passage at = {resuming ? state->t_from : -INFINITY, resuming ? state->blocked : 0};
    for (;; resuming = false) {
        if (!resuming) {
            at = next_passage(tr->tree, r, at, state->best.t, counters);
            if (at.t == LEAF_NO_TREELET)
                return hit_exists(&state->best) ? TRACE_HIT : TRACE_MISS;
        }
        const treelet *here = loader_lookup(tr->treelets, at.t);
        if (!here && tr->preview) {
            state->provisional = true;
            continue;
        }
        if (!here) {
            state->t_from = at.t_in;
            state->blocked = at.t;
            return TRACE_BLOCKED;
        }
        touch(tr, at.t);
        if (mesh_walk(&tr->scene, here, r, &state->after, &state->best, counters))
            state->point = mesh_tracer_surface(tr, here, r, &state->best);
    }
}

surface_point mesh_tracer_surface(const tracer *tr, const treelet *at, const ray *r, const hit *h) {
    const tet x = mesh_walk_tet(at, (uint32_t)(h->cell - at->first_tet));
    return tet_surface(&x, r, tr->scene.isovalues[h->iso], h);
}
