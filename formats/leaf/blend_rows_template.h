/* blend_rows_template.h - blend_rows.h for one ISA, of which the compiler's flags decide. */
#ifndef FORMATS_LEAF_BLEND_ROWS_TEMPLATE_H
#define FORMATS_LEAF_BLEND_ROWS_TEMPLATE_H

#include <stdint.h>

#include "formats/base/simd_isa.h"
#include "formats/leaf/blend_rows.h"

#ifdef SIMD_NAME
#define BLEND_ROWS SIMD_NAME(blend_rows)
#else
#define BLEND_ROWS blend_rows_scalar
#endif

#define DEFINE_BLEND(T, suffix)                                                                \
    static void blend_##suffix(const void *a, const void *b, double share, float *restrict to, \
                               size_t count) {                                                 \
        const T *restrict from = a, *restrict until = b;                                       \
        for (size_t i = 0; i < count && share == 0.0; i++)                                     \
            to[i] = (float)from[i];                                                            \
        for (size_t i = 0; i < count && share != 0.0; i++)                                     \
            to[i] = blend_sample((float)from[i], (float)until[i], share);                      \
    }

DEFINE_BLEND(uint8_t, u8)
DEFINE_BLEND(int8_t, i8)
DEFINE_BLEND(uint16_t, u16)
DEFINE_BLEND(int16_t, i16)
DEFINE_BLEND(float, f32)

blend_fn *BLEND_ROWS(sample_type type);

blend_fn *BLEND_ROWS(sample_type type) {
    static blend_fn *const by_type[] = {[SAMPLE_U8] = blend_u8,
                                        [SAMPLE_I8] = blend_i8,
                                        [SAMPLE_U16] = blend_u16,
                                        [SAMPLE_I16] = blend_i16,
                                        [SAMPLE_F32] = blend_f32};
    return by_type[type];
}

#endif
