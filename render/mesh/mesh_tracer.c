#include "render/mesh/mesh_tracer.h"

#include "formats/base/heap.h"
#include "render/mesh/mesh_walk.h"
#include "render/mesh/tet_smooth.h"

/* A treelet on a ray's way. */
typedef struct passage {
    double t_in;
    uint32_t t; /* LEAF_NO_TREELET: none */
} passage;

static bool passage_less(passage a, passage b) {
    return a.t_in != b.t_in ? a.t_in < b.t_in : a.t < b.t;
}

/* What a search does not change. */
typedef struct search {
    const treelet_tree *tree;
    mesh_slabs slabs;
    double behind; /* what the ray leaves before that is of no interest */
    ray_counters *counters;
} search;

static search search_of(const tracer *tr, const ray *r, const hit *after, ray_counters *counters) {
    const treelet_tree *tree = mesh_rays_of(tr)->tree;
    return (search){tree, mesh_slabs_of(r),
                    mesh_walk_behind(tree->bounds[tree->levels - 1][0], r, after), counters};
}

/* A node of the tree over the treelets that the ray enters at t_in. */
typedef struct tree_node {
    double t_in;
    uint32_t level, i;
} tree_node;

static bool enter(const search *s, tree_node *node) {
    const float *bounds = s->tree->bounds[node->level][node->i];
    double lo[3], hi[3];
    mesh_interval in;
    if (!s->tree->active[node->level][node->i])
        return false;
    for (int a = 0; a < 3; a++) {
        lo[a] = (double)bounds[a];
        hi[a] = (double)bounds[a + 3];
    }
    if (!mesh_interval_in(&s->slabs, lo, hi, &in) || in.t_out < s->behind)
        return false;
    node->t_in = in.t_in;
    return true;
}

/* ---- Nodes by where the ray enters them ---- */

/* Some hundreds of boxes that overlap, and the ray in all of them: more are looked up one by one.
 */
enum { AHEAD_MAX = 256 };

/* What lies ahead of a ray: a heap, the first at its top. */
typedef struct frontier {
    size_t count;
    bool overflown; /* something is missing: the rest is for next_passage() */
    tree_node heap[AHEAD_MAX];
} frontier;

/* A node comes before treelets that are entered where it is: these may be below it. */
static bool node_less(const tree_node *a, const tree_node *b) {
    if (a->t_in != b->t_in)
        return a->t_in < b->t_in;
    return a->level != b->level ? a->level > b->level : a->i < b->i;
}

HEAP_RISE(node, tree_node, node_less)
HEAP_SINK(node, tree_node, node_less)

static void push_node(frontier *f, tree_node node) {
    if (f->count == AHEAD_MAX)
        f->overflown = true;
    else
        node_rise(f->heap, f->count++, node);
}

static tree_node pop_node(frontier *f) {
    const tree_node first = f->heap[0], last = f->heap[--f->count];
    node_sink(f->heap, 0, f->count, last);
    return first;
}

static void push_children(const search *s, const tree_node *node, double limit, frontier *f) {
    uint32_t count, first = treelet_tree_children(s->tree, node->level, node->i, &count);
    s->counters->nodes++;
    for (uint32_t c = 0; c < count; c++) {
        tree_node child = {.level = node->level - 1, .i = first + c};
        if (enter(s, &child) && child.t_in <= limit)
            push_node(f, child);
    }
}

static void begin_frontier(const search *s, frontier *f) {
    tree_node root = {.level = s->tree->levels - 1};
    f->count = 0;
    f->overflown = false;
    if (enter(s, &root))
        push_node(f, root);
}

/* next_passage() of one call after the other. */
static passage pop_passage(const search *s, frontier *f, passage last, double limit) {
    while (f->count > 0 && f->heap[0].t_in <= limit) {
        const tree_node node = pop_node(f);
        const passage p = {node.t_in, node.i};
        if (node.level > 0)
            push_children(s, &node, limit, f);
        else if (passage_less(last, p))
            return p;
    }
    return (passage){limit, LEAF_NO_TREELET};
}

/* ---- From the root on ---- */

enum { STACK_MAX = TREELET_TREE_LEVELS_MAX * TREELET_TREE_ARITY };

/* The first active treelet behind `last` that the ray enters at `limit` or before. */
static passage next_passage(const search *s, passage last, double limit) {
    passage best = {limit, LEAF_NO_TREELET};
    tree_node stack[STACK_MAX];
    int top = 0;
    stack[top++] = (tree_node){.level = s->tree->levels - 1};
    while (top > 0) {
        tree_node node = stack[--top];
        if (!enter(s, &node) || node.t_in > best.t_in)
            continue;
        if (node.level == 0) {
            const passage p = {node.t_in, node.i};
            if (passage_less(last, p) && passage_less(p, best))
                best = p;
            continue;
        }
        uint32_t count, first = treelet_tree_children(s->tree, node.level, node.i, &count);
        s->counters->nodes++;
        for (uint32_t c = 0; c < count; c++)
            stack[top++] = (tree_node){.level = node.level - 1, .i = first + c};
    }
    return best;
}

/* ---- Treelets ---- */

/* Look for hits in a treelet. True: nothing else needs to be looked at. */
static bool walk_passage(const tracer *tr, const treelet *here, const ray *r, trace_state *state,
                         ray_counters *counters) {
    if (!mesh_walk(&tr->isos, here, r, &state->after, state->any, &state->best, counters))
        return false;
    if (!state->any)
        state->point = mesh_tracer_surface(tr, here, r, &state->best);
    return state->any;
}

trace_result mesh_tracer_next(const tracer *tr, const ray *r, trace_state *state,
                              ray_counters *counters) {
    const search s = search_of(tr, r, &state->after, counters);
    frontier f;
    bool resuming = state->blocked != LEAF_NO_TREELET;
    passage at = {resuming ? state->t_from : -INFINITY, resuming ? state->blocked : 0};
    begin_frontier(&s, &f);
    for (;; resuming = false) {
        if (!resuming) {
            const passage next = pop_passage(&s, &f, at, state->best.t);
            at = f.overflown ? next_passage(&s, at, state->best.t) : next;
            if (at.t == LEAF_NO_TREELET)
                return hit_exists(&state->best) ? TRACE_HIT : TRACE_MISS;
        }
        const treelet *here =
            tracer_enter(tr, at.t, at.t_in, &state->t_from, &state->blocked, &state->provisional);
        if (!here && !tr->preview)
            return TRACE_BLOCKED;
        if (here && walk_passage(tr, here, r, state, counters))
            return TRACE_HIT;
    }
}

surface_point mesh_tracer_surface(const tracer *tr, const treelet *at, const ray *r, const hit *h) {
    const uint32_t place = (uint32_t)(h->cell - at->first_tet);
    const double iso = tr->isos.isovalues[h->iso];
    const tet x = mesh_walk_tet(at, place);
    surface_point point = tet_surface(&x, r, iso, h);
    isopolygon g;
    if (mesh_rays_of(tr)->smooth && isopolygon_of(&x, iso, &g)) {
        float gradients[4][3];
        tet_smooth s;
        mesh_walk_gradients(at, place, gradients);
        tet_smooth_of(&x, iso, &g, (const float(*)[3])gradients, &s);
        (void)tet_smooth_normal(&s, r->o, r->d, h->t, point.normal);
    }
    return point;
}
