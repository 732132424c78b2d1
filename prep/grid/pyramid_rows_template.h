/* pyramid_rows_template.h - pyramid_rows.h for one ISA, of which the compiler's flags decide. */
#ifndef PREP_GRID_PYRAMID_ROWS_TEMPLATE_H
#define PREP_GRID_PYRAMID_ROWS_TEMPLATE_H

#include <stdbool.h>
#include <string.h>

#include "formats/base/sample_pairs.h"
#include "formats/base/simd_isa.h"
#include "prep/grid/pyramid_rows.h"

#ifdef SIMD_NAME
#define PYRAMID_ROWS SIMD_NAME(pyramid_rows)
#else
#define PYRAMID_ROWS pyramid_rows_scalar
#endif

static inline uint32_t nearest_node(int64_t i, uint32_t nodes) {
    return i < 0 ? 0 : i >= nodes ? nodes - 1 : (uint32_t)i;
}

/* Sums around nodes whose pairs of neighbours all exist. T: the samples' type; P: the type of sums
 * over a row or a plane. */
#define DEFINE_INSIDE_INTEGER(T, P, W, suffix)                                                    \
    static inline W pair_##suffix(const T *at) {                                                  \
        W pair;                                                                                   \
        memcpy(&pair, at, sizeof pair);                                                           \
        return pair;                                                                              \
    }                                                                                             \
    static void inside_##suffix(const T *restrict v, P *restrict sums, uint32_t first,            \
                                uint32_t end) {                                                   \
        for (size_t i = first; i < end; i++) {                                                    \
            const W a = pair_##suffix(v + 2 * i - 2), b = pair_##suffix(v + 2 * i);               \
            const W c = pair_##suffix(v + 2 * i + 2);                                             \
            sums[i] =                                                                             \
                (P)PYRAMID_WEIGH(P, PAIR_FIRST(T, P, a), PAIR_SECOND(T, P, a),                    \
                                 PAIR_FIRST(T, P, b), PAIR_SECOND(T, P, b), PAIR_FIRST(T, P, c)); \
        }                                                                                         \
    }

static void inside_f32(const float *restrict v, double *restrict sums, uint32_t first,
                       uint32_t end) {
    for (size_t i = first; i < end; i++)
        sums[i] =
            PYRAMID_WEIGH(double, v[2 * i - 2], v[2 * i - 1], v[2 * i], v[2 * i + 1], v[2 * i + 2]);
}

/* The same for samples of one byte, a vector of sums at once. WEIGH: the weighted sums of pairs. */
#ifdef SIMD_NAME

#ifdef __AVX2__
typedef __m256i pyramid_ints;
#define PYRAMID_INTS(op)     _mm256_##op
#define PYRAMID_LOAD(from)   _mm256_loadu_si256((const __m256i *)(const void *)(from))
#define PYRAMID_STORE(to, v) _mm256_storeu_si256((__m256i *)(void *)(to), v)
#else
typedef __m128i pyramid_ints;
#define PYRAMID_INTS(op)     _mm_##op
#define PYRAMID_LOAD(from)   _mm_loadu_si128((const __m128i *)(const void *)(from))
#define PYRAMID_STORE(to, v) _mm_storeu_si128((__m128i *)(void *)(to), v)
#endif
#define WEIGH_U8(v, weights) PYRAMID_INTS(maddubs_epi16)(v, weights)
#define WEIGH_I8(v, weights) PYRAMID_INTS(maddubs_epi16)(weights, v)

#define DEFINE_INSIDE_BYTES(T, P, WEIGH, suffix)                                                \
    static void inside_##suffix(const T *restrict v, P *restrict sums, uint32_t first,          \
                                uint32_t end) {                                                 \
        enum { LANES = sizeof(pyramid_ints) / sizeof(P) };                                      \
        const pyramid_ints outer = PYRAMID_INTS(set1_epi16)(1 | 4 << 8);                        \
        const pyramid_ints inner = PYRAMID_INTS(set1_epi16)(6 | 4 << 8);                        \
        const pyramid_ints last = PYRAMID_INTS(set1_epi16)(1);                                  \
        size_t i = first;                                                                       \
        for (; i + LANES <= end; i += LANES) {                                                  \
            const pyramid_ints a = WEIGH(PYRAMID_LOAD(v + 2 * i - 2), outer);                   \
            const pyramid_ints b = WEIGH(PYRAMID_LOAD(v + 2 * i), inner);                       \
            const pyramid_ints c = WEIGH(PYRAMID_LOAD(v + 2 * i + 2), last);                    \
            PYRAMID_STORE(sums + i, PYRAMID_INTS(add_epi16)(PYRAMID_INTS(add_epi16)(a, b), c)); \
        }                                                                                       \
        inside_few_##suffix(v, sums, (uint32_t)i, end);                                         \
    }
#endif

#define DEFINE_XY(T, P, suffix)                                                            \
    static void x_##suffix(const void *from, uint32_t nodes, void *to, uint32_t first,     \
                           uint32_t end) {                                                 \
        const T *v = from;                                                                 \
        P *sums = to;                                                                      \
        const uint32_t inner = first ? first : 1;                                          \
        /* From the first whose next pair may reach over the end on, one by one. */        \
        const uint32_t over = nodes / 2 - 1;                                               \
        const uint32_t until = over < end ? over : end;                                    \
        if (inner < until)                                                                 \
            inside_##suffix(v, sums, inner, until);                                        \
        for (uint32_t i = first; i < end; i++) {                                           \
            T e[PYRAMID_TAPS];                                                             \
            if (i == inner && i < until)                                                   \
                i = until;                                                                 \
            if (i >= end)                                                                  \
                break;                                                                     \
            for (int d = 0; d < PYRAMID_TAPS; d++)                                         \
                e[d] = v[nearest_node(2 * (int64_t)i + d - 2, nodes)];                     \
            sums[i] = (P)PYRAMID_WEIGH(P, e[0], e[1], e[2], e[3], e[4]);                   \
        }                                                                                  \
    }                                                                                      \
    static void y_##suffix(const void *const taps[PYRAMID_TAPS], void *to, uint32_t first, \
                           uint32_t end) {                                                 \
        const P *a = taps[0], *b = taps[1], *c = taps[2], *d = taps[3], *e = taps[4];      \
        P *restrict sums = to;                                                             \
        for (size_t i = first; i < end; i++)                                               \
            sums[i] = (P)PYRAMID_WEIGH(P, a[i], b[i], c[i], d[i], e[i]);                   \
    }

/* Round half to even: add just below a half, and one more if the quotient is odd. Shifts of
 * negative sums are arithmetic (in gcc and clang): quotients round down first, then go up in the
 * same way. S: the type to add in. */
#define DEFINE_Z_INTEGER(T, P, S, suffix)                                                  \
    static void z_##suffix(const void *const taps[PYRAMID_TAPS], void *to, uint32_t first, \
                           uint32_t end) {                                                 \
        const P *a = taps[0], *b = taps[1], *c = taps[2], *d = taps[3], *e = taps[4];      \
        T *restrict samples = to;                                                          \
        for (size_t i = first; i < end; i++) {                                             \
            const S sum = PYRAMID_WEIGH(S, a[i], b[i], c[i], d[i], e[i]);                  \
            samples[i] = (T)((sum + (PYRAMID_WHOLE / 2 - 1) + ((sum >> 12) & 1)) >> 12);   \
        }                                                                                  \
    }

/* Sums over a plane are up to 256 samples: they just fit. */
#define DEFINE_INTEGER(T, P, S, suffix) \
    DEFINE_XY(T, P, suffix)             \
    DEFINE_Z_INTEGER(T, P, S, suffix)

#ifdef SIMD_NAME
DEFINE_INSIDE_INTEGER(uint8_t, uint16_t, uint16_t, few_u8)
DEFINE_INSIDE_INTEGER(int8_t, int16_t, uint16_t, few_i8)
DEFINE_INSIDE_BYTES(uint8_t, uint16_t, WEIGH_U8, u8)
DEFINE_INSIDE_BYTES(int8_t, int16_t, WEIGH_I8, i8)
#else
DEFINE_INSIDE_INTEGER(uint8_t, uint16_t, uint16_t, u8)
DEFINE_INSIDE_INTEGER(int8_t, int16_t, uint16_t, i8)
#endif
DEFINE_INSIDE_INTEGER(uint16_t, uint32_t, uint32_t, u16)
DEFINE_INSIDE_INTEGER(int16_t, int32_t, uint32_t, i16)

DEFINE_INTEGER(uint8_t, uint16_t, uint32_t, u8)
DEFINE_INTEGER(int8_t, int16_t, int32_t, i8)
DEFINE_INTEGER(uint16_t, uint32_t, uint32_t, u16)
DEFINE_INTEGER(int16_t, int32_t, int32_t, i16)
DEFINE_XY(float, double, f32)

static void z_f32(const void *const taps[PYRAMID_TAPS], void *to, uint32_t first, uint32_t end) {
    const double *a = taps[0], *b = taps[1], *c = taps[2], *d = taps[3], *e = taps[4];
    float *restrict samples = to;
    for (size_t i = first; i < end; i++) {
        const double sum = PYRAMID_WEIGH(double, a[i], b[i], c[i], d[i], e[i]);
        const float mean = (float)(sum / PYRAMID_WHOLE);
        const bool same = (a[i] == b[i]) & (b[i] == c[i]) & (c[i] == d[i]) & (d[i] == e[i]);
        samples[i] = same ? mean : pyramid_rows_shorten(mean);
    }
}

const pyramid_rows *PYRAMID_ROWS(sample_type type);
const pyramid_rows *PYRAMID_ROWS(sample_type type) {
    static const pyramid_rows rows[] = {
        [SAMPLE_U8] = {sizeof(uint16_t), x_u8, y_u8, z_u8},
        [SAMPLE_I8] = {sizeof(int16_t), x_i8, y_i8, z_i8},
        [SAMPLE_U16] = {sizeof(uint32_t), x_u16, y_u16, z_u16},
        [SAMPLE_I16] = {sizeof(int32_t), x_i16, y_i16, z_i16},
        [SAMPLE_F32] = {sizeof(double), x_f32, y_f32, z_f32},
    };
    return &rows[type];
}

#endif
