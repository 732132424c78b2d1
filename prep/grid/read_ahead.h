/* read_ahead.h - reads a volume's slices in a thread of its own, as a treelet file will hold them.
 *
 * Slices go to a ring, where the caller uses some of them while others are read. Samples are
 * converted to their stored type on the way. Samples that are no numbers are counted.
 */
#ifndef PREP_GRID_READ_AHEAD_H
#define PREP_GRID_READ_AHEAD_H

#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/grid/volume.h"
#include "prep/grid/slice_ring.h"

typedef struct read_ahead read_ahead;

/* Facts about samples. */
typedef struct read_ahead_facts {
    uint64_t non_finite;     /* samples that are NaN or inf as stored */
    double rounding_error;   /* largest |stored - input| */
    uint64_t trailing_bytes; /* in the input, behind the last slice */
    uint64_t checksum;       /* of all slices as stored, each following from those before */
} read_ahead_facts;

/* read_ahead_create() - read v, which must not be used until read_ahead_destroy(), from the first
 * read_ahead_next() on. ring: where slices are read to, but for those that are still needed; it
 * outlives the reader. past: NULL, or what an earlier run knew after `done` slices: they are not
 * handed out again. They are skipped where v can do that, else read, and their checksum compared;
 * ST_CORRUPT where it is another. */
CHECKED status read_ahead_create(mem *m, volume *v, const slice_ring *ring,
                                 const read_ahead_facts *past, uint32_t done, read_ahead **out);

/* read_ahead_destroy() - stop, and wait for the slice that is being read. NULL is fine. */
void read_ahead_destroy(read_ahead *r);

/* read_ahead_memory() - bytes that read_ahead_create() takes. */
uint64_t read_ahead_memory(const grid *g, uint32_t slots);

/* Slices, consecutive in memory. busy: their maps (slice_tiles.h), also consecutive. */
typedef struct read_slices {
    const char *samples;
    const uint8_t *busy;
    uint32_t count;
} read_slices;

/* read_ahead_next() - wait for the next slices, `most` if the ring has them in one piece. needed:
 * the first slice that must stay in the ring; those handed out before count as needed from there
 * on. The ring must have more slots than that are. count is 0 behind the last. */
CHECKED status read_ahead_next(read_ahead *r, uint32_t needed, uint32_t most, read_slices *out);

/* read_ahead_quiet() - the value of tiles that are not busy, a finite sample: the input's own, if
 * it has maps; else 0. */
const void *read_ahead_quiet(const read_ahead *r);

/* read_ahead_seen() - the facts of all slices up to the last that read_ahead_next() gave. After it
 * has given 0 slices, they are those of the whole input. */
read_ahead_facts read_ahead_seen(const read_ahead *r);

#endif
