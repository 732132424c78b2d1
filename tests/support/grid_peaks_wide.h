/* grid_peaks_wide.h - greatest values on rays through a grid as AVX-512 finds them, on any CPU. */
#ifndef TESTS_SUPPORT_GRID_PEAKS_WIDE_H
#define TESTS_SUPPORT_GRID_PEAKS_WIDE_H

#include "render/ray/extreme_batch.h"

/* grid_peaks_wide() - as every extreme_batch_fn of a grid. */
void grid_peaks_wide(const tracer *tr, extreme_batch *b, void *scratch, ray_counters *counters);

#endif
