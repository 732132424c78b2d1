/* naive_outside.h - samples of level 0 that lie in another file, from section 11 of
 * formats/FORMAT.md alone. */
#ifndef TESTS_SUPPORT_NAIVE_OUTSIDE_H
#define TESTS_SUPPORT_NAIVE_OUTSIDE_H

#include "tests/support/naive_leaf.h"

/* naive_outside_read() - all samples of level 0, as they are in raw payloads, x fastest; the caller
 * frees them. path: of the treelet file. section: OUTSIDE. table: CHUNKS, or NULL. slices: SLICES,
 * or NULL. Returns NULL, or what is wrong. */
const char *naive_outside_read(const naive_leaf *leaf, const char *path,
                               const unsigned char *section, const unsigned char *table,
                               const unsigned char *slices, unsigned char **samples);

/* naive_outside_hold() - put the samples of a treelet that lie there into `held`, and check them.
 * Returns NULL, or what is wrong. */
const char *naive_outside_hold(const naive_leaf *leaf, const naive_treelet *t, unsigned char *held);

#endif
