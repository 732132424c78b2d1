/* naive_histogram.h - histograms of treelet files counted again, from formats/FORMAT.md 7 alone. */
#ifndef TESTS_SUPPORT_NAIVE_HISTOGRAM_H
#define TESTS_SUPPORT_NAIVE_HISTOGRAM_H

#include "tests/support/naive_leaf.h"
#include "tests/support/naive_mesh.h"

/* naive_histogram_grid(), naive_histogram_mesh() - NULL, or what is wrong with the section; "none"
 * where there is none. */
const char *naive_histogram_grid(const naive_leaf *leaf);
const char *naive_histogram_mesh(const naive_mesh *mesh);

#endif
