/* mesh_tree.h - the topology of the tree over a treelet's tets, without its layout in memory.
 *
 * First a binary tree is made: ranges of tets in Morton order, split where the first bit in which
 * their keys differ changes, or in the middle if all keys are the same, down to leaves. Then it
 * becomes a tree with up to 8 children per node, with as few nodes as possible.
 */
#ifndef PREP_MESH_MESH_TREE_H
#define PREP_MESH_MESH_TREE_H

#include <stddef.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/mesh/mesh_leaf.h"
#include "prep/mesh/mesh_sort.h"

typedef struct mesh_tree_node {
    uint32_t first[MESH_CHILDREN + 1]; /* child c has the tets [first[c], first[c + 1]) */
    uint16_t child[MESH_CHILDREN];     /* as in mesh_node */
    uint32_t children;
} mesh_tree_node;

typedef struct mesh_tree_pair mesh_tree_pair;

typedef struct mesh_tree {
    mem *m;
    uint32_t leaf_tets;
    uint32_t nodes, leaves;
    mesh_tree_node *node;
    mesh_tree_pair *pairs; /* scratch */
    uint16_t *pair_of;     /* scratch: the pair of each node */
} mesh_tree;

/* mesh_tree_nodes_max() - upper bound for the nodes of a tree over so many tets. */
uint32_t mesh_tree_nodes_max(uint32_t tets, uint32_t leaf_tets);

/* mesh_tree_init() - for up to tets_max tets. mesh_tree_memory() - bytes it takes. */
CHECKED status mesh_tree_init(mesh_tree *t, mem *m, uint32_t tets_max, uint32_t leaf_tets);
void mesh_tree_release(mesh_tree *t); /* a zeroed struct is fine */
uint64_t mesh_tree_memory(uint32_t tets_max, uint32_t leaf_tets);

/* mesh_tree_build() - records: sorted by key, at least one. */
void mesh_tree_build(mesh_tree *t, const mesh_record *records, size_t count);

#endif
