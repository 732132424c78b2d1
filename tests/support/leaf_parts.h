/* leaf_parts.h - the parts of a sound treelet file that have checksums of their own, as ranges of
 * bytes; for tests that damage them. */
#ifndef TESTS_SUPPORT_LEAF_PARTS_H
#define TESTS_SUPPORT_LEAF_PARTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef enum leaf_range_kind {
    PART_HEADER,
    PART_TABLE,
    PART_SECTION,
    PART_PAYLOAD
} leaf_range_kind;

typedef struct leaf_range {
    leaf_range_kind kind;
    bool coarse; /* of a coarse grid inside a mesh */
    uint64_t at, bytes;
} leaf_range;

typedef struct leaf_parts {
    leaf_range *all; /* in the order of the file; free() it */
    size_t count;
} leaf_parts;

/* leaf_parts_of() - the parts of a file, of all its segments, with those of its coarse grids. */
leaf_parts leaf_parts_of(const char *path);

/* leaf_parts_find() - the first part of a kind behind `skip` others, of the file itself or of a
 * coarse grid; fails the test if there is none. */
leaf_range leaf_parts_find(const leaf_parts *p, leaf_range_kind kind, bool coarse, size_t skip);

/* leaf_parts_gap() - a byte between parts, of the file itself; it is 0. */
uint64_t leaf_parts_gap(const leaf_parts *p);

/* leaf_parts_damage() - change a bit of this byte of a file. */
void leaf_parts_damage(const char *path, uint64_t at);

#endif
