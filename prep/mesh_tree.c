#include "prep/mesh_tree.h"

#include <assert.h>
#include <stdbool.h>
#include <string.h>

/* A node with less than 8 children has nothing but leaves below it, of more than leaf_tets tets
 * altogether; one with 8 takes 7 from the number of subtrees that are left to join. */
uint32_t mesh_tree_nodes_max(uint32_t tets, uint32_t leaf_tets) {
    return tets / (leaf_tets + 1) + tets / 7 + 2;
}

uint64_t mesh_tree_memory(uint32_t tets_max, uint32_t leaf_tets) {
    return mesh_tree_nodes_max(tets_max, leaf_tets) * sizeof(mesh_tree_node) +
           (tets_max + 1) * sizeof(uint16_t) + 256;
}

status mesh_tree_init(mesh_tree *t, mem *m, uint32_t tets_max, uint32_t leaf_tets) {
    *t = (mesh_tree){.m = m, .leaf_tets = leaf_tets};
    t->node = mem_alloc(m, mesh_tree_nodes_max(tets_max, leaf_tets) * sizeof *t->node);
    t->leaf_at = mem_alloc(m, (tets_max + 1) * sizeof *t->leaf_at);
    return t->node && t->leaf_at ? ST_OK : ST_NOMEM;
}

void mesh_tree_release(mesh_tree *t) {
    if (!t->m)
        return;
    mem_free(t->m, t->node);
    mem_free(t->m, t->leaf_at);
    *t = (mesh_tree){0};
}

/* Where [first, end) is split: at least one tet on either side. */
static uint32_t split(const mesh_record *records, uint32_t first, uint32_t end) {
    uint64_t differ = records[first].key ^ records[end - 1].key;
    if (!differ)
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

/* The child with the most tets, the first of them; MESH_CHILDREN when all are leaves. */
static uint32_t largest(const mesh_tree *t, const mesh_tree_node *n) {
    uint32_t most = t->leaf_tets, at = MESH_CHILDREN;
    for (uint32_t c = 0; c < n->children; c++)
        if (n->first[c + 1] - n->first[c] > most) {
            most = n->first[c + 1] - n->first[c];
            at = c;
        }
    return at;
}

static void open_child(mesh_tree_node *n, const mesh_record *records, uint32_t c) {
    uint32_t at = split(records, n->first[c], n->first[c + 1]);
    memmove(&n->first[c + 2], &n->first[c + 1], (n->children - c) * sizeof n->first[0]);
    n->first[c + 1] = at;
    n->children++;
}

static void make_node(mesh_tree *t, const mesh_record *records, uint32_t index) {
    mesh_tree_node *n = &t->node[index];
    for (uint32_t c; n->children < MESH_CHILDREN && (c = largest(t, n)) < MESH_CHILDREN;)
        open_child(n, records, c);
    for (uint32_t c = 0; c < MESH_CHILDREN; c++) {
        n->child[c] = MESH_NO_CHILD;
        if (c >= n->children)
            continue;
        t->leaf_at[n->first[c]] = n->first[c + 1] - n->first[c] <= t->leaf_tets;
        if (t->leaf_at[n->first[c]])
            continue;
        n->child[c] = (uint16_t)t->nodes;
        t->node[t->nodes++] =
            (mesh_tree_node){.first = {n->first[c], n->first[c + 1]}, .children = 1};
    }
}

/* Leaves are numbered in the order of their tets. */
static void number_leaves(mesh_tree *t, size_t count) {
    t->leaves = 0;
    for (size_t i = 0; i < count; i++) {
        bool begins = t->leaf_at[i];
        t->leaf_at[i] = (uint16_t)t->leaves;
        t->leaves += begins;
    }
    for (uint32_t i = 0; i < t->nodes; i++)
        for (uint32_t c = 0; c < t->node[i].children; c++)
            if (t->node[i].child[c] == MESH_NO_CHILD)
                t->node[i].child[c] = (uint16_t)(MESH_LEAF | t->leaf_at[t->node[i].first[c]]);
}

void mesh_tree_build(mesh_tree *t, const mesh_record *records, size_t count) {
    assert(count > 0);
    memset(t->leaf_at, 0, (count + 1) * sizeof *t->leaf_at);
    t->node[0] = (mesh_tree_node){.first = {0, (uint32_t)count}, .children = 1};
    t->nodes = 1;
    for (uint32_t i = 0; i < t->nodes; i++)
        make_node(t, records, i);
    number_leaves(t, count);
}
