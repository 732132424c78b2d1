#include "stream/treelet_tree.h"

#include <string.h>

static void merge(treelet_bounds to, const treelet_bounds from) {
    for (int a = 0; a < 3; a++) {
        to[a] = from[a] < to[a] ? from[a] : to[a];
        to[a + 3] = from[a + 3] > to[a + 3] ? from[a + 3] : to[a + 3];
    }
}

static void merge_level(treelet_tree *tree, uint32_t level) {
    for (uint32_t i = 0; i < tree->count[level]; i++) {
        uint32_t count, first = treelet_tree_children(tree, level, i, &count);
        memcpy(tree->bounds[level][i], tree->bounds[level - 1][first], sizeof(treelet_bounds));
        for (uint32_t c = 1; c < count; c++)
            merge(tree->bounds[level][i], tree->bounds[level - 1][first + c]);
    }
}

static size_t node_count(uint32_t count) {
    size_t nodes = count;
    while (count > 1) {
        count = (count + TREELET_TREE_ARITY - 1) / TREELET_TREE_ARITY;
        nodes += count;
    }
    return nodes;
}

status treelet_tree_init(treelet_tree *tree, mem *m, const treelet_bounds bounds[],
                         uint32_t count) {
    const size_t nodes = node_count(count);
    *tree = (treelet_tree){.m = m};
    do {
        tree->count[tree->levels++] = count;
        count = (count + TREELET_TREE_ARITY - 1) / TREELET_TREE_ARITY;
    } while (tree->count[tree->levels - 1] > 1);
    tree->block = mem_array(m, nodes, sizeof(treelet_bounds) + 1);
    if (!tree->block)
        return ST_NOMEM;
    treelet_bounds *next = tree->block;
    uint8_t *flags = (uint8_t *)(next + nodes);
    for (uint32_t level = 0; level < tree->levels; level++) {
        tree->bounds[level] = next;
        tree->active[level] = flags;
        next += tree->count[level];
        flags += tree->count[level];
    }
    if (bounds)
        treelet_tree_move(tree, bounds);
    return ST_OK;
}

static void widen(double widest[3], const treelet_bounds bounds) {
    for (int a = 0; a < 3; a++) {
        const double width = (double)bounds[a + 3] - (double)bounds[a];
        widest[a] = width > widest[a] ? width : widest[a];
    }
}

void treelet_tree_move(treelet_tree *tree, const treelet_bounds bounds[]) {
    memmove(tree->bounds[0], bounds, tree->count[0] * sizeof(treelet_bounds));
    memset(tree->widest, 0, sizeof tree->widest);
    for (uint32_t t = 0; t < tree->count[0]; t++)
        widen(tree->widest, bounds[t]);
    for (uint32_t level = 1; level < tree->levels; level++)
        merge_level(tree, level);
}

size_t treelet_tree_bytes(uint32_t count) {
    return node_count(count) * (sizeof(treelet_bounds) + 1);
}

void treelet_tree_release(treelet_tree *tree) {
    if (tree->m)
        mem_free(tree->m, tree->block);
    tree->block = NULL;
}

void treelet_tree_select(treelet_tree *tree, const uint8_t own[]) {
    memmove(tree->active[0], own, tree->count[0]);
    for (uint32_t level = 1; level < tree->levels; level++) {
        for (uint32_t i = 0; i < tree->count[level]; i++) {
            uint32_t count, first = treelet_tree_children(tree, level, i, &count);
            uint8_t any = 0;
            for (uint32_t c = 0; c < count; c++)
                any |= tree->active[level - 1][first + c];
            tree->active[level][i] = any;
        }
    }
}
