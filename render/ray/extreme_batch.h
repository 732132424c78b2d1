/* extreme_batch.h - the greatest, or the least, values on many rays through one volume
 * (extremes.h).
 *
 * Each ray gets the same value and place as when searched alone, to the bit. It asks for no treelet
 * that it would not ask for alone.
 */
#ifndef RENDER_RAY_EXTREME_BATCH_H
#define RENDER_RAY_EXTREME_BATCH_H

#include "render/ray/extremes.h"
#include "render/ray/ray_batch.h"

typedef struct extreme_batch {
    unsigned count; /* 1 to RAY_BATCH */
    ray rays[RAY_BATCH];
    extreme_state *state[RAY_BATCH]; /* as for extreme_next(); all look for the greatest, or all for
                                        the least */
    trace_result result[RAY_BATCH];  /* as of extreme_next() */
} extreme_batch;

/* extreme_batch_fn - a kind's kernel: answers all rays of *b. scratch: kind_batches.scratch bytes
 * of the caller's, 64-byte aligned, not initialised. */
typedef void (*extreme_batch_fn)(const tracer *tr, extreme_batch *b, void *scratch,
                                 ray_counters *counters);

/* extreme_batch_next() - extreme_next() for all rays: by the kind's kernel, or ray by ray where it
 * has none. */
void extreme_batch_next(const tracer *tr, extreme_batch *b, void *scratch, ray_counters *counters);

/* extreme_batch_single() - extreme_next() for ray i alone. */
void extreme_batch_single(const tracer *tr, extreme_batch *b, unsigned i, ray_counters *counters);

#endif
