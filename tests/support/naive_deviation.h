/* naive_deviation.h - deviations of treelet files worked out again, from formats/FORMAT.md 8 alone,
 * in long double. */
#ifndef TESTS_SUPPORT_NAIVE_DEVIATION_H
#define TESTS_SUPPORT_NAIVE_DEVIATION_H

#include "tests/support/naive_leaf.h"

/* naive_deviation_check() - those of a set, whose samples the leaf has: each brick of each coarse
 * level against all nodes of level 0 in it, and against what follows from the level below; then
 * `points` places at random. NULL: all is right, else what is wrong. *known: bricks with a number.
 */
const char *naive_deviation_check(const naive_leaf *leaf, long set, long points, uint64_t seed,
                                  long *known);

#endif
