/* grid_extreme_batch_wide.h - greatest values on rays through a grid as AVX-512 finds them, on any
 * CPU. */
#ifndef TESTS_SUPPORT_GRID_EXTREME_BATCH_WIDE_H
#define TESTS_SUPPORT_GRID_EXTREME_BATCH_WIDE_H

#include "render/ray/extreme_batch.h"

/* grid_extreme_batch_wide() - as every extreme_batch_fn of a grid. */
void grid_extreme_batch_wide(const tracer *tr, extreme_batch *b, void *scratch,
                             ray_counters *counters);

#endif
