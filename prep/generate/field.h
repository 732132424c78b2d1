/* field.h - analytic test volumes: a list of them, and their samples, block by block.
 *
 * The same field, sizes, type and seed give the same bytes on any CPU, with any number of threads
 * and any blocks.
 *
 * Node i of an axis of n nodes lies at (2 i - (n - 1)) / (m - 1), where m is the largest of the
 * three sizes. So the volume fills [-1, 1] along its longest axis and is centred on 0. A field
 * gives real values. f32 stores them as they are. u8 and u16 map [lo, hi] of the field linearly to
 * [0, 255] or [0, 65535], round to nearest and clamp.
 */
#ifndef PREP_GENERATE_FIELD_H
#define PREP_GENERATE_FIELD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/pool.h"
#include "formats/base/sample.h"
#include "formats/base/status.h"

typedef struct field_info {
    const char *name;
    const char *about; /* what it is and which isovalues are interesting, for --help */
    double lo, hi;     /* values that become the ends of u8 and u16 */
    bool seeded;       /* the field depends on the seed, */
    bool timed;        /* and on time */
} field_info;

/* field_at() - the field of an index, from 0 on; NULL behind the last. field_find() - the field of
 * this name, or NULL. */
const field_info *field_at(size_t index);
const field_info *field_find(const char *name);

typedef struct field field;

/* Which field. */
typedef struct field_choice {
    const field_info *info;
    uint64_t seed; /* used by seeded fields only; */
    double time;   /* 0 .. 1: by timed ones */
} field_choice;

/* field_create() - a field on a grid of dims nodes. samples: most samples of one field_fill(). The
 * attractor has a counter for each, and integrates its orbits again for every fill. */
CHECKED status field_create(mem *m, const field_choice *which, const uint32_t dims[3],
                            size_t samples, field **out);
void field_destroy(field *f); /* NULL is fine */

/* A part of the volume with consecutive samples: whole slices, or some rows of one slice. */
typedef struct field_block {
    uint32_t slice, slices; /* the first, and how many */
    uint32_t row, rows;     /* all rows if slices > 1 */
} field_block;

/* field_fill() - compute the samples of a block, of type u8, u16 or f32, in native byte order. */
CHECKED status field_fill(field *f, pool *p, const field_block *block, sample_type type,
                          void *samples);

/* field_quantise() - convert count real values to samples of a type. lo and hi become the ends of
 * u8 and u16. */
void field_quantise(double lo, double hi, sample_type type, const double *values, size_t count,
                    void *samples);

#endif
