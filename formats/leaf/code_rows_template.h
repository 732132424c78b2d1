/* code_rows_template.h - code_rows.h for one ISA, of which the compiler's flags decide. */
#ifndef FORMATS_LEAF_CODE_ROWS_TEMPLATE_H
#define FORMATS_LEAF_CODE_ROWS_TEMPLATE_H

#include <math.h>
#include <string.h>

#include "formats/base/simd.h"
#include "formats/leaf/code_rows.h"
#include "formats/leaf/leaf.h"

#ifdef SIMD_NAME
#define CODE_ROWS SIMD_NAME(code_rows)
#else
#define CODE_ROWS code_rows_scalar
#endif

enum {
    CODE_BLOCK = 1 << LEAF_BLOCK_LOG2,
    CODE_CELLS_MAX = 1 << LEAF_CELLS_LOG2_MAX,
    CODE_LINES_MAX = CODE_CELLS_MAX / CODE_BLOCK,
    /* With room for the neighbours of the last node, and for whole vectors. */
    CODE_ROW = CODE_CELLS_MAX + 1 + CODE_BLOCK + 32
};

/* Spread the bits of a block coordinate (below 16), with two zero bits between each. */
static inline uint32_t code_spread(uint32_t v) {
    return (v & 1) | (v & 2) << 2 | (v & 4) << 4 | (v & 8) << 6;
}

/* The rows of a line of blocks: `rows` of them in each of `slices`. */
typedef struct code_line {
    const void *first;
    size_t row, slice;
    uint32_t rows, slices, nodes;
} code_line;

/* ---- plain loops ---- */

/* A sample as an operand of a minimum and of a maximum. */
#define ANY_LO(v)    (v)
#define ANY_HI(v)    (v)
#define FINITE_LO(v) (isfinite(v) ? (v) : INFINITY)
#define FINITE_HI(v) (isfinite(v) ? (v) : -INFINITY)

/* Reduce the rows of a line to one. */
#define DEFINE_PLAIN(name, T, OF_LO, OF_HI)                                \
    static void name(const code_line *r, T *restrict lo, T *restrict hi) { \
        const T *slice = r->first;                                         \
        for (uint32_t i = 0; i < r->nodes; i++) {                          \
            lo[i] = OF_LO(slice[i]);                                       \
            hi[i] = OF_HI(slice[i]);                                       \
        }                                                                  \
        for (uint32_t z = 0; z < r->slices; z++, slice += r->slice) {      \
            const T *row = slice;                                          \
            for (uint32_t y = 0; y < r->rows; y++, row += r->row)          \
                for (uint32_t i = 0; i < r->nodes; i++) {                  \
                    const T v = OF_LO(row[i]), w = OF_HI(row[i]);          \
                    lo[i] = v < lo[i] ? v : lo[i];                         \
                    hi[i] = w > hi[i] ? w : hi[i];                         \
                }                                                          \
        }                                                                  \
    }
/* Reduce each sample of a row with the four behind it. */
#define DEFINE_PLAIN_ACROSS(name, T)                           \
    static void name(T *lo, T *hi, uint32_t cells) {           \
        for (uint32_t x = 0; x < cells; x++)                   \
            for (uint32_t i = 1; i <= CODE_BLOCK; i++) {       \
                lo[x] = lo[x + i] < lo[x] ? lo[x + i] : lo[x]; \
                hi[x] = hi[x + i] > hi[x] ? hi[x + i] : hi[x]; \
            }                                                  \
    }

DEFINE_PLAIN(plain_u8, uint8_t, ANY_LO, ANY_HI)
DEFINE_PLAIN(plain_i8, int8_t, ANY_LO, ANY_HI)
DEFINE_PLAIN(plain_u16, uint16_t, ANY_LO, ANY_HI)
DEFINE_PLAIN(plain_i16, int16_t, ANY_LO, ANY_HI)
DEFINE_PLAIN(plain_f32, float, ANY_LO, ANY_HI)
DEFINE_PLAIN(plain_f32_finite, float, FINITE_LO, FINITE_HI)
DEFINE_PLAIN_ACROSS(plain_across_f32, float)

/* ---- vectors ---- */

#ifdef SIMD_NAME

#ifdef __AVX2__
typedef __m256i code_ints;
#define CODE_INTS(op)          _mm256_##op
#define CODE_LOAD_INTS(from)   _mm256_loadu_si256((const __m256i *)(const void *)(from))
#define CODE_STORE_INTS(to, v) _mm256_storeu_si256((__m256i *)(void *)(to), v)
#else
typedef __m128i code_ints;
#define CODE_INTS(op)          _mm_##op
#define CODE_LOAD_INTS(from)   _mm_loadu_si128((const __m128i *)(const void *)(from))
#define CODE_STORE_INTS(to, v) _mm_storeu_si128((__m128i *)(void *)(to), v)
#endif

/* The same; the last samples of a row are taken together with some before them. Across, more than
 * the cells may be overwritten. */
#define DEFINE_VECTORS(suffix, T, V, LOAD, STORE, MIN, MAX)               \
    static inline __attribute__((always_inline)) void some_##suffix(      \
        const code_line *r, uint32_t rows, uint32_t x, T *lo, T *hi) {    \
        const T *slice = (const T *)r->first + x;                         \
        V a = LOAD(slice), b = a;                                         \
        for (uint32_t z = 0; z < r->slices; z++, slice += r->slice)       \
            for (uint32_t y = 0; y < rows; y++) {                         \
                const V v = LOAD(slice + y * r->row);                     \
                a = MIN(v, a);                                            \
                b = MAX(v, b);                                            \
            }                                                             \
        STORE(lo + x, a);                                                 \
        STORE(hi + x, b);                                                 \
    }                                                                     \
    static inline __attribute__((always_inline)) void lanes_##suffix(     \
        const code_line *r, uint32_t rows, T *lo, T *hi) {                \
        const uint32_t lanes = sizeof(V) / sizeof(T);                     \
        for (uint32_t x = 0; x + lanes <= r->nodes; x += lanes)           \
            some_##suffix(r, rows, x, lo, hi);                            \
        if (r->nodes % lanes)                                             \
            some_##suffix(r, rows, r->nodes - lanes, lo, hi);             \
    }                                                                     \
    static void reduce_##suffix(const code_line *r, T *lo, T *hi) {       \
        if (r->nodes < sizeof(V) / sizeof(T))                             \
            plain_##suffix(r, lo, hi);                                    \
        else if (r->rows == CODE_BLOCK + 1) /* nearly always: unrolled */ \
            lanes_##suffix(r, CODE_BLOCK + 1, lo, hi);                    \
        else                                                              \
            lanes_##suffix(r, r->rows, lo, hi);                           \
    }                                                                     \
    static void across_##suffix(T *lo, T *hi, uint32_t cells) {           \
        for (uint32_t x = 0; x < cells; x += sizeof(V) / sizeof(T)) {     \
            V a = LOAD(lo + x), b = LOAD(hi + x);                         \
            for (uint32_t i = 1; i <= CODE_BLOCK; i++) {                  \
                a = MIN(a, LOAD(lo + x + i));                             \
                b = MAX(b, LOAD(hi + x + i));                             \
            }                                                             \
            STORE(lo + x, a);                                             \
            STORE(hi + x, b);                                             \
        }                                                                 \
    }
#define DEFINE_INTS(suffix, T, lanes)                                                             \
    DEFINE_VECTORS(suffix, T, code_ints, CODE_LOAD_INTS, CODE_STORE_INTS, CODE_INTS(min_##lanes), \
                   CODE_INTS(max_##lanes))

DEFINE_INTS(u8, uint8_t, epu8)
DEFINE_INTS(i8, int8_t, epi8)
DEFINE_INTS(u16, uint16_t, epu16)
DEFINE_INTS(i16, int16_t, epi16)
DEFINE_VECTORS(f32, float, vf, f_load, f_store, f_min, f_max)

#else

#define reduce_u8  plain_u8
#define reduce_i8  plain_i8
#define reduce_u16 plain_u16
#define reduce_i16 plain_i16
#define reduce_f32 plain_f32
#define across_f32 plain_across_f32
DEFINE_PLAIN_ACROSS(across_u8, uint8_t)
DEFINE_PLAIN_ACROSS(across_i8, int8_t)
DEFINE_PLAIN_ACROSS(across_u16, uint16_t)
DEFINE_PLAIN_ACROSS(across_i16, int16_t)

#endif

/* ---- the blocks of a treelet ---- */

/* Reduce the lines of a layer of blocks to rows first, as reading what was just stored at another
 * place is slow. A short last block repeats its last sample. */
#define DEFINE_BLOCKS(suffix, T, REDUCE, ACROSS)                                                  \
    static void layer_##suffix(const code_samples *s, code_line r, uint32_t at, float *blocks_lo, \
                               float *blocks_hi) {                                                \
        T lo[CODE_LINES_MAX][CODE_ROW], hi[CODE_LINES_MAX][CODE_ROW];                             \
        const uint32_t cells = s->cells[0], lines = (s->cells[1] + CODE_BLOCK - 1) / CODE_BLOCK;  \
        for (uint32_t by = 0; by < lines; by++) {                                                 \
            const uint32_t left = s->cells[1] - by * CODE_BLOCK;                                  \
            r.rows = (left < CODE_BLOCK ? left : CODE_BLOCK) + 1;                                 \
            REDUCE(&r, lo[by], hi[by]);                                                           \
            r.first = (const T *)r.first + CODE_BLOCK * r.row;                                    \
            for (uint32_t i = 1; i < CODE_BLOCK; i++) {                                           \
                lo[by][cells + i] = lo[by][cells];                                                \
                hi[by][cells + i] = hi[by][cells];                                                \
            }                                                                                     \
        }                                                                                         \
        for (uint32_t by = 0; by < lines; by++) {                                                 \
            ACROSS(lo[by], hi[by], cells);                                                        \
            for (uint32_t bx = 0; bx * CODE_BLOCK < cells; bx++) {                                \
                const uint32_t m = code_spread(bx) | code_spread(by) << 1 | at;                   \
                blocks_lo[m] = (float)lo[by][bx * CODE_BLOCK];                                    \
                blocks_hi[m] = (float)hi[by][bx * CODE_BLOCK];                                    \
            }                                                                                     \
        }                                                                                         \
    }                                                                                             \
    static void blocks_##suffix(const code_samples *s, float *lo, float *hi) {                    \
        for (uint32_t z = 0; z < s->cells[2]; z += CODE_BLOCK) {                                  \
            const uint32_t left = s->cells[2] - z;                                                \
            const code_line r = {.first = (const T *)s->first + z * s->slice,                     \
                                 .row = s->row,                                                   \
                                 .slice = s->slice,                                               \
                                 .slices = (left < CODE_BLOCK ? left : CODE_BLOCK) + 1,           \
                                 .nodes = s->cells[0] + 1};                                       \
            layer_##suffix(s, r, code_spread(z / CODE_BLOCK) << 2, lo, hi);                       \
        }                                                                                         \
    }
#define DEFINE_INTEGERS(suffix, T)                                             \
    DEFINE_BLOCKS(suffix, T, reduce_##suffix, across_##suffix)                 \
    static bool ranges_##suffix(const code_samples *s, float *lo, float *hi) { \
        blocks_##suffix(s, lo, hi);                                            \
        return false;                                                          \
    }

DEFINE_INTEGERS(u8, uint8_t)
DEFINE_INTEGERS(i8, int8_t)
DEFINE_INTEGERS(u16, uint16_t)
DEFINE_INTEGERS(i16, int16_t)
DEFINE_BLOCKS(f32, float, reduce_f32, across_f32)
DEFINE_BLOCKS(f32_finite, float, plain_f32_finite, plain_across_f32)

/* Returns whether a sample is NaN or inf, by an exponent of all ones. */
static bool code_non_finite(const code_samples *s) {
    uint32_t found = 0;
    for (uint32_t z = 0; z <= s->cells[2]; z++)
        for (uint32_t y = 0; y <= s->cells[1]; y++) {
            const uint32_t *row = (const uint32_t *)s->first + z * s->slice + y * s->row;
            for (uint32_t x = 0; x <= s->cells[0]; x++)
                found |= (row[x] & 0x7F800000u) == 0x7F800000u;
        }
    return found;
}

static bool ranges_f32(const code_samples *s, float *lo, float *hi) {
    const bool found = code_non_finite(s);
    (found ? blocks_f32_finite : blocks_f32)(s, lo, hi);
    return found;
}

/* ---- codes ---- */

static void code_whole(const float *lo, const float *hi, uint32_t count, float whole[2]) {
    enum { LANES = 16 };
    float a[LANES], b[LANES];
    for (uint32_t i = 0; i < LANES; i++) {
        a[i] = INFINITY;
        b[i] = -INFINITY;
    }
    for (uint32_t m = 0; m < count; m += LANES)
        for (uint32_t i = 0; i < LANES; i++) {
            a[i] = lo[m + i] < a[i] ? lo[m + i] : a[i];
            b[i] = hi[m + i] > b[i] ? hi[m + i] : b[i];
        }
    for (uint32_t i = 1; i < LANES; i++) {
        a[0] = a[i] < a[0] ? a[i] : a[0];
        b[0] = b[i] > b[0] ? b[i] : b[0];
    }
    whole[0] = a[0];
    whole[1] = b[0];
}

/* Round doubles up; `count` of them, a multiple of 8. */
static inline void code_round_up(double *g, uint32_t count) {
#ifdef SIMD_NAME
    for (uint32_t i = 0; i < count; i += VD_N)
        d_store(g + i, d_ceil(d_load(g + i)));
#else
    for (uint32_t i = 0; i < count; i++)
        g[i] = ceil(g[i]);
#endif
}

/* An empty range is inf, -inf, which the quantizer maps to 255, 0, unless it has but one value. */
static void code_encode(const quantizer *q, const float *restrict lo, const float *restrict hi,
                        uint32_t count, uint8_t *restrict lo_codes, uint8_t *restrict hi_codes) {
    enum { SOME = 64 };
    const quantizer by = *q;
    double g[SOME];
    if (!(by.scale > 0)) {
        for (uint32_t m = 0; m < count; m++)
            lo_codes[m] = lo[m] > hi[m] ? 255 : 0;
        memset(hi_codes, 0, count);
        return;
    }
    for (uint32_t m = 0; m < count; m++)
        lo_codes[m] = quantizer_floor(&by, (double)lo[m]);
    for (uint32_t m = 0; m < count; m += SOME) {
        for (uint32_t i = 0; i < SOME; i++)
            g[i] = quantizer_map(&by, (double)hi[m + i]);
        code_round_up(g, SOME);
        for (uint32_t i = 0; i < SOME; i++)
            hi_codes[m + i] = (uint8_t)(int)g[i];
    }
}

const code_rows *CODE_ROWS(sample_type type);
const code_rows *CODE_ROWS(sample_type type) {
    static const code_rows rows[] = {
        [SAMPLE_U8] = {ranges_u8, code_whole, code_encode},
        [SAMPLE_I8] = {ranges_i8, code_whole, code_encode},
        [SAMPLE_U16] = {ranges_u16, code_whole, code_encode},
        [SAMPLE_I16] = {ranges_i16, code_whole, code_encode},
        [SAMPLE_F32] = {ranges_f32, code_whole, code_encode},
    };
    return &rows[type];
}

#endif
