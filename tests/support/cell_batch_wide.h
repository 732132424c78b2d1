/* cell_batch_wide.h - the SIMD version of cell_batch.h as AVX-512 runs it, for any CPU. */
#ifndef TESTS_SUPPORT_CELL_BATCH_WIDE_H
#define TESTS_SUPPORT_CELL_BATCH_WIDE_H

#include "render/grid/cell_batch.h"

/* cell_batch_wide() - as every cell_batch_fn. */
void cell_batch_wide(const cell_batch *b, int lanes, const double *isovalues, int count,
                     cell_batch_hits *out);
void cell_roots_wide(const cell_batch *b, int lanes, double isovalue, cell_batch_roots *out);

#endif
