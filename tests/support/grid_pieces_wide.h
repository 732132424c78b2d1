/* grid_pieces_wide.h - pieces of rays through a grid as AVX-512 finds them, on any CPU. */
#ifndef TESTS_SUPPORT_GRID_PIECES_WIDE_H
#define TESTS_SUPPORT_GRID_PIECES_WIDE_H

#include "render/ray/segment_batch.h"

/* grid_pieces_wide() - as every segment_batch_fn of a grid. */
void grid_pieces_wide(const tracer *tr, segment_batch *b, void *scratch, ray_counters *counters);

#endif
