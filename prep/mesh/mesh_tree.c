/* Dynamic programming decides which nodes of the binary tree become nodes of 8 children. It goes
 * from the leaves up, as for wide trees on GPUs (Ylitie et al. 2017), with the number of nodes as
 * cost:
 *
 *   open(n, j)  = least over k of below(left, k) + below(right, j - k)
 *   below(n, 1) = 1 + open(n, 8), or 0 for a leaf
 *   below(n, j) = the lesser of below(n, 1) and open(n, j)
 *
 * below(n, j) is the least number of nodes below n if its parent has room for j children from it.
 */
#include "prep/mesh/mesh_tree.h"

#include <assert.h>
#include <stdbool.h>

#include "formats/leaf/leaf.h"

/* Below this many levels, ranges are split in the middle. With up to 2^14 tets, no path is then
 * longer than MESH_DEPTH_MAX, whatever the keys. */
enum { WAYS = MESH_CHILDREN, LEVELS_BY_KEY = 48 };
_Static_assert(1 << (MESH_DEPTH_MAX - LEVELS_BY_KEY) >= LEAF_TREELET_TETS_MAX, "paths are short");

/* A node of the binary tree. Stored before its left child, which is stored before the right one. */
struct mesh_tree_pair {
    uint32_t first, end;  /* tets */
    uint32_t right;       /* number of the right child; 0: a leaf */
    uint32_t leaf;        /* leaves before it */
    uint16_t below[WAYS]; /* [j - 1]: below(n, j) */
    uint8_t share[WAYS];  /* [j - 1]: the left one's part of j children, in open(n, j) */
    uint8_t opens;        /* bit j - 1: open(n, j) <= below(n, 1) */
};

/* Proof: the minimum is at most what comes of opening the largest child until there are 8 or all
 * are leaves. Then a node with fewer has only leaves below it, with more than leaf_tets tets
 * together. A node with 8 takes 7 from the number left to join. */
uint32_t mesh_tree_nodes_max(uint32_t tets, uint32_t leaf_tets) {
    return tets / (leaf_tets + 1) + tets / 7 + 2;
}

uint64_t mesh_tree_memory(uint32_t tets_max, uint32_t leaf_tets) {
    return (uint64_t)mesh_tree_nodes_max(tets_max, leaf_tets) *
               (sizeof(mesh_tree_node) + sizeof(uint16_t)) +
           2 * (uint64_t)tets_max * sizeof(mesh_tree_pair) + 512;
}

status mesh_tree_init(mesh_tree *t, mem *m, uint32_t tets_max, uint32_t leaf_tets) {
    *t = (mesh_tree){.m = m, .leaf_tets = leaf_tets};
    const size_t nodes = mesh_tree_nodes_max(tets_max, leaf_tets);
    t->node = mem_alloc(m, nodes * sizeof *t->node);
    t->pair_of = mem_alloc(m, nodes * sizeof *t->pair_of);
    t->pairs = mem_alloc(m, 2 * (size_t)tets_max * sizeof *t->pairs);
    return t->node && t->pairs && t->pair_of ? ST_OK : ST_NOMEM;
}

void mesh_tree_release(mesh_tree *t) {
    if (!t->m)
        return;
    mem_free(t->m, t->node);
    mem_free(t->m, t->pairs);
    mem_free(t->m, t->pair_of);
    *t = (mesh_tree){0};
}

/* ---- the binary tree ---- */

/* The index where [first, end) is split, with at least one tet on either side. */
static uint32_t split(const mesh_record *records, uint32_t first, uint32_t end, int level) {
    uint64_t differ = records[first].key ^ records[end - 1].key;
    if (!differ || level >= LEVELS_BY_KEY)
        return first + (end - first) / 2;
    uint64_t bit = UINT64_C(1) << (63 - __builtin_clzll(differ));
    uint32_t low = first + 1, high = end - 1;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (records[middle].key & bit)
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

/* Make pairs from number `at` on. Returns the number behind the last one. */
static uint32_t split_pairs(mesh_tree *t, const mesh_record *records, uint32_t at, uint32_t first,
                            uint32_t end, int level) {
    mesh_tree_pair *p = &t->pairs[at];
    *p = (mesh_tree_pair){.first = first, .end = end, .leaf = t->leaves};
    if (end - first <= t->leaf_tets) {
        t->leaves++;
        return at + 1;
    }
    const uint32_t middle = split(records, first, end, level);
    p->right = split_pairs(t, records, at + 1, first, middle, level + 1);
    return split_pairs(t, records, p->right, middle, end, level + 1);
}

/* ---- nodes to keep ---- */

/* Returns open(n, j), as the head of this file defines it, for the node n with these children. Set
 * *share to the best k: the children that the left one gets. Of equal ones, take the k nearest to
 * j / 2. */
static uint32_t open_pair(const mesh_tree_pair *left, const mesh_tree_pair *right, uint32_t j,
                          uint8_t *share) {
    uint32_t least = UINT32_MAX;
    for (uint32_t i = 0; i < j - 1; i++) {
        const uint32_t k = j / 2 + (i % 2 ? i / 2 + 1 : -(i / 2));
        if (k < 1 || k >= j)
            continue;
        const uint32_t cost = (uint32_t)left->below[k - 1] + right->below[j - k - 1];
        if (cost < least) {
            least = cost;
            *share = (uint8_t)k;
        }
    }
    return least;
}

static void weigh(mesh_tree_pair *pairs, uint32_t count) {
    for (uint32_t i = count; i-- > 0;) {
        mesh_tree_pair *p = &pairs[i];
        if (!p->right)
            continue;
        uint32_t open[WAYS];
        for (uint32_t j = 2; j <= WAYS; j++)
            open[j - 1] = open_pair(p + 1, &pairs[p->right], j, &p->share[j - 1]);
        const uint32_t closed = 1 + open[WAYS - 1];
        p->below[0] = (uint16_t)closed;
        for (uint32_t j = 1; j < WAYS; j++) {
            p->below[j] = (uint16_t)(open[j] < closed ? open[j] : closed);
            p->opens |= (uint8_t)((open[j] <= closed) << j);
        }
    }
}

/* ---- nodes with up to 8 children ---- */

static void add_child(mesh_tree *t, mesh_tree_node *n, uint32_t pair) {
    const mesh_tree_pair *p = &t->pairs[pair];
    const uint32_t c = n->children++;
    n->first[c] = p->first;
    n->first[c + 1] = p->end;
    n->child[c] = (uint16_t)(p->right ? t->nodes : MESH_LEAF | p->leaf);
    if (p->right)
        t->pair_of[t->nodes++] = (uint16_t)pair;
}

/* Add a pair to node n: as one child, or opened into its parts, as up to `room` children. Open it
 * if this takes no more nodes, since the boxes are smaller then. */
static void add_children(mesh_tree *t, mesh_tree_node *n, uint32_t pair, uint32_t room) {
    const mesh_tree_pair *p = &t->pairs[pair];
    if (!(p->opens >> (room - 1) & 1)) {
        add_child(t, n, pair);
        return;
    }
    const uint32_t share = p->share[room - 1];
    add_children(t, n, pair + 1, share);
    add_children(t, n, p->right, room - share);
}

static void make_node(mesh_tree *t, uint32_t index) {
    mesh_tree_node *n = &t->node[index];
    n->children = 0;
    add_children(t, n, t->pair_of[index], WAYS);
    for (uint32_t c = n->children; c < WAYS; c++)
        n->child[c] = MESH_NO_CHILD;
}

void mesh_tree_build(mesh_tree *t, const mesh_record *records, size_t count) {
    assert(count > 0);
    t->leaves = 0;
    const uint32_t pairs = split_pairs(t, records, 0, 0, (uint32_t)count, 0);
    weigh(t->pairs, pairs);
    t->pair_of[0] = 0;
    t->nodes = 1;
    for (uint32_t i = 0; i < t->nodes; i++)
        make_node(t, i);
}
