/* mixed_tile_template.h - mixed_tile_X() of mixed_tile.h; included by the units of an ISA (see
 * formats/base/simd.h). */
#ifndef RENDER_MIXED_MIXED_TILE_TEMPLATE_H
#define RENDER_MIXED_MIXED_TILE_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/mixed/mixed_block_template.h"

#include "render/curved/hex_tile_template.h"

void SIMD_NAME(mixed_tile)(const frame *f, uint32_t x0, uint32_t y0, const tile_row asked[],
                           tile_outcome *out, ray_counters *counters);

void SIMD_NAME(mixed_tile)(const frame *f, uint32_t x0, uint32_t y0, const tile_row asked[],
                           tile_outcome *out, ray_counters *counters) {
    hex_trace_tile(f, x0, y0, asked, out, counters);
}

#endif
#endif
