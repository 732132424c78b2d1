#include "tests/support/naive_coarse.h"

#include "tests/support/naive_leaf.h"
#include "tests/support/scratch.h"

bool naive_coarse_check(const void *bytes, size_t size) {
    naive_leaf leaf;
    const bool good = naive_leaf_load(&leaf, scratch_write("coarse.part", bytes, size));
    naive_leaf_release(&leaf);
    return good;
}
