/* read_ahead.h - a volume's slices as a treelet file will hold them, read by a thread of its own.
 *
 * Two batches of slices: one is the caller's while the other is filled. Samples are converted to
 * their stored type on the way, and counted where they are no numbers.
 */
#ifndef PREP_GRID_READ_AHEAD_H
#define PREP_GRID_READ_AHEAD_H

#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/grid/volume.h"

typedef struct read_ahead read_ahead;

/* What has been seen once all slices were handed out. */
typedef struct read_ahead_facts {
    uint64_t non_finite;     /* samples that are NaN or inf as stored */
    double rounding_error;   /* largest |stored - input| */
    uint64_t trailing_bytes; /* behind the last slice */
    absent_parts absent;
} read_ahead_facts;

/* read_ahead_create() - start reading v, which must not be touched until read_ahead_destroy().
 * batch: slices at once, >= 1. */
CHECKED status read_ahead_create(mem *m, volume *v, uint32_t batch, read_ahead **out);

/* read_ahead_destroy() - waits for the slice that is being read. NULL is fine. */
void read_ahead_destroy(read_ahead *r);

/* read_ahead_memory() - bytes that read_ahead_create() takes. */
uint64_t read_ahead_memory(const grid *g, uint32_t batch);

/* Slices one after the other in memory. busy: their maps (slice_tiles.h) likewise; NULL: not known.
 */
typedef struct read_slices {
    const char *samples;
    const uint8_t *busy;
    uint32_t count;
} read_slices;

/* read_ahead_next() - the next slices, valid until the next call; count becomes 0 behind the last
 * one. Waits for them. */
CHECKED status read_ahead_next(read_ahead *r, read_slices *out);

/* read_ahead_quiet() - the value of what is not busy, a finite one; NULL where that is not known.
 */
const void *read_ahead_quiet(const read_ahead *r);

/* read_ahead_end() - what was seen; once read_ahead_next() has given 0 slices. */
read_ahead_facts read_ahead_end(const read_ahead *r);

#endif
