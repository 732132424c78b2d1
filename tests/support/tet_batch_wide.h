/* tet_batch_wide.h - the SIMD version of tet_batch.h as AVX-512 runs it, for any CPU. */
#ifndef TESTS_SUPPORT_TET_BATCH_WIDE_H
#define TESTS_SUPPORT_TET_BATCH_WIDE_H

#include "render/mesh/tet_batch.h"

/* tet_batch_wide() - a tet_batch_fn. */
void tet_batch_wide(const isopolygon *g, uint64_t cell, int32_t iso_index, tet_known known,
                    flat_rays *rays, int first, int end);

#endif
