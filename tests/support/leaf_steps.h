/* leaf_steps.h - a series of grids in which everything happens that matters to what is stored once,
 * or as differences; and whether a file has it. */
#ifndef TESTS_SUPPORT_LEAF_STEPS_H
#define TESTS_SUPPORT_LEAF_STEPS_H

#include "formats/leaf/leaf_unpacker.h"
#include "tests/support/leaf_files.h"

enum { LEAF_STEPS = 24 };

typedef struct leaf_steps {
    leaf_case c;
    const char *paths[LEAF_STEPS]; /* raw samples, in the scratch folder */
    grid_series of;
} leaf_steps;

/* leaf_steps_make() - write the samples; leaf_steps_release() frees the names.
 * leaf_steps_bytes() - of the samples of a step.
 * leaf_steps_use() - convert with this codec. */
void leaf_steps_make(leaf_steps *s, uint32_t nx, uint32_t ny, uint32_t nz, sample_type type);
void leaf_steps_release(leaf_steps *s);
size_t leaf_steps_bytes(const leaf_case *c);
void leaf_steps_use(leaf_steps *s, leaf_codec codec);

/* leaf_steps_alone() - convert a step alone, to the scratch file of this name. Returns its path.
 * leaf_steps_open() - open a file, failing the test on an error.
 * leaf_steps_compare() - each treelet of a set is what it is in the file `alone`. */
const char *leaf_steps_alone(const leaf_steps *s, int step, const char *name);
leaf_file *leaf_steps_open(mem *m, const char *path, leaf_unpacker **u);
void leaf_steps_compare(leaf_file *f, leaf_unpacker *u, uint32_t set, const char *alone);

#endif
