/* naive_order.h - the order of families in a treelet file, found by sorting them (FORMAT.md 4). */
#ifndef TESTS_SUPPORT_NAIVE_ORDER_H
#define TESTS_SUPPORT_NAIVE_ORDER_H

#include "tests/support/naive_leaf.h"

/* A family, with all that its place in the file depends on. */
typedef struct naive_family_place {
    long slices; /* of level 0, when its slab is complete */
    long level;  /* of its treelets */
    long z, y, x;
    long parent, first; /* parent -1: the root alone */
} naive_family_place;

/* naive_order_families() - the families of the set that begins with treelet `root`. out: room for
 * as many as there are treelets in a set. Returns how many there are. */
long naive_order_families(const naive_leaf *leaf, long root, naive_family_place *out);

#endif
