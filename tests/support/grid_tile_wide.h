/* grid_tile_wide.h - tiles as AVX-512 traces them, on any CPU. */
#ifndef TESTS_SUPPORT_GRID_TILE_WIDE_H
#define TESTS_SUPPORT_GRID_TILE_WIDE_H

#include "render/frame/tile.h"

/* grid_tile_trace_wide() - as every tile_fn. */
void grid_tile_trace_wide(const frame *f, uint32_t x0, uint32_t y0, const tile_row asked[],
                          tile_outcome *out, ray_counters *counters);

#endif
