/* bounded_kdtree.h - M08's bounded kd-tree over triangles that move (5.3; Woop 2006), to compare
 * with boxes: a binary tree, a leaf for each triangle. A node has an axis, and both children's
 * intervals along that axis. So it is a third of a tree of boxes, and rays go in order.
 *
 * Built from the top by the surface area heuristic. An update makes intervals anew from the bottom
 * (M08 5.3.1); for that the boxes of all nodes are there, which rays do not look at. Nodes lie
 * before those below them, so that a subtree is a run of them: threads take subtrees.
 *
 * Deviation from M08: intervals of rays are widened as everywhere here (walk/box_interval.h), so
 * that nothing is missed. What rays meet is found by the kernel of render/triangle/, so that hits
 * have the same bits.
 */
#ifndef RENDER_EXPERIMENTS_BOUNDED_KDTREE_H
#define RENDER_EXPERIMENTS_BOUNDED_KDTREE_H

#include "formats/base/pool.h"
#include "render/ray/ray.h"

typedef struct bounded_node {
    float lo[2], hi[2]; /* of the children, along the axis; child 0 is the lower one when built */
    uint32_t child[2];  /* a node; with BOUNDED_LEAF a triangle */
    uint32_t axis;
} bounded_node;

#define BOUNDED_LEAF (UINT32_C(1) << 31)

/* Nodes [first, end) are a subtree. */
typedef struct bounded_part {
    uint32_t first, end;
} bounded_part;

typedef struct bounded_kdtree {
    mem *m;
    uint32_t triangles, nodes;   /* nodes: one less; none of a single triangle */
    const uint32_t (*rows)[3];   /* the caller's */
    const float (*positions)[3]; /* of the vertices, those of the last update */
    bounded_node *node;
    float (*box)[6]; /* of each node: lo x y z, hi x y z */
    bounded_part *parts;
    uint32_t *tops; /* nodes above the parts, each before those below it */
    size_t part_count, parts_room, top_count, tops_room;
} bounded_kdtree;

/* What rays cost, summed. */
typedef struct bounded_counts {
    uint64_t nodes, triangles;
} bounded_counts;

/* bounded_kdtree_build() - over 1 to 2^30 triangles. rows and positions stay the caller's.
 * bounded_kdtree_refit() - other positions of the same vertices. */
CHECKED status bounded_kdtree_build(mem *m, const uint32_t (*rows)[3], uint32_t triangles,
                                    const float (*positions)[3], bounded_kdtree *out);
void bounded_kdtree_release(bounded_kdtree *t); /* zeros are fine */
CHECKED status bounded_kdtree_refit(bounded_kdtree *t, const float (*positions)[3], pool *threads);

/* bounded_kdtree_first() - the first hit of a ray, as triangle_less() orders them: its cell is the
 * triangle's number. False: none. */
bool bounded_kdtree_first(const bounded_kdtree *t, const ray *r, hit *found,
                          bounded_counts *counts);

/* bounded_kdtree_cost() - how many children's boxes a random line through the whole box meets: the
 * sum of their surfaces, in surfaces of the whole. bounded_kdtree_bytes() - of what rays look at.
 */
double bounded_kdtree_cost(const bounded_kdtree *t);
size_t bounded_kdtree_bytes(const bounded_kdtree *t);

#endif
