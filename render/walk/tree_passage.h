/* tree_passage.h - the nodes of a tree of boxes (treelet_tree.h) on a ray's way, by where the ray
 * enters them: treelets of a volume, or cells of a treelet.
 *
 * Boxes overlap, so no order of them is front to back. A ray takes them in the order of (the t
 * at which it enters their box, index): any hit still to come is at that t or behind it. So a
 * suspended ray needs only this pair to go on.
 */
#ifndef RENDER_WALK_TREE_PASSAGE_H
#define RENDER_WALK_TREE_PASSAGE_H

#include "render/ray/tracer.h"
#include "render/walk/box_interval.h"

/* A treelet, or cell, on the way. */
typedef struct tree_passage {
    double t_in;
    uint32_t t; /* LEAF_NO_TREELET: none */
} tree_passage;

/* A node of the tree that the ray enters at t_in. */
typedef struct tree_passage_node {
    double t_in;
    uint32_t level, i;
} tree_passage_node;

/* tree_passage_enters() - whether the ray enters a node, active, that it does not leave before
 * `behind`: sets its t_in. */
static inline bool tree_passage_enters(const treelet_tree *tree, const box_line *line,
                                       double behind, tree_passage_node *node) {
    const float *bounds = tree->bounds[node->level][node->i];
    double lo[3], hi[3];
    box_interval in;
    if (!tree->active[node->level][node->i])
        return false;
    for (int a = 0; a < 3; a++) {
        lo[a] = (double)bounds[a];
        hi[a] = (double)bounds[a + 3];
    }
    if (!box_interval_in(line, lo, hi, &in) || in.t_out < behind)
        return false;
    node->t_in = in.t_in;
    return true;
}

/* Enough for some hundreds of overlapping boxes with the ray in all of them. Beyond that, each next
 * treelet is searched from the root. */
enum { TREE_PASSAGES_AHEAD = 256 };

typedef struct tree_passages {
    const treelet_tree *tree;
    box_line slabs;
    double behind; /* boxes that the ray leaves before this t are of no interest */
    ray_counters *counters;
    size_t count;   /* nodes ahead, in a heap with the first at its top; */
    bool overflown; /* or only some of them: then each search starts at the root */
    tree_passage_node heap[TREE_PASSAGES_AHEAD];
} tree_passages;

/* tree_passages_begin() - starts the way of a ray that looks for hits behind `after`. */
void tree_passages_begin(tree_passages *s, const treelet_tree *tree, const ray *r, const hit *after,
                         ray_counters *counters);

/* tree_passages_next() - returns the first active box after `last` that the ray enters at
 * `limit` or before. From one call to the next, `last` rises and `limit` does not. */
tree_passage tree_passages_next(tree_passages *s, tree_passage last, double limit);

#endif
