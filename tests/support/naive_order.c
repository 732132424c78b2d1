#include "tests/support/naive_order.h"

#include <stdlib.h>

static int by_place(const void *a, const void *b) {
    const naive_family_place *f = a, *g = b;
    const long of_f[] = {f->slices, f->level, f->z, f->y, f->x};
    const long of_g[] = {g->slices, g->level, g->z, g->y, g->x};
    for (int i = 0; i < 5; i++)
        if (of_f[i] != of_g[i])
            return of_f[i] < of_g[i] ? -1 : 1;
    return 0;
}

/* The number of slices of level 0 up to the last that a slab's samples depend on. */
static long slices_for(const naive_leaf *leaf, int level, long z) {
    long last = (z + 1) * (2L << leaf->cells_log2) + leaf->halo;
    for (; level >= 0; level--) {
        if (last > leaf->level[level].nodes[2] - 1)
            last = leaf->level[level].nodes[2] - 1;
        if (level > 0)
            last = 2 * last + 2;
    }
    return last + 1;
}

/* The family of the treelets from `first` on. */
static naive_family_place family_of(const naive_leaf *leaf, long first) {
    const naive_treelet *t = &leaf->treelets[first];
    return (naive_family_place){.slices = slices_for(leaf, t->level, t->at[2] / 2),
                                .level = t->level,
                                .z = t->at[2] / 2,
                                .y = t->at[1] / 2,
                                .x = t->at[0] / 2,
                                .parent = t->parent,
                                .first = first};
}

long naive_order_families(const naive_leaf *leaf, long root, naive_family_place *out) {
    long count = 0;
    for (long i = root; i < root + leaf->treelet_count; i++)
        if (i == root || leaf->treelets[i].parent != leaf->treelets[i - 1].parent)
            out[count++] = family_of(leaf, i);
    qsort(out, (size_t)count, sizeof *out, by_place);
    return count;
}
