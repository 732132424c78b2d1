#include "render/mesh/mesh_passage.h"

#include "formats/base/heap.h"

static bool passage_less(mesh_passage a, mesh_passage b) {
    return a.t_in != b.t_in ? a.t_in < b.t_in : a.t < b.t;
}

static bool enter(const mesh_passages *s, mesh_passage_node *node) {
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

/* A node comes before treelets that are entered where it is: these may be below it. */
static bool node_less(const mesh_passage_node *a, const mesh_passage_node *b) {
    if (a->t_in != b->t_in)
        return a->t_in < b->t_in;
    return a->level != b->level ? a->level > b->level : a->i < b->i;
}

HEAP_RISE(node, mesh_passage_node, node_less)
HEAP_SINK(node, mesh_passage_node, node_less)

static void push_node(mesh_passages *s, mesh_passage_node node) {
    if (s->count == MESH_PASSAGES_AHEAD)
        s->overflown = true;
    else
        node_rise(s->heap, s->count++, node);
}

static mesh_passage_node pop_node(mesh_passages *s) {
    const mesh_passage_node first = s->heap[0], last = s->heap[--s->count];
    node_sink(s->heap, 0, s->count, last);
    return first;
}

static void push_children(mesh_passages *s, const mesh_passage_node *node, double limit) {
    uint32_t count, first = treelet_tree_children(s->tree, node->level, node->i, &count);
    s->counters->nodes++;
    for (uint32_t c = 0; c < count; c++) {
        mesh_passage_node child = {.level = node->level - 1, .i = first + c};
        if (enter(s, &child) && child.t_in <= limit)
            push_node(s, child);
    }
}

void mesh_passages_begin(mesh_passages *s, const treelet_tree *tree, const ray *r, const hit *after,
                         ray_counters *counters) {
    mesh_passage_node root = {.level = tree->levels - 1};
    s->tree = tree;
    s->slabs = mesh_slabs_of(r);
    s->behind = mesh_walk_behind(tree->bounds[tree->levels - 1][0], r, after);
    s->counters = counters;
    s->count = 0;
    s->overflown = false;
    if (enter(s, &root))
        push_node(s, root);
}

static mesh_passage pop_passage(mesh_passages *s, mesh_passage last, double limit) {
    while (s->count > 0 && s->heap[0].t_in <= limit) {
        const mesh_passage_node node = pop_node(s);
        const mesh_passage p = {node.t_in, node.i};
        if (node.level > 0)
            push_children(s, &node, limit);
        else if (passage_less(last, p))
            return p;
    }
    return (mesh_passage){limit, LEAF_NO_TREELET};
}

/* ---- From the root on ---- */

enum { STACK_MAX = TREELET_TREE_LEVELS_MAX * TREELET_TREE_ARITY };

static mesh_passage find_passage(const mesh_passages *s, mesh_passage last, double limit) {
    mesh_passage best = {limit, LEAF_NO_TREELET};
    mesh_passage_node stack[STACK_MAX];
    int top = 0;
    stack[top++] = (mesh_passage_node){.level = s->tree->levels - 1};
    while (top > 0) {
        mesh_passage_node node = stack[--top];
        if (!enter(s, &node) || node.t_in > best.t_in)
            continue;
        if (node.level == 0) {
            const mesh_passage p = {node.t_in, node.i};
            if (passage_less(last, p) && passage_less(p, best))
                best = p;
            continue;
        }
        uint32_t count, first = treelet_tree_children(s->tree, node.level, node.i, &count);
        s->counters->nodes++;
        for (uint32_t c = 0; c < count; c++)
            stack[top++] = (mesh_passage_node){.level = node.level - 1, .i = first + c};
    }
    return best;
}

mesh_passage mesh_passages_next(mesh_passages *s, mesh_passage last, double limit) {
    const mesh_passage next = pop_passage(s, last, limit);
    return s->overflown ? find_passage(s, last, limit) : next;
}
