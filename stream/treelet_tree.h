/* treelet_tree.h - the implicit tree over boxes that may overlap: the treelets of a mesh, or the
 * cells of a treelet (cell_resident.h).
 *
 * The boxes are in the order of a space-filling curve. So eight boxes in a row are neighbours, and
 * eight groups of eight are, too. They form a complete 8-ary tree whose shape follows from the
 * number of boxes alone. Level 0 is the treelets; the children of node i of level k + 1 are 8i ..
 * 8i + 7 of level k, as far as they exist. Grids need no such tree: their directory is an octree
 * (leaf_layout.h).
 */
#ifndef STREAM_TREELET_TREE_H
#define STREAM_TREELET_TREE_H

#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"

enum {
    TREELET_TREE_LEVELS_MAX = 12,
    TREELET_TREE_ARITY_LOG2 = 3,
    TREELET_TREE_ARITY = 1 << TREELET_TREE_ARITY_LOG2
};

/* lo x y z, hi x y z; world space, exact. */
typedef float treelet_bounds[6];

typedef struct treelet_tree {
    uint32_t levels; /* the last level has one node */
    uint32_t count[TREELET_TREE_LEVELS_MAX];
    treelet_bounds *bounds[TREELET_TREE_LEVELS_MAX];
    uint8_t *active[TREELET_TREE_LEVELS_MAX]; /* per node: 1: a treelet below is active */
    double widest[3];                         /* the greatest width of a treelet along each axis */
    void *block;
    mem *m;
} treelet_tree;

/* treelet_tree_init() - make a tree over count >= 1 treelets with these bounds (copied); NULL:
 * treelet_tree_move() comes first. None is active. */
CHECKED status treelet_tree_init(treelet_tree *tree, mem *m, const treelet_bounds bounds[],
                                 uint32_t count);
void treelet_tree_release(treelet_tree *tree);

/* treelet_tree_bytes() - returns the memory of a tree over `count` treelets. */
size_t treelet_tree_bytes(uint32_t count);

/* treelet_tree_move() - set new bounds of the same treelets; may be bounds[0] itself. */
void treelet_tree_move(treelet_tree *tree, const treelet_bounds bounds[]);

/* treelet_tree_select() - set which nodes are active. own: per treelet, whether it is active; may
 * be active[0] itself. */
void treelet_tree_select(treelet_tree *tree, const uint8_t own[]);

/* treelet_tree_children() - returns the first child of node i of a level > 0; *count children. */
static inline uint32_t treelet_tree_children(const treelet_tree *tree, uint32_t level, uint32_t i,
                                             uint32_t *count) {
    const uint32_t first = TREELET_TREE_ARITY * i, left = tree->count[level - 1] - first;
    *count = left < TREELET_TREE_ARITY ? left : TREELET_TREE_ARITY;
    return first;
}

#endif
