/* box_rows_template.h - box_rows.h for one ISA, of which the compiler's flags decide. */
#ifndef FORMATS_LEAF_BOX_ROWS_TEMPLATE_H
#define FORMATS_LEAF_BOX_ROWS_TEMPLATE_H

#include <string.h>

#include "formats/base/simd_isa.h"
#include "formats/leaf/box_rows.h"

#ifdef SIMD_NAME
#define BOX_ROWS SIMD_NAME(box_rows)
#else
#define BOX_ROWS box_rows_scalar
#ifdef __SSE2__
#include <emmintrin.h>
#endif
#endif

/* How many samples of a row are coded. */
static uint32_t map_row_count(const uint8_t *bits, uint32_t samples) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < box_map_row_bytes(samples); i++) {
        unsigned b = bits[i] - (bits[i] >> 1 & 0x55U);
        b = (b & 0x33) + (b >> 2 & 0x33);
        count += (b + (b >> 4)) & 0xF;
    }
    return count;
}

/* The bits behind the last sample of a row. */
static unsigned map_row_rest(const uint8_t *bits, uint32_t samples) {
    return samples % 8 ? (unsigned)bits[samples / 8] >> samples % 8 : 0;
}

#ifdef __SSSE3__
#define plus_u8         _mm_add_epi8
#define plus_u16        _mm_add_epi16
#define plus_u32        _mm_add_epi32
#define last_lane_u8()  _mm_set1_epi8(15)
#define last_lane_u16() _mm_set1_epi16(0x0F0E)
#define last_lane_u32() _mm_set1_epi32(0x0F0E0D0C)
#endif

#define T          uint8_t
#define ROWS(name) name##_u8
#include "formats/leaf/box_row_template.h"
#undef T
#undef ROWS
#define T          uint16_t
#define ROWS(name) name##_u16
#include "formats/leaf/box_row_template.h"
#undef T
#undef ROWS
#define T          uint32_t
#define ROWS(name) name##_u32
#include "formats/leaf/box_row_template.h"
#undef T
#undef ROWS

const box_rows *BOX_ROWS(size_t sample_bytes);
const box_rows *BOX_ROWS(size_t sample_bytes) {
    return sample_bytes == 1 ? &table_u8 : sample_bytes == 2 ? &table_u16 : &table_u32;
}

#endif
