#include "render/grid/grid_tile.h"

#include <stddef.h>

#if defined __x86_64__ || defined __i386__
void grid_tile_trace_sse42(const frame *f, uint32_t x0, uint32_t y0, const tile_row pixels[],
                           tile_outcome *out, ray_counters *counters);
void grid_tile_trace_avx2(const frame *f, uint32_t x0, uint32_t y0, const tile_row pixels[],
                          tile_outcome *out, ray_counters *counters);
void grid_tile_trace_avx512(const frame *f, uint32_t x0, uint32_t y0, const tile_row pixels[],
                            tile_outcome *out, ray_counters *counters);
#endif

tile_fn grid_tile_for(cpu_isa isa) {
    switch (isa) {
#if defined __x86_64__ || defined __i386__
    case CPU_SSE42: return grid_tile_trace_sse42;
    case CPU_AVX2: return grid_tile_trace_avx2;
    case CPU_AVX512: return grid_tile_trace_avx512;
#endif
    default: return NULL;
    }
}
