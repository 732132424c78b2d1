#include "render/ray/ray_batch.h"

#include "render/ray/ray_kernels.h"

void ray_batch_next(const tracer *tr, ray_batch *b, void *scratch, ray_counters *counters) {
    if (tr->kernels->batch) {
        tr->kernels->batch(tr, b, scratch, counters);
        return;
    }
    for (unsigned i = 0; i < b->count; i++)
        ray_batch_single(tr, b, i, counters);
}
