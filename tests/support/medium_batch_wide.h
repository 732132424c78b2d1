/* medium_batch_wide.h - medium_batch.h as for AVX-512, for tests on other CPUs. */
#ifndef TESTS_SUPPORT_MEDIUM_BATCH_WIDE_H
#define TESTS_SUPPORT_MEDIUM_BATCH_WIDE_H

#include "render/medium/medium_batch.h"

void medium_batch_wide(medium_batch *m, const segment_columns *pieces);

#endif
