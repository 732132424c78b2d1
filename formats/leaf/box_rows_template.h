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
#ifdef __POPCNT__
        count += (uint32_t)__builtin_popcount(bits[i]);
#else
        unsigned b = bits[i] - (bits[i] >> 1 & 0x55U);
        b = (b & 0x33) + (b >> 2 & 0x33);
        count += (b + (b >> 4)) & 0xF;
#endif
    }
    return count;
}

/* The bits behind the last sample of a row. */
static unsigned map_row_rest(const uint8_t *bits, uint32_t samples) {
    return samples % 8 ? (unsigned)bits[samples / 8] >> samples % 8 : 0;
}

#ifdef __SSE4_1__
#define plus_u8         _mm_add_epi8
#define plus_u16        _mm_add_epi16
#define plus_u32        _mm_add_epi32
#define minus_u8        _mm_sub_epi8
#define minus_u16       _mm_sub_epi16
#define minus_u32       _mm_sub_epi32
#define below_u8(a, b)  _mm_cmplt_epi8(a, b)
#define below_u16(a, b) _mm_cmplt_epi16(a, b)
#define below_u32(a, b) _mm_cmplt_epi32(a, b)
#define min_u8          _mm_min_epu8
#define min_u16         _mm_min_epu16
#define min_u32         _mm_min_epu32
#define max_u8          _mm_max_epu8
#define max_u16         _mm_max_epu16
#define max_u32         _mm_max_epu32
#define all_u8(x)       _mm_set1_epi8((char)(x))
#define all_u16(x)      _mm_set1_epi16((short)(x))
#define all_u32(x)      _mm_set1_epi32((int)(x))
#define last_lane_u8()  _mm_set1_epi8(15)
#define last_lane_u16() _mm_set1_epi16(0x0F0E)
#define last_lane_u32() _mm_set1_epi32(0x0F0E0D0C)

static inline __m128i unfolded_u8(__m128i r) {
    const __m128i half = _mm_and_si128(_mm_srli_epi16(r, 1), _mm_set1_epi8(0x7F));
    const __m128i odd = _mm_and_si128(r, _mm_set1_epi8(1));
    return _mm_xor_si128(half, _mm_sub_epi8(_mm_setzero_si128(), odd));
}

static inline __m128i unfolded_u16(__m128i r) {
    const __m128i odd = _mm_and_si128(r, _mm_set1_epi16(1));
    return _mm_xor_si128(_mm_srli_epi16(r, 1), _mm_sub_epi16(_mm_setzero_si128(), odd));
}

static inline __m128i unfolded_u32(__m128i r) {
    const __m128i odd = _mm_and_si128(r, _mm_set1_epi32(1));
    return _mm_xor_si128(_mm_srli_epi32(r, 1), _mm_sub_epi32(_mm_setzero_si128(), odd));
}

/* The bits of as many samples from x on as a vector holds; x is a multiple of these. */
static inline unsigned bits_from_u8(const uint8_t *coded, uint32_t x) {
    return coded[x / 8] | (unsigned)coded[x / 8 + 1] << 8;
}

static inline unsigned bits_from_u16(const uint8_t *coded, uint32_t x) {
    return coded[x / 8];
}

static inline unsigned bits_from_u32(const uint8_t *coded, uint32_t x) {
    return coded[x / 8] >> x % 8 & 15U;
}
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
