#include "render/ray/extreme_batch.h"

#include "render/ray/ray_kernels.h"

void extreme_batch_single(const tracer *tr, extreme_batch *b, unsigned i, ray_counters *counters) {
    const extreme_state *near = i > 0 ? b->state[i - 1] : NULL;
    b->result[i] = extreme_next(tr, &b->rays[i], near, b->state[i], counters);
}

void extreme_batch_next(const tracer *tr, extreme_batch *b, void *scratch, ray_counters *counters) {
    if (tr->kernels->extreme_batch) {
        tr->kernels->extreme_batch(tr, b, scratch, counters);
        return;
    }
    for (unsigned i = 0; i < b->count; i++)
        extreme_batch_single(tr, b, i, counters);
}
