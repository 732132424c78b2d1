/* deviation_rows_template.h - deviation_rows.h for one ISA, of which the compiler's flags decide.
 */
#ifndef FORMATS_LEAF_DEVIATION_ROWS_TEMPLATE_H
#define FORMATS_LEAF_DEVIATION_ROWS_TEMPLATE_H

#include <float.h>
#include <math.h>
#include <string.h>

#include "formats/base/sample_pairs.h"
#include "formats/base/simd_isa.h"
#include "formats/leaf/deviation_rows.h"

#ifdef SIMD_NAME
#define DEVIATION_ROWS SIMD_NAME(deviation_rows)
#else
#define DEVIATION_ROWS deviation_rows_scalar
#endif

/* Compare all rows of a slice: BETWEEN interpolates between two coarse slices, MIX between two rows
 * of that. A: the type of the numbers. */
#define DEFINE_SLICE(T, A, name, BETWEEN, MIX, ROW)                                                \
    static void name(const deviation_slice *s, void *scratch, deviation_band *band) {              \
        const uint32_t width = s->nodes / 2 + 1, row = band->row;                                  \
        A *rows = scratch, *mixed = rows + DEVIATION_COARSE_ROWS * row;                            \
        A *most = (A *)(void *)band->most;                                                         \
        for (uint32_t y = 0; y <= s->rows / 2; y++)                                                \
            BETWEEN((const T *)s->coarse[0] + y * s->coarse_row,                                   \
                    (const T *)s->coarse[1] + y * s->coarse_row, s->weight_z, width,               \
                    rows + y * row);                                                               \
        for (uint32_t y = 0; y < s->rows; y++) {                                                   \
            const T *fine = (const T *)s->fine + y * s->fine_row;                                  \
            const A *coarse = rows + y / 2 * row;                                                  \
            if (y % 2) {                                                                           \
                MIX(coarse, coarse + row, s->weight[1] ? s->weight[1][y / 2] : 0.5, width, mixed); \
                coarse = mixed;                                                                    \
            }                                                                                      \
            if (y <= DEVIATION_BRICK)                                                              \
                ROW(fine, coarse, s->weight[0], s->nodes, most, most + row);                       \
            if (y >= DEVIATION_BRICK)                                                              \
                ROW(fine, coarse, s->weight[0], s->nodes, most + 2 * row, most + 3 * row);         \
        }                                                                                          \
    }

/* ---- In eighths: nodes lie on coarse ones or half way ---- */

#define DEFINE_EIGHTHS(T, A, W, suffix)                                                   \
    static void between_##suffix(const T *restrict a, const T *restrict b, double weight, \
                                 uint32_t count, A *restrict out) {                       \
        (void)weight; /* a is b, or half way to it */                                     \
        for (uint32_t i = 0; i < count; i++)                                              \
            out[i] = (A)(4 * (a[i] + b[i]));                                              \
    }                                                                                     \
    static void mix_##suffix(const A *restrict a, const A *restrict b, double weight,     \
                             uint32_t count, A *restrict out) {                           \
        (void)weight;                                                                     \
        for (uint32_t i = 0; i < count; i++)                                              \
            out[i] = (A)((A)(a[i] + b[i]) >> 1); /* exact: the sum is even */             \
    }                                                                                     \
    static inline A farther_##suffix(A most, A fine, A coarse) {                          \
        const A off = (A)(8 * fine - coarse), x = (A)(off < 0 ? -off : off);              \
        return x > most ? x : most;                                                       \
    }                                                                                     \
    static void row_##suffix(const T *restrict fine, const A *restrict coarse,            \
                             const double *weight, uint32_t nodes, A *restrict even,      \
                             A *restrict odd) {                                           \
        (void)weight;                                                                     \
        for (size_t i = 0; i < nodes / 2; i++) {                                          \
            W pair;                                                                       \
            memcpy(&pair, fine + 2 * i, sizeof pair);                                     \
            even[i] = farther_##suffix(even[i], PAIR_FIRST(T, A, pair), coarse[i]);       \
            odd[i] = farther_##suffix(odd[i], PAIR_SECOND(T, A, pair),                    \
                                      (A)((A)(coarse[i] + coarse[i + 1]) >> 1));          \
        }                                                                                 \
        if (nodes % 2)                                                                    \
            even[nodes / 2] =                                                             \
                farther_##suffix(even[nodes / 2], fine[nodes - 1], coarse[nodes / 2]);    \
    }                                                                                     \
    DEFINE_SLICE(T, A, slice_##suffix, between_##suffix, mix_##suffix, row_##suffix)

DEFINE_EIGHTHS(uint8_t, int16_t, uint16_t, u8)
DEFINE_EIGHTHS(int8_t, int16_t, uint16_t, i8)
DEFINE_EIGHTHS(uint16_t, int32_t, uint32_t, u16)
DEFINE_EIGHTHS(int16_t, int32_t, uint32_t, i16)

/* ---- In doubles ---- */

/* A difference that is not finite counts as infinite. */
static inline double farther(double most, double fine, double coarse) {
    const double off = fine - coarse, x = off < 0 ? -off : off;
    const double y = x <= DBL_MAX ? x : (double)INFINITY;
    return y > most ? y : most;
}

static void mix_f64(const double *restrict a, const double *restrict b, double weight,
                    uint32_t count, double *restrict out) {
    for (uint32_t i = 0; i < count; i++)
        out[i] = a[i] + weight * (b[i] - a[i]);
}

#define DEFINE_DOUBLES(T, suffix)                                                         \
    static void between_##suffix(const T *restrict a, const T *restrict b, double weight, \
                                 uint32_t count, double *restrict out) {                  \
        for (size_t i = 0; i < count; i++)                                                \
            out[i] = (double)a[i] + weight * ((double)b[i] - (double)a[i]);               \
    }                                                                                     \
    static void row_##suffix(const T *restrict fine, const double *restrict coarse,       \
                             const double *weight, uint32_t nodes, double *restrict even, \
                             double *restrict odd) {                                      \
        for (size_t i = 0; i < (nodes + 1) / 2; i++)                                      \
            even[i] = farther(even[i], (double)fine[2 * i], coarse[i]);                   \
        for (size_t i = 0; i < nodes / 2; i++) {                                          \
            const double w = weight ? weight[i] : 0.5;                                    \
            const double at = coarse[i] + w * (coarse[i + 1] - coarse[i]);                \
            odd[i] = farther(odd[i], (double)fine[2 * i + 1], at);                        \
        }                                                                                 \
    }                                                                                     \
    DEFINE_SLICE(T, double, slice_##suffix, between_##suffix, mix_f64, row_##suffix)

DEFINE_DOUBLES(uint8_t, u8_weighted)
DEFINE_DOUBLES(int8_t, i8_weighted)
DEFINE_DOUBLES(uint16_t, u16_weighted)
DEFINE_DOUBLES(int16_t, i16_weighted)
DEFINE_DOUBLES(float, f32)

/* ---- The table ---- */

deviation_rows DEVIATION_ROWS(sample_type type, deviation_numbers numbers);
deviation_rows DEVIATION_ROWS(sample_type type, deviation_numbers numbers) {
    static const deviation_rows eighths[] = {[SAMPLE_U8] = slice_u8,
                                             [SAMPLE_I8] = slice_i8,
                                             [SAMPLE_U16] = slice_u16,
                                             [SAMPLE_I16] = slice_i16};
    static const deviation_rows doubles[] = {[SAMPLE_U8] = slice_u8_weighted,
                                             [SAMPLE_I8] = slice_i8_weighted,
                                             [SAMPLE_U16] = slice_u16_weighted,
                                             [SAMPLE_I16] = slice_i16_weighted,
                                             [SAMPLE_F32] = slice_f32};
    return numbers == DEVIATION_F64 ? doubles[type] : eighths[type];
}

#endif
