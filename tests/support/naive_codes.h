/* naive_codes.h - the codes of min/max trees from samples, from section 4 of formats/FORMAT.md
 * alone.
 */
#ifndef TESTS_SUPPORT_NAIVE_CODES_H
#define TESTS_SUPPORT_NAIVE_CODES_H

#include "tests/support/naive_leaf.h"

/* The samples of a treelet. */
typedef struct naive_window {
    const float *samples; /* halo included, x fastest */
    long size[3];
} naive_window;

/* naive_finite_range() - smallest and largest finite sample of a box of nodes, [from, to] on each
 * axis; lo > hi if there is none. Returns whether all are finite. */
bool naive_finite_range(const naive_window *w, const long from[3], const long to[3], float *lo,
                        float *hi);

/* naive_codes_size() - bytes of a treelet's codes.
 * naive_codes_make() - all codes, as a payload begins with them. */
uint64_t naive_codes_size(const naive_leaf *leaf);
void naive_codes_make(const naive_leaf *leaf, const naive_treelet *t, const naive_window *w,
                      unsigned char *codes);

#endif
