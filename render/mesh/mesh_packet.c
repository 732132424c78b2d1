#include "render/mesh/mesh_packet.h"

#include <stddef.h>

#if defined __x86_64__ || defined __i386__
void mesh_packet_sse42(const frame *f, uint32_t x0, uint32_t y0, const tile_row pixels[],
                       tile_outcome *out, ray_counters *counters);
void mesh_packet_avx2(const frame *f, uint32_t x0, uint32_t y0, const tile_row pixels[],
                      tile_outcome *out, ray_counters *counters);
void mesh_packet_avx512(const frame *f, uint32_t x0, uint32_t y0, const tile_row pixels[],
                        tile_outcome *out, ray_counters *counters);
#endif

tile_fn mesh_packet_for(cpu_isa isa) {
    switch (isa) {
#if defined __x86_64__ || defined __i386__
    case CPU_SSE42: return mesh_packet_sse42;
    case CPU_AVX2: return mesh_packet_avx2;
    case CPU_AVX512: return mesh_packet_avx512;
#endif
    default: return NULL;
    }
}
