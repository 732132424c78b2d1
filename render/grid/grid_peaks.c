#include "render/grid/grid_peaks.h"

#include <stddef.h>

#if defined __x86_64__ || defined __i386__
void grid_peaks_sse42(const tracer *tr, extreme_batch *b, void *scratch, ray_counters *counters);
void grid_peaks_avx2(const tracer *tr, extreme_batch *b, void *scratch, ray_counters *counters);
void grid_peaks_avx512(const tracer *tr, extreme_batch *b, void *scratch, ray_counters *counters);
#endif

extreme_batch_fn grid_peaks_for(cpu_isa isa) {
    switch (isa) {
#if defined __x86_64__ || defined __i386__
    case CPU_SSE42: return grid_peaks_sse42;
    case CPU_AVX2: return grid_peaks_avx2;
    case CPU_AVX512: return grid_peaks_avx512;
#endif
    default: return NULL;
    }
}
