/* naive_coarse.h - the grid inside a mesh's treelet file, as the second reader sees it. */
#ifndef TESTS_SUPPORT_NAIVE_COARSE_H
#define TESTS_SUPPORT_NAIVE_COARSE_H

#include <stdbool.h>
#include <stddef.h>

/* naive_coarse_check() - whether these bytes are a sound treelet file of a grid (naive_leaf.h). */
bool naive_coarse_check(const void *bytes, size_t size);

#endif
