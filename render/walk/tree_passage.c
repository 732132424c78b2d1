#include "render/walk/tree_passage.h"

#include "formats/base/heap.h"

static bool passage_less(tree_passage a, tree_passage b) {
    return a.t_in != b.t_in ? a.t_in < b.t_in : a.t < b.t;
}

static bool enter(const tree_passages *s, tree_passage_node *node) {
    return tree_passage_enters(s->tree, &s->slabs, s->behind, node);
}

/* ---- Nodes by where the ray enters them ---- */

/* Order by t_in. At one t_in, inner nodes come before treelets, which may be below them. */
static bool node_less(const tree_passage_node *a, const tree_passage_node *b) {
    if (a->t_in != b->t_in)
        return a->t_in < b->t_in;
    return a->level != b->level ? a->level > b->level : a->i < b->i;
}

HEAP_RISE(node, tree_passage_node, node_less)
HEAP_SINK(node, tree_passage_node, node_less)

static void push_node(tree_passages *s, tree_passage_node node) {
    if (s->count == TREE_PASSAGES_AHEAD)
        s->overflown = true;
    else
        node_rise(s->heap, s->count++, node);
}

static tree_passage_node pop_node(tree_passages *s) {
    const tree_passage_node first = s->heap[0], last = s->heap[--s->count];
    node_sink(s->heap, 0, s->count, last);
    return first;
}

static void push_children(tree_passages *s, const tree_passage_node *node, double limit) {
    uint32_t count, first = treelet_tree_children(s->tree, node->level, node->i, &count);
    s->counters->nodes++;
    for (uint32_t c = 0; c < count; c++) {
        tree_passage_node child = {.level = node->level - 1, .i = first + c};
        if (enter(s, &child) && child.t_in <= limit)
            push_node(s, child);
    }
}

void tree_passages_begin(tree_passages *s, const treelet_tree *tree, const ray *r, const hit *after,
                         ray_counters *counters) {
    tree_passage_node root = {.level = tree->levels - 1};
    s->tree = tree;
    s->slabs = box_line_of(r);
    s->behind = box_interval_behind(tree->bounds[tree->levels - 1][0], r, after);
    s->counters = counters;
    s->count = 0;
    s->overflown = false;
    if (enter(s, &root))
        push_node(s, root);
}

static tree_passage pop_passage(tree_passages *s, tree_passage last, double limit) {
    while (s->count > 0 && s->heap[0].t_in <= limit) {
        const tree_passage_node node = pop_node(s);
        const tree_passage p = {node.t_in, node.i};
        if (node.level > 0)
            push_children(s, &node, limit);
        else if (passage_less(last, p))
            return p;
    }
    return (tree_passage){limit, LEAF_NO_TREELET};
}

/* ---- From the root on ---- */

enum { STACK_MAX = TREELET_TREE_LEVELS_MAX * TREELET_TREE_ARITY };

static tree_passage find_passage(const tree_passages *s, tree_passage last, double limit) {
    tree_passage best = {limit, LEAF_NO_TREELET};
    tree_passage_node stack[STACK_MAX];
    int top = 0;
    stack[top++] = (tree_passage_node){.level = s->tree->levels - 1};
    while (top > 0) {
        tree_passage_node node = stack[--top];
        if (!enter(s, &node) || node.t_in > best.t_in)
            continue;
        if (node.level == 0) {
            const tree_passage p = {node.t_in, node.i};
            if (passage_less(last, p) && passage_less(p, best))
                best = p;
            continue;
        }
        uint32_t count, first = treelet_tree_children(s->tree, node.level, node.i, &count);
        s->counters->nodes++;
        for (uint32_t c = 0; c < count; c++)
            stack[top++] = (tree_passage_node){.level = node.level - 1, .i = first + c};
    }
    return best;
}

tree_passage tree_passages_next(tree_passages *s, tree_passage last, double limit) {
    const tree_passage next = pop_passage(s, last, limit);
    return s->overflown ? find_passage(s, last, limit) : next;
}
