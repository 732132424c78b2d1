#include "render/ray/ray_batch.h"

#include "render/ray/kind.h"

void ray_batch_next(const tracer *tr, const struct kernels *k, ray_batch *b, void *scratch,
                    ray_counters *counters) {
    const batch_fn batch = tr->kind->batch ? tr->kind->batch(k) : NULL;
    if (batch) {
        batch(tr, k, b, scratch, counters);
        return;
    }
    for (unsigned i = 0; i < b->count; i++)
        ray_batch_single(tr, b, i, counters);
}
