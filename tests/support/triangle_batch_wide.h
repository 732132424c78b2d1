/* triangle_batch_wide.h - batches through triangles as AVX-512 traces them, on any CPU. */
#ifndef TESTS_SUPPORT_TRIANGLE_BATCH_WIDE_H
#define TESTS_SUPPORT_TRIANGLE_BATCH_WIDE_H

#include "render/triangle/triangle_batch.h"

/* triangle_batch_wide() - as every batch_fn. */
void triangle_batch_wide(const tracer *tr, ray_batch *b, void *scratch, ray_counters *counters);

#endif
