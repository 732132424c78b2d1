/* ray_batch.h - rays of any origins and directions through one volume together.
 *
 * Shadow rays of neighbouring surfaces and rays of a caller mostly go the same way. So nodes are
 * tested against all of them at once, and their cells fill vectors. Each ray's answer equals
 * tracer_next(), to the bit, whatever the other rays are; a batch only saves time. One exception: a
 * ray that looks for any hit may find one where a single ray would wait for a treelet.
 */
#ifndef RENDER_RAY_RAY_BATCH_H
#define RENDER_RAY_RAY_BATCH_H

#include "render/ray/tracer.h"

/* Rays of a batch, at most. */
enum { RAY_BATCH = 256 };

/* Results and states are those of tracer_next() for each ray. A state may come from trace_begin(),
 * also with `any` or a bound as best; or from tracer_next() where a treelet was absent. */
typedef struct ray_batch {
    unsigned count; /* 1 to RAY_BATCH */
    ray rays[RAY_BATCH];
    trace_state states[RAY_BATCH];
    trace_result results[RAY_BATCH];
} ray_batch;

/* batch_fn - a kind's kernel: traces all rays of *b. scratch: kind_batches.scratch bytes of the
 * caller's, 64-byte aligned, not initialised. */
typedef void (*batch_fn)(const tracer *tr, ray_batch *b, void *scratch, ray_counters *counters);

/* ray_batch_next() - tracer_next() for all rays of *b: by the kind's kernel, or one by one where it
 * has none. */
void ray_batch_next(const tracer *tr, ray_batch *b, void *scratch, ray_counters *counters);

/* ray_batch_single() - tracer_find() for ray i alone, so that the others need not wait for it. */
static inline void ray_batch_single(const tracer *tr, ray_batch *b, unsigned i,
                                    ray_counters *counters) {
    b->results[i] = tracer_find(tr, &b->rays[i], &b->states[i], counters);
}

#endif
