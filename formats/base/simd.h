/* simd.h - one vocabulary of vectors for SSE4.2, AVX2 and AVX-512; the kernels' templates use it.
 *
 * Only translation units of an ISA (x_sse42.c, x_avx2.c, x_avx512.c) include it to any effect; a
 * template is a file that such units include. SIMD_NAME(f) gives a function its own name in each.
 *
 *   vd, md   VD_N doubles (2, 4, 8) and a mask over them       d_set d_load d_store ...
 *   vf, mf   VF_N floats (4, 8, 16) and a mask over them       f_set f_load f_store ...
 *   vi       VF_N 32-bit integers, for operators and a few words  i_set i_load i_store ...
 *   vl       VD_N 64-bit integers, likewise, and a few words  l_set l_load l_store ...
 *
 * Loads, with lane k: f_load_rows(): VF_N / 4 rows of four floats, `stride` apart.
 * f_load_triples(): the three floats from + 3 at[k], and nothing behind them. f_load_fours(): four
 * floats from + stride at[k]. f_look_up(): from[at[k]] of four. d_load_rows(): VD_N / D_ROW rows of
 * D_ROW doubles. d_load_at(), d_gather(): from[at[k]]. d_load_four(): four doubles from + stride
 * at[k]. i_gather(): the 4 bytes at from + at[k], at any address. i_look_up_16(): from[at[k]]
 * of 16. d_look_up(): d_gather() from a table, all D_TABLE doubles of which may be read;
 * d_look_up_half(): from one of half the size. Both are useful where D_LOOKS_UP. l_of_shorts():
 * VD_N 16-bit numbers. l_gather(): the 8 bytes at from + at[k], at any address. f_of_bytes(): VF_N
 * bytes, but eight at most and zeros.
 * Others: d_reverse(): lane 0 last. d_of_low_floats(): the float in each lane's lower half.
 * l_mul(): the product of lower halves. l_eq(): lanes that are equal. l_odd(): lanes with bit 0
 * set, as bits. d_pack(), l_pack(), i_pack(): store the lanes that have a bit, one behind the
 * other; the rest of that vector may be overwritten with any lanes or zeros. f_swap(): exchange
 * lanes k and k ^ by; by is 1, 2, 4 or 8, less than VF_N.
 *
 * simd_isa.h has the types, and the words that each ISA spells for itself. Arithmetic is written
 * with + - * /, which compilers know for vectors. min(a, b) is a < b ? a : b and max(a, b) is a > b
 * ? a : b, also for NaN. Comparisons with NaN are false. Loads and stores take any address. Nothing
 * is fused or approximated, except in f_reciprocal().
 */
#ifndef FORMATS_BASE_SIMD_H
#define FORMATS_BASE_SIMD_H

#include <string.h>

#include "formats/base/simd_isa.h"

#ifdef SIMD_NAME

SIMD vd d_set(double a) {
    return D_(set1)(a);
}
SIMD vd d_load(const double *from) {
    return D_(loadu)(from);
}
SIMD void d_store(double *to, vd a) {
    D_(storeu)(to, a);
}
SIMD vd d_min(vd a, vd b) {
    return D_(min)(a, b);
}
SIMD vd d_max(vd a, vd b) {
    return D_(max)(a, b);
}
SIMD vd d_sqrt(vd a) {
    return D_(sqrt)(a);
}
SIMD vd d_ceil(vd a) {
    return D_(ceil)(a);
}
SIMD vd d_abs(vd a) {
    return d_and_bits(a, UINT64_C(0x7fffffffffffffff));
}
SIMD vf f_set(float a) {
    return F_(set1)(a);
}
SIMD vf f_load(const float *from) {
    return F_(loadu)(from);
}
SIMD void f_store(float *to, vf a) {
    F_(storeu)(to, a);
}
/* Store past the caches, for data that nobody reads soon. `to`: aligned like a vector. Call
 * f_stream_end() before other threads may read it. */
SIMD void f_stream(float *to, vf a) {
    F_(stream)(to, a);
}
SIMD void f_stream_end(void) {
    _mm_sfence();
}
SIMD vf f_min(vf a, vf b) {
    return F_(min)(a, b);
}
SIMD vf f_max(vf a, vf b) {
    return F_(max)(a, b);
}
SIMD vf f_sqrt(vf a) {
    return F_(sqrt)(a);
}
SIMD vf f_abs(vf a) {
    return f_and_bits(a, 0x7fffffffu);
}

#ifdef D_CMP_
SIMD md d_lt(vd a, vd b) {
    return D_CMP_(a, b, _CMP_LT_OQ);
}
SIMD md d_le(vd a, vd b) {
    return D_CMP_(a, b, _CMP_LE_OQ);
}
SIMD md d_eq(vd a, vd b) {
    return D_CMP_(a, b, _CMP_EQ_OQ);
}
SIMD mf f_lt(vf a, vf b) {
    return F_CMP_(a, b, _CMP_LT_OQ);
}
SIMD mf f_le(vf a, vf b) {
    return F_CMP_(a, b, _CMP_LE_OQ);
}
SIMD mf f_eq(vf a, vf b) {
    return F_CMP_(a, b, _CMP_EQ_OQ);
}
#else
SIMD md d_lt(vd a, vd b) {
    return D_(cmplt)(a, b);
}
SIMD md d_le(vd a, vd b) {
    return D_(cmple)(a, b);
}
SIMD md d_eq(vd a, vd b) {
    return D_(cmpeq)(a, b);
}
SIMD mf f_lt(vf a, vf b) {
    return F_(cmplt)(a, b);
}
SIMD mf f_le(vf a, vf b) {
    return F_(cmple)(a, b);
}
SIMD mf f_eq(vf a, vf b) {
    return F_(cmpeq)(a, b);
}
#endif
SIMD md d_ge(vd a, vd b) {
    return d_le(b, a);
}
SIMD md d_gt(vd a, vd b) {
    return d_lt(b, a);
}
SIMD mf f_ge(vf a, vf b) {
    return f_le(b, a);
}
SIMD mf f_gt(vf a, vf b) {
    return f_lt(b, a);
}

SIMD void f_load_fours(const float *from, unsigned stride, const uint32_t at[], vf out[4]) {
    vf row[4];
    for (int k = 0; k < 4; k++)
        row[k] = f_row_of_four_(from, stride, at, k);
    const vf low = F_(unpacklo)(row[0], row[1]), low2 = F_(unpacklo)(row[2], row[3]);
    const vf high = F_(unpackhi)(row[0], row[1]), high2 = F_(unpackhi)(row[2], row[3]);
    out[0] = F_(shuffle)(low, low2, 0x44);
    out[1] = F_(shuffle)(low, low2, 0xee);
    out[2] = F_(shuffle)(high, high2, 0x44);
    out[3] = F_(shuffle)(high, high2, 0xee);
}

typedef int32_t vi __attribute__((vector_size(sizeof(vf))));

SIMD vi i_set(uint32_t a) {
    return (vi){0} + (int32_t)a;
}
SIMD vi i_load(const uint32_t *from) {
    return (vi)f_load((const float *)(const void *)from);
}
SIMD void i_store(uint32_t *to, vi a) {
    f_store((float *)(void *)to, (vf)a);
}

/* Whether any bit of a is set. */
SIMD int i_any(vi a) {
#if defined __AVX512F__
    return _mm512_test_epi32_mask((__m512i)a, (__m512i)a) != 0;
#elif defined __AVX2__
    return !_mm256_testz_si256((__m256i)a, (__m256i)a);
#else
    return !_mm_testz_si128((__m128i)a, (__m128i)a);
#endif
}

SIMD int i_at_(const char *from, int32_t at) {
    int a;
    memcpy(&a, from + at, sizeof a);
    return a;
}
SIMD __m128i i_row_at_(const char *from, const int32_t at[4]) {
    return _mm_set_epi32(i_at_(from, at[3]), i_at_(from, at[2]), i_at_(from, at[1]),
                         i_at_(from, at[0]));
}
/* One by one: the gathers of CPUs are no faster where that was measured (Zen 4). */
SIMD vi i_gather(const void *from, vi at) {
    int32_t i[VF_N];
    memcpy(i, &at, sizeof i);
#if defined __AVX512F__
    const __m256i low = _mm256_set_m128i(i_row_at_(from, i + 4), i_row_at_(from, i));
    const __m256i high = _mm256_set_m128i(i_row_at_(from, i + 12), i_row_at_(from, i + 8));
    return (vi)_mm512_inserti64x4(_mm512_castsi256_si512(low), high, 1);
#elif defined __AVX2__
    return (vi)_mm256_set_m128i(i_row_at_(from, i + 4), i_row_at_(from, i));
#else
    return (vi)i_row_at_(from, i);
#endif
}

SIMD vi i_look_up_16(const uint32_t from[16], vi at) {
#if defined __AVX512F__
    return (vi)_mm512_permutexvar_epi32((__m512i)at, (__m512i)i_load(from));
#elif defined __AVX2__
    const __m256i low = _mm256_permutevar8x32_epi32((__m256i)i_load(from), (__m256i)at);
    const __m256i high = _mm256_permutevar8x32_epi32((__m256i)i_load(from + 8), (__m256i)at);
    return (vi)_mm256_blendv_ps((__m256)low, (__m256)high, (__m256)(at << 28));
#else
    return i_gather(from, at << 2);
#endif
}

typedef uint64_t vl __attribute__((vector_size(sizeof(vd))));

SIMD vl l_set(uint64_t a) {
    return (vl){0} + a;
}
SIMD vl l_load(const uint64_t *from) {
    return (vl)d_load((const double *)(const void *)from);
}
SIMD void l_store(uint64_t *to, vl a) {
    d_store((double *)(void *)to, (vd)a);
}

enum { D_TABLE = 32 };

#if defined __AVX512F__
enum { D_LOOKS_UP = 1 };
SIMD vf f_look_up(const float from[4], vi at) {
    return _mm512_permutexvar_ps((__m512i)at, _mm512_broadcast_f32x4(_mm_loadu_ps(from)));
}
SIMD void i_pack(uint32_t *to, vi a, unsigned bits) {
    i_store(to, (vi)_mm512_maskz_compress_epi32((__mmask16)bits, (__m512i)a));
}
SIMD vd d_gather(const double *from, vl at) {
    return _mm512_i64gather_pd((__m512i)at, from, 8);
}
/* Gathers would take five times as long. */
SIMD vd d_look_up_half(const double *from, vl at) {
    return _mm512_permutex2var_pd(d_load(from), (__m512i)at, d_load(from + 8));
}
SIMD vd d_look_up(const double *from, vl at) {
    const md upper = _mm512_test_epi64_mask((__m512i)at, _mm512_set1_epi64(D_TABLE / 2));
    return d_select(upper, d_look_up_half(from + D_TABLE / 2, at), d_look_up_half(from, at));
}
SIMD vl l_of_shorts(const uint16_t *from) {
    return (vl)_mm512_cvtepu16_epi64(_mm_loadu_si128((const __m128i *)(const void *)from));
}
SIMD void d_pack(double *to, vd a, unsigned bits) {
    d_store(to, _mm512_maskz_compress_pd((__mmask8)bits, a));
}
SIMD vl l_gather(const void *from, vl at) {
    return (vl)_mm512_i64gather_epi64((__m512i)at, from, 1);
}
SIMD vd d_reverse(vd a) {
    return _mm512_permutexvar_pd(_mm512_set_epi64(0, 1, 2, 3, 4, 5, 6, 7), a);
}
SIMD vd d_of_low_floats(vl a) {
    return _mm512_cvtps_pd(_mm256_castsi256_ps(_mm512_cvtepi64_epi32((__m512i)a)));
}
SIMD vl l_mul(vl a, vl b) {
    return (vl)_mm512_mul_epu32((__m512i)a, (__m512i)b);
}
SIMD md l_eq(vl a, vl b) {
    return _mm512_cmpeq_epi64_mask((__m512i)a, (__m512i)b);
}
SIMD unsigned l_odd(vl a) {
    return _mm512_test_epi64_mask((__m512i)a, _mm512_set1_epi64(1));
}
#elif defined __AVX2__
SIMD vf f_look_up(const float from[4], vi at) {
    return _mm256_permutevar8x32_ps(_mm256_broadcast_ps((const __m128 *)(const void *)from),
                                    (__m256i)at);
}
SIMD vd d_gather(const double *from, vl at) {
    return _mm256_i64gather_pd(from, (__m256i)at, 8);
}
SIMD vl l_gather(const void *from, vl at) {
    return (vl)_mm256_i64gather_epi64(from, (__m256i)at, 1);
}
SIMD vd d_reverse(vd a) {
    return _mm256_permute4x64_pd(a, 0x1b);
}
SIMD vd d_of_low_floats(vl a) {
    const __m256i low =
        _mm256_permutevar8x32_epi32((__m256i)a, _mm256_set_epi32(0, 0, 0, 0, 6, 4, 2, 0));
    return _mm256_cvtps_pd(_mm_castsi128_ps(_mm256_castsi256_si128(low)));
}
SIMD vl l_mul(vl a, vl b) {
    return (vl)_mm256_mul_epu32((__m256i)a, (__m256i)b);
}
SIMD md l_eq(vl a, vl b) {
    return _mm256_castsi256_pd(_mm256_cmpeq_epi64((__m256i)a, (__m256i)b));
}
SIMD unsigned l_odd(vl a) {
    return (unsigned)_mm256_movemask_pd((__m256d)(a << 63));
}
#else
SIMD vf f_look_up(const float from[4], vi at) {
    return _mm_set_ps(from[at[3]], from[at[2]], from[at[1]], from[at[0]]);
}
SIMD vd d_gather(const double *from, vl at) {
    return _mm_set_pd(from[at[1]], from[at[0]]);
}
SIMD vl l_gather(const void *from, vl at) {
    const char *bytes = from;
    return (vl)_mm_unpacklo_epi64(_mm_loadl_epi64((const __m128i *)(const void *)(bytes + at[0])),
                                  _mm_loadl_epi64((const __m128i *)(const void *)(bytes + at[1])));
}
SIMD vd d_reverse(vd a) {
    return _mm_shuffle_pd(a, a, 1);
}
SIMD vd d_of_low_floats(vl a) {
    return _mm_cvtps_pd(_mm_castsi128_ps(_mm_shuffle_epi32((__m128i)a, 0x08)));
}
SIMD vl l_mul(vl a, vl b) {
    return (vl)_mm_mul_epu32((__m128i)a, (__m128i)b);
}
SIMD md l_eq(vl a, vl b) {
    return _mm_castsi128_pd(_mm_cmpeq_epi64((__m128i)a, (__m128i)b));
}
SIMD unsigned l_odd(vl a) {
    return (unsigned)_mm_movemask_pd((__m128d)(a << 63));
}
#endif

#if !defined __AVX512F__
enum { D_LOOKS_UP = 0 };
SIMD vl l_of_shorts(const uint16_t *from) {
    vl v;
    for (unsigned k = 0; k < VD_N; k++)
        v[k] = from[k];
    return v;
}
SIMD vd d_look_up_half(const double *from, vl at) {
    return d_gather(from, at);
}
SIMD vd d_look_up(const double *from, vl at) {
    return d_gather(from, at);
}

/* The bytes of the lanes of a row that have a bit, by the bits. */
#define LANE_(k) 4 * k, 4 * k + 1, 4 * k + 2, 4 * k + 3
static const uint8_t i_pack_order_[16][16] = {
    {0},
    {LANE_(0)},
    {LANE_(1)},
    {LANE_(0), LANE_(1)},
    {LANE_(2)},
    {LANE_(0), LANE_(2)},
    {LANE_(1), LANE_(2)},
    {LANE_(0), LANE_(1), LANE_(2)},
    {LANE_(3)},
    {LANE_(0), LANE_(3)},
    {LANE_(1), LANE_(3)},
    {LANE_(0), LANE_(1), LANE_(3)},
    {LANE_(2), LANE_(3)},
    {LANE_(0), LANE_(2), LANE_(3)},
    {LANE_(1), LANE_(2), LANE_(3)},
    {LANE_(0), LANE_(1), LANE_(2), LANE_(3)},
};
#undef LANE_

SIMD void i_pack_row_(uint32_t *to, __m128i row, unsigned bits) {
    const __m128i order = _mm_loadu_si128((const __m128i *)(const void *)i_pack_order_[bits]);
    _mm_storeu_si128((__m128i *)(void *)to, _mm_shuffle_epi8(row, order));
}

SIMD void i_pack(uint32_t *to, vi a, unsigned bits) {
#if defined __AVX2__
    i_pack_row_(to, _mm256_castsi256_si128((__m256i)a), bits & 15u);
    i_pack_row_(to + __builtin_popcount(bits & 15u), _mm256_extracti128_si256((__m256i)a, 1),
                bits >> 4 & 15u);
#else
    i_pack_row_(to, (__m128i)a, bits & 15u);
#endif
}
SIMD void d_pack(double *to, vd a, unsigned bits) {
    for (unsigned k = 0; k < VD_N; k++) {
        *to = a[k];
        to += bits >> k & 1u;
    }
}
#endif
SIMD void l_pack(uint64_t *to, vl a, unsigned bits) {
    d_pack((double *)(void *)to, (vd)a, bits);
}

/* Round towards zero; for numbers that fit. */
SIMD vi f_to_int(vf a) {
    return __builtin_convertvector(a, vi);
}
SIMD vf f_of_ints(vi a) {
    return __builtin_convertvector(a, vf);
}

/* 1 / a with a relative error of 2^-22, for a of ordinary size. CPUs differ: for conservative tests
 * only. */
SIMD vf f_reciprocal(vf a) {
    const vf x = f_reciprocal_near(a);
    return x + x * (f_set(1.0f) - a * x);
}

#endif
#endif
