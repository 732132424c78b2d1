/* ray_batch.h - rays of any origins and directions through one volume together.
 *
 * Shadow rays of neighbouring surfaces and rays of a caller mostly go the same way: nodes are
 * tested against all of them at once, and their cells fill vectors. Each ray's answer is, to the
 * bit, that of tracer_next() alone, whatever the others are; only the time is the batch's. One that
 * looks for any hit may find one where alone it would wait for a treelet.
 */
#ifndef RENDER_RAY_RAY_BATCH_H
#define RENDER_RAY_RAY_BATCH_H

#include "render/ray/tracer.h"

/* Rays of a batch, at most. */
enum { RAY_BATCH = 256 };

/* Results and states are those of tracer_next() for each ray. A state may be one of trace_begin(),
 * also with `any` or a bound as best; or one that tracer_next() has left where a treelet was
 * absent. */
typedef struct ray_batch {
    unsigned count; /* 1 to RAY_BATCH */
    ray rays[RAY_BATCH];
    trace_state states[RAY_BATCH];
    trace_result results[RAY_BATCH];
} ray_batch;

/* batch_fn - a kind's kernel: all rays of *b. scratch: kind.batch_scratch bytes of the caller's,
 * 64-byte aligned, whatever is in them. */
typedef void (*batch_fn)(const tracer *tr, ray_batch *b, void *scratch, ray_counters *counters);

/* ray_batch_next() - tracer_next() for all rays of *b: by the kind's kernel, or one by one where it
 * has none. */
void ray_batch_next(const tracer *tr, ray_batch *b, void *scratch, ray_counters *counters);

/* ray_batch_single() - the same for ray i alone, which the others are not to wait for. */
static inline void ray_batch_single(const tracer *tr, ray_batch *b, unsigned i,
                                    ray_counters *counters) {
    b->results[i] = tracer_next(tr, &b->rays[i], &b->states[i], counters);
}

#endif
