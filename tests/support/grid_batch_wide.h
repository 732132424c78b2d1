/* grid_batch_wide.h - batches of rays as AVX-512 traces them, on any CPU. */
#ifndef TESTS_SUPPORT_GRID_BATCH_WIDE_H
#define TESTS_SUPPORT_GRID_BATCH_WIDE_H

#include "render/ray/ray_batch.h"

/* grid_batch_trace_wide() - as every batch_fn of a grid. */
void grid_batch_trace_wide(const tracer *tr, ray_batch *b, void *scratch, ray_counters *counters);

#endif
