/* leaf_fuzz.h - everything that is done with a treelet file, done with one that may be anything.
 */
#ifndef TESTS_SUPPORT_LEAF_FUZZ_H
#define TESTS_SUPPORT_LEAF_FUZZ_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/status.h"

/* What became of it: ST_AGAIN where it did not come to that. */
typedef struct leaf_fuzz_result {
    status open, verify, trace;
} leaf_fuzz_result;

/* leaf_fuzz_try() - a file's bytes: open, count what is active, print histograms, verify, draw a
 * few pixels of two isosurfaces of each field and step, probe a point. in_place: raw treelets of a
 * grid are used where the bytes are, if these are aligned to 64. NULL, or what should not be:
 * memory left, an error without a description, an error of a kind that no file gives, a sound file
 * that cannot be drawn. */
const char *leaf_fuzz_try(const char *bytes, size_t size, bool in_place, leaf_fuzz_result *r);

/* leaf_fuzz_alloc() - aligned to 64, and with nothing behind it that a sanitizer would not see;
 * free() it. */
char *leaf_fuzz_alloc(size_t size);

/* leaf_fuzz_seal() - bytes of a file, of any length: its checksums made right, where it is enough
 * of one. */
void leaf_fuzz_seal(char *bytes, size_t size);

/* leaf_fuzz_segment() - where the header of a segment lies, the i-th from the last one back, if the
 * headers lead there; else, and of the first one, 0. */
uint64_t leaf_fuzz_segment(const char *bytes, size_t size, int i);

#endif
