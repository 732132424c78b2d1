#include "render/ray/ray_batch.h"

#include "render/ray/ray_kernels.h"

void ray_batch_next(const tracer *tr, ray_batch *b, void *scratch, ray_counters *counters) {
    const batch_fn together = tr->kernels->batch;
    if (together)
        together(tr, b, scratch, counters);
    for (unsigned i = 0; i < b->count && !together; i++)
        ray_batch_single(tr, b, i, counters);
    for (unsigned i = 0; i < b->count && tr->place.moved; i++)
        tracer_take_back(tr, &b->rays[i], b->results[i], &b->states[i]);
}
