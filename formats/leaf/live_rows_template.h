/* live_rows_template.h - live_rows.h for one ISA, of which the compiler's flags decide. */
#ifndef FORMATS_LEAF_LIVE_ROWS_TEMPLATE_H
#define FORMATS_LEAF_LIVE_ROWS_TEMPLATE_H

#include <math.h>
#include <string.h>

#include "formats/base/simd_isa.h"
#include "formats/leaf/live_rows.h"

#ifdef SIMD_NAME
#define LIVE_ROWS SIMD_NAME(live_rows)
#else
#define LIVE_ROWS live_rows_scalar
#endif

/* Samples at once: rows go through the vectors of any ISA in pieces of so many, and the rest one by
 * one. */
enum { LIVE_SOME = 64 };

/* ---- Some samples ---- */

#define DEFINE_INTEGER(T, suffix, least, most)                                           \
    static void begin_##suffix(live_extent *e, size_t count) {                           \
        T *restrict lo = (T *)e->lo, *restrict hi = (T *)e->hi;                          \
        for (size_t i = 0; i < count; i++) {                                             \
            lo[i] = (most);                                                              \
            hi[i] = (least);                                                             \
        }                                                                                \
    }                                                                                    \
    static inline void some_##suffix(T *restrict lo, T *restrict hi, uint32_t *bad,      \
                                     const T *restrict v, size_t count) {                \
        (void)bad;                                                                       \
        for (size_t i = 0; i < count; i++) {                                             \
            lo[i] = v[i] < lo[i] ? v[i] : lo[i];                                         \
            hi[i] = v[i] > hi[i] ? v[i] : hi[i];                                         \
        }                                                                                \
    }                                                                                    \
    static live_range range_##suffix(const live_extent *e, size_t first, size_t count) { \
        const T *lo = (const T *)e->lo + first, *hi = (const T *)e->hi + first;          \
        T a = (most), b = (least);                                                       \
        for (size_t i = 0; i < count; i++) {                                             \
            a = lo[i] < a ? lo[i] : a;                                                   \
            b = hi[i] > b ? hi[i] : b;                                                   \
        }                                                                                \
        return (live_range){(float)a, (float)b, false};                                  \
    }

DEFINE_INTEGER(uint8_t, u8, 0, UINT8_MAX)
DEFINE_INTEGER(int8_t, i8, INT8_MIN, INT8_MAX)
DEFINE_INTEGER(uint16_t, u16, 0, UINT16_MAX)
DEFINE_INTEGER(int16_t, i16, INT16_MIN, INT16_MAX)

static void begin_f32(live_extent *e, size_t count) {
    float *restrict lo = (float *)e->lo, *restrict hi = (float *)e->hi;
    for (size_t i = 0; i < count; i++) {
        lo[i] = INFINITY;
        hi[i] = -INFINITY;
        e->bad[i] = 0;
    }
}

static inline void some_f32(float *restrict lo, float *restrict hi, uint32_t *restrict bad,
                            const float *restrict v, size_t count) {
    for (size_t i = 0; i < count; i++) {
        const bool finite = fabsf(v[i]) < INFINITY;
        const float below = finite ? v[i] : INFINITY, above = finite ? v[i] : -INFINITY;
        lo[i] = below < lo[i] ? below : lo[i];
        hi[i] = above > hi[i] ? above : hi[i];
        bad[i] |= finite ? 0u : 1u;
    }
}

static live_range range_f32(const live_extent *e, size_t first, size_t count) {
    const float *lo = (const float *)e->lo, *hi = (const float *)e->hi;
    live_range r = {INFINITY, -INFINITY, false};
    for (size_t i = first; i < first + count; i++) {
        r.lo = lo[i] < r.lo ? lo[i] : r.lo;
        r.hi = hi[i] > r.hi ? hi[i] : r.hi;
        r.bad |= e->bad[i] != 0;
    }
    return r;
}

/* ---- Rows ---- */

/* part: what compilers put in the place of a call of memcpy() whose size they know took up to twice
 * as long, and so did calls for whole rows of 1 KiB (tests/measurements/loading.md). */
static void copy_parts(char *to, const char *from, size_t bytes, size_t part) {
    for (; bytes > part; bytes -= part, to += part, from += part)
        memcpy(to, from, part);
    memcpy(to, from, bytes);
}

#define DEFINE_ROWS(T, suffix)                                                           \
    static void widen_##suffix(live_extent *e, const void *row, size_t count) {          \
        T *lo = (T *)e->lo, *hi = (T *)e->hi;                                            \
        const T *v = row;                                                                \
        size_t i = 0;                                                                    \
        for (; i + LIVE_SOME <= count; i += LIVE_SOME)                                   \
            some_##suffix(lo + i, hi + i, e->bad + i, v + i, LIVE_SOME);                 \
        some_##suffix(lo + i, hi + i, e->bad + i, v + i, count - i);                     \
    }                                                                                    \
    static void copy_##suffix(live_extent *e, const void *row, void *to, size_t count) { \
        copy_parts(to, row, count * sizeof(T), e->part);                                 \
        widen_##suffix(e, row, count);                                                   \
    }

DEFINE_ROWS(uint8_t, u8)
DEFINE_ROWS(int8_t, i8)
DEFINE_ROWS(uint16_t, u16)
DEFINE_ROWS(int16_t, i16)
DEFINE_ROWS(float, f32)

const live_rows *LIVE_ROWS(sample_type type);
const live_rows *LIVE_ROWS(sample_type type) {
    static const live_rows rows[] = {
        [SAMPLE_U8] = {begin_u8, widen_u8, copy_u8, range_u8},
        [SAMPLE_I8] = {begin_i8, widen_i8, copy_i8, range_i8},
        [SAMPLE_U16] = {begin_u16, widen_u16, copy_u16, range_u16},
        [SAMPLE_I16] = {begin_i16, widen_i16, copy_i16, range_i16},
        [SAMPLE_F32] = {begin_f32, widen_f32, copy_f32, range_f32},
    };
    return &rows[type];
}

#endif
