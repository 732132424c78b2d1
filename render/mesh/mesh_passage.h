/* mesh_passage.h - the treelets of a mesh on a ray's way, by where the ray enters their boxes.
 *
 * Treelets overlap, so that no order of them is front to back. A ray takes them in the order of
 * (the t at which it enters their box, index): what it may still find begins no earlier than that
 * t. Where a ray goes on after it was suspended is then that pair, and nothing else.
 */
#ifndef RENDER_MESH_MESH_PASSAGE_H
#define RENDER_MESH_MESH_PASSAGE_H

#include "render/mesh/mesh_walk.h"

/* A treelet on the way. */
typedef struct mesh_passage {
    double t_in;
    uint32_t t; /* LEAF_NO_TREELET: none */
} mesh_passage;

/* A node of the tree over the treelets that the ray enters at t_in. */
typedef struct mesh_passage_node {
    double t_in;
    uint32_t level, i;
} mesh_passage_node;

/* Some hundreds of boxes that overlap, and the ray in all of them: more are looked up one by one.
 */
enum { MESH_PASSAGES_AHEAD = 256 };

typedef struct mesh_passages {
    const treelet_tree *tree;
    mesh_slabs slabs;
    double behind; /* what the ray leaves before that is of no interest */
    ray_counters *counters;
    size_t count;   /* what lies ahead: a heap, the first at its top; */
    bool overflown; /* or some of it: then all is looked up from the root on */
    mesh_passage_node heap[MESH_PASSAGES_AHEAD];
} mesh_passages;

/* mesh_passages_begin() - of a ray that looks for what lies behind `after`. */
void mesh_passages_begin(mesh_passages *s, const treelet_tree *tree, const ray *r, const hit *after,
                         ray_counters *counters);

/* mesh_passages_next() - the first active treelet behind `last` that the ray enters at `limit` or
 * before. From one call to the next, `last` rises and `limit` does not. */
mesh_passage mesh_passages_next(mesh_passages *s, mesh_passage last, double limit);

#endif
