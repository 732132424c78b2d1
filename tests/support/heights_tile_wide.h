/* heights_tile_wide.h - tiles over terrain as AVX-512 traces them, on any CPU. */
#ifndef TESTS_SUPPORT_HEIGHTS_TILE_WIDE_H
#define TESTS_SUPPORT_HEIGHTS_TILE_WIDE_H

#include "render/heights/heights_tile.h"

/* heights_tile_wide() - as every tile_fn. */
void heights_tile_wide(const frame *f, uint32_t x0, uint32_t y0, const tile_row asked[],
                       tile_outcome *out, ray_counters *counters);

#endif
