/* mesh_passage.h - finds the treelets of a mesh on a ray's way, by where the ray enters their
 * boxes.
 *
 * Treelets overlap, so no order of them is front to back. A ray takes them in the order of (the t
 * at which it enters their box, index): any hit still to come is at that t or behind it. So a
 * suspended ray needs only this pair to go on.
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

/* Enough for some hundreds of overlapping boxes with the ray in all of them. Beyond that, each next
 * treelet is searched from the root. */
enum { MESH_PASSAGES_AHEAD = 256 };

typedef struct mesh_passages {
    const treelet_tree *tree;
    mesh_slabs slabs;
    double behind; /* boxes that the ray leaves before this t are of no interest */
    ray_counters *counters;
    size_t count;   /* nodes ahead, in a heap with the first at its top; */
    bool overflown; /* or only some of them: then each search starts at the root */
    mesh_passage_node heap[MESH_PASSAGES_AHEAD];
} mesh_passages;

/* mesh_passages_begin() - starts the way of a ray that looks for hits behind `after`. */
void mesh_passages_begin(mesh_passages *s, const treelet_tree *tree, const ray *r, const hit *after,
                         ray_counters *counters);

/* mesh_passages_next() - returns the first active treelet after `last` that the ray enters at
 * `limit` or before. From one call to the next, `last` rises and `limit` does not. */
mesh_passage mesh_passages_next(mesh_passages *s, mesh_passage last, double limit);

#endif
