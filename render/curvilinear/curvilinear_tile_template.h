/* curvilinear_tile_template.h - curvilinear_tile_X() of curvilinear_tile.h; included by the units
 * of an ISA (see formats/base/simd.h). */
#ifndef RENDER_CURVILINEAR_CURVILINEAR_TILE_TEMPLATE_H
#define RENDER_CURVILINEAR_CURVILINEAR_TILE_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/curvilinear/curvilinear_block_template.h"

#include "render/curved/hex_tile_template.h"

void SIMD_NAME(curvilinear_tile)(const frame *f, uint32_t x0, uint32_t y0, const tile_row asked[],
                                 tile_outcome *out, ray_counters *counters);

void SIMD_NAME(curvilinear_tile)(const frame *f, uint32_t x0, uint32_t y0, const tile_row asked[],
                                 tile_outcome *out, ray_counters *counters) {
    hex_trace_tile(f, x0, y0, asked, out, counters);
}

#endif
#endif
