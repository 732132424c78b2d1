/* generate.h - writes an analytic field as NRRD, as a stream: memory does not grow with the
 * volume. */
#ifndef PREP_GENERATE_GENERATE_H
#define PREP_GENERATE_GENERATE_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/progress.h"
#include "formats/base/status.h"
#include "formats/grid/grid.h"
#include "prep/generate/field.h"

typedef struct generate_options {
    const field_info *info;
    uint64_t seed;
    int threads;
    const char *output; /* a path, or "-" */
    bool force;
    uint32_t steps; /* above 0: a time series of this many files */
} generate_options;

/* generate_volume() - g gives sizes, type (u8, u16 or f32) and placement. Works in blocks of 32 MiB
 * of samples, or a quarter of m's limit if that is less. The bytes are the same for any number of
 * threads and any limit. With steps: to as many files, of the field at times from 0 to 1
 * (generate_steps.h); without, at time 0. */
CHECKED status generate_volume(mem *m, const grid *g, const generate_options *options,
                               const progress *p);

#endif
