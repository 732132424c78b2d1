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
 * at[k]. d_look_up(): d_gather() from a table, all D_TABLE doubles of which may be read;
 * d_look_up_half(): from one of half the size. Both are useful where D_LOOKS_UP. l_of_shorts():
 * VD_N 16-bit numbers. l_gather(): the 8 bytes at from + at[k], at any address. f_of_bytes(): VF_N
 * bytes, but eight at most and zeros.
 * Others: d_reverse(): lane 0 last. d_of_low_floats(): the float in each lane's lower half.
 * l_mul(): the product of lower halves. l_eq(): lanes that are equal. l_odd(): lanes with bit 0
 * set, as bits. d_pack(), l_pack(), i_pack(): store the lanes that have a bit, one behind the
 * other; the rest of that vector may be overwritten with any lanes or zeros. f_swap(): exchange
 * lanes k and k ^ by; by is 1, 2, 4 or 8, less than VF_N.
 *
 * Arithmetic is written with + - * /, which compilers know for vectors. min(a, b) is a < b ? a : b
 * and max(a, b) is a > b ? a : b, also for NaN. Comparisons with NaN are false. Loads and stores
 * take any address. Nothing is fused or approximated, except in f_reciprocal().
 */
#ifndef FORMATS_BASE_SIMD_H
#define FORMATS_BASE_SIMD_H

#if defined __AVX512F__
#define SIMD_NAME(f) f##_avx512
#elif defined __AVX2__
#define SIMD_NAME(f) f##_avx2
#elif defined __SSE4_2__
#define SIMD_NAME(f) f##_sse42
#endif

#ifdef SIMD_NAME

#include <immintrin.h>
#include <stdint.h>

#define SIMD static inline __attribute__((always_inline))

/* Doubles of a row: four, or two where vectors hold no more. */
#if defined __AVX512F__ || defined __AVX2__
enum { D_ROW = 4 };
#else
enum { D_ROW = 2 };
#endif

/* Load three floats and a zero. */
SIMD __m128 triple_(const float *from) {
    return _mm_movelh_ps(_mm_castsi128_ps(_mm_loadl_epi64((const __m128i *)(const void *)from)),
                         _mm_load_ss(from + 2));
}

#if defined __AVX512F__

enum { VD_N = 8, VF_N = 16 };
typedef __m512d vd;
typedef __m512 vf;
typedef __mmask8 md;
typedef __mmask16 mf;
#define D_(op)            _mm512_##op##_pd
#define F_(op)            _mm512_##op##_ps
#define D_CMP_(a, b, how) _mm512_cmp_pd_mask(a, b, how)
#define F_CMP_(a, b, how) _mm512_cmp_ps_mask(a, b, how)

SIMD vd d_select(md m, vd a, vd b) {
    return _mm512_mask_blend_pd(m, b, a);
}
SIMD vf f_select(mf m, vf a, vf b) {
    return _mm512_mask_blend_ps(m, b, a);
}
SIMD md md_and(md a, md b) {
    return (md)(a & b);
}
SIMD md md_or(md a, md b) {
    return (md)(a | b);
}
SIMD md md_xor(md a, md b) {
    return (md)(a ^ b);
}
SIMD md md_and_not(md a, md b) {
    return (md)(a & ~b);
}
SIMD unsigned md_bits(md m) {
    return m;
}
SIMD md md_of_bits(unsigned bits) {
    return (md)bits;
}
SIMD mf mf_and(mf a, mf b) {
    return (mf)(a & b);
}
SIMD mf mf_or(mf a, mf b) {
    return (mf)(a | b);
}
SIMD mf mf_and_not(mf a, mf b) {
    return (mf)(a & ~b);
}
SIMD unsigned mf_bits(mf m) {
    return m;
}
SIMD mf mf_of_bits(unsigned bits) {
    return (mf)bits;
}
SIMD vf f_reciprocal_near(vf a) {
    return _mm512_rcp14_ps(a);
}
SIMD vf f_floor(vf a) {
    return _mm512_roundscale_ps(a, _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC);
}
SIMD vf f_ceil(vf a) {
    return _mm512_roundscale_ps(a, _MM_FROUND_TO_POS_INF | _MM_FROUND_NO_EXC);
}
SIMD vd d_and_bits(vd a, uint64_t bits) {
    return _mm512_and_pd(a, _mm512_castsi512_pd(_mm512_set1_epi64((int64_t)bits)));
}
SIMD vf f_and_bits(vf a, uint32_t bits) {
    return _mm512_and_ps(a, _mm512_castsi512_ps(_mm512_set1_epi32((int32_t)bits)));
}
SIMD vf f_of_doubles(const double *from) {
    return _mm512_insertf32x8(_mm512_castps256_ps512(_mm512_cvtpd_ps(_mm512_loadu_pd(from))),
                              _mm512_cvtpd_ps(_mm512_loadu_pd(from + 8)), 1);
}
SIMD vf f_load_rows(const float *from, int stride) {
    const __m256 low = _mm256_set_m128(_mm_loadu_ps(from + stride), _mm_loadu_ps(from));
    const __m256 high =
        _mm256_set_m128(_mm_loadu_ps(from + 3 * stride), _mm_loadu_ps(from + 2 * stride));
    return _mm512_insertf32x8(_mm512_castps256_ps512(low), high, 1);
}
SIMD void f_load_triples(const float *from, const uint32_t at[], vf out[3]) {
    vf row[4];
    for (int k = 0; k < 4; k++)
        row[k] = _mm512_insertf32x8(
            _mm512_castps256_ps512(
                _mm256_set_m128(triple_(from + 3 * at[k + 4]), triple_(from + 3 * at[k]))),
            _mm256_set_m128(triple_(from + 3 * at[k + 12]), triple_(from + 3 * at[k + 8])), 1);
    const vf low = _mm512_unpacklo_ps(row[0], row[1]), low2 = _mm512_unpacklo_ps(row[2], row[3]);
    const vf high = _mm512_unpackhi_ps(row[0], row[1]), high2 = _mm512_unpackhi_ps(row[2], row[3]);
    out[0] = _mm512_shuffle_ps(low, low2, 0x44);
    out[1] = _mm512_shuffle_ps(low, low2, 0xee);
    out[2] = _mm512_shuffle_ps(high, high2, 0x44);
}
SIMD vf f_row_of_four_(const float *from, unsigned stride, const uint32_t at[], int k) {
    return _mm512_insertf32x8(
        _mm512_castps256_ps512(_mm256_set_m128(_mm_loadu_ps(from + stride * at[k + 4]),
                                               _mm_loadu_ps(from + stride * at[k]))),
        _mm256_set_m128(_mm_loadu_ps(from + stride * at[k + 12]),
                        _mm_loadu_ps(from + stride * at[k + 8])),
        1);
}
SIMD vf f_of_bytes(const uint8_t *from) {
    return _mm512_cvtepi32_ps(
        _mm512_cvtepu8_epi32(_mm_loadl_epi64((const __m128i *)(const void *)from)));
}
SIMD vd d_load_rows(const double *from, int stride) {
    return _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_loadu_pd(from)),
                              _mm256_loadu_pd(from + stride), 1);
}
SIMD vd d_load_at(const double *from, const uint16_t at[]) {
    return _mm512_set_pd(from[at[7]], from[at[6]], from[at[5]], from[at[4]], from[at[3]],
                         from[at[2]], from[at[1]], from[at[0]]);
}
SIMD void d_load_four(const double *from, int stride, const uint16_t at[], vd out[4]) {
    vd row[4];
    for (int k = 0; k < 4; k++)
        row[k] = _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_loadu_pd(from + stride * at[k])),
                                    _mm256_loadu_pd(from + stride * at[k + 4]), 1);
    const vd even = _mm512_unpacklo_pd(row[0], row[1]), even2 = _mm512_unpacklo_pd(row[2], row[3]);
    const vd odd = _mm512_unpackhi_pd(row[0], row[1]), odd2 = _mm512_unpackhi_pd(row[2], row[3]);
    const __m512i low = _mm512_set_epi64(13, 12, 5, 4, 9, 8, 1, 0);
    const __m512i high = _mm512_set_epi64(15, 14, 7, 6, 11, 10, 3, 2);
    out[0] = _mm512_permutex2var_pd(even, low, even2);
    out[1] = _mm512_permutex2var_pd(odd, low, odd2);
    out[2] = _mm512_permutex2var_pd(even, high, even2);
    out[3] = _mm512_permutex2var_pd(odd, high, odd2);
}
SIMD vf f_swap(vf a, unsigned by) {
    return by == 1   ? _mm512_permute_ps(a, 0xb1)
           : by == 2 ? _mm512_permute_ps(a, 0x4e)
           : by == 4 ? _mm512_shuffle_f32x4(a, a, 0xb1)
                     : _mm512_shuffle_f32x4(a, a, 0x4e);
}
SIMD vd d_of_floats(const float *from) {
    return _mm512_cvtps_pd(_mm256_loadu_ps(from));
}
SIMD void d_store_floats(float *to, vd a) {
    _mm256_storeu_ps(to, _mm512_cvtpd_ps(a));
}

#elif defined __AVX2__

enum { VD_N = 4, VF_N = 8 };
typedef __m256d vd;
typedef __m256 vf;
typedef __m256d md;
typedef __m256 mf;
#define D_(op)            _mm256_##op##_pd
#define F_(op)            _mm256_##op##_ps
#define D_CMP_(a, b, how) _mm256_cmp_pd(a, b, how)
#define F_CMP_(a, b, how) _mm256_cmp_ps(a, b, how)

SIMD vd d_select(md m, vd a, vd b) {
    return _mm256_blendv_pd(b, a, m);
}
SIMD vf f_select(mf m, vf a, vf b) {
    return _mm256_blendv_ps(b, a, m);
}
SIMD md md_and(md a, md b) {
    return _mm256_and_pd(a, b);
}
SIMD md md_or(md a, md b) {
    return _mm256_or_pd(a, b);
}
SIMD md md_xor(md a, md b) {
    return _mm256_xor_pd(a, b);
}
SIMD md md_and_not(md a, md b) {
    return _mm256_andnot_pd(b, a);
}
SIMD unsigned md_bits(md m) {
    return (unsigned)_mm256_movemask_pd(m);
}
SIMD md md_of_bits(unsigned bits) {
    const __m256i one = _mm256_set_epi64x(8, 4, 2, 1);
    return _mm256_castsi256_pd(
        _mm256_cmpeq_epi64(_mm256_and_si256(_mm256_set1_epi64x((int64_t)bits), one), one));
}
SIMD mf mf_and(mf a, mf b) {
    return _mm256_and_ps(a, b);
}
SIMD mf mf_or(mf a, mf b) {
    return _mm256_or_ps(a, b);
}
SIMD mf mf_and_not(mf a, mf b) {
    return _mm256_andnot_ps(b, a);
}
SIMD unsigned mf_bits(mf m) {
    return (unsigned)_mm256_movemask_ps(m);
}
SIMD mf mf_of_bits(unsigned bits) {
    const __m256i one = _mm256_set_epi32(128, 64, 32, 16, 8, 4, 2, 1);
    return _mm256_castsi256_ps(
        _mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32((int32_t)bits), one), one));
}
SIMD vf f_reciprocal_near(vf a) {
    return _mm256_rcp_ps(a);
}
SIMD vf f_floor(vf a) {
    return _mm256_floor_ps(a);
}
SIMD vf f_ceil(vf a) {
    return _mm256_ceil_ps(a);
}
SIMD vd d_and_bits(vd a, uint64_t bits) {
    return _mm256_and_pd(a, _mm256_castsi256_pd(_mm256_set1_epi64x((int64_t)bits)));
}
SIMD vf f_and_bits(vf a, uint32_t bits) {
    return _mm256_and_ps(a, _mm256_castsi256_ps(_mm256_set1_epi32((int32_t)bits)));
}
SIMD vf f_of_doubles(const double *from) {
    return _mm256_set_m128(_mm256_cvtpd_ps(_mm256_loadu_pd(from + 4)),
                           _mm256_cvtpd_ps(_mm256_loadu_pd(from)));
}
SIMD vf f_load_rows(const float *from, int stride) {
    return _mm256_set_m128(_mm_loadu_ps(from + stride), _mm_loadu_ps(from));
}
SIMD void f_load_triples(const float *from, const uint32_t at[], vf out[3]) {
    vf row[4];
    for (int k = 0; k < 4; k++)
        row[k] = _mm256_set_m128(triple_(from + 3 * at[k + 4]), triple_(from + 3 * at[k]));
    const vf low = _mm256_unpacklo_ps(row[0], row[1]), low2 = _mm256_unpacklo_ps(row[2], row[3]);
    const vf high = _mm256_unpackhi_ps(row[0], row[1]), high2 = _mm256_unpackhi_ps(row[2], row[3]);
    out[0] = _mm256_shuffle_ps(low, low2, 0x44);
    out[1] = _mm256_shuffle_ps(low, low2, 0xee);
    out[2] = _mm256_shuffle_ps(high, high2, 0x44);
}
SIMD vf f_row_of_four_(const float *from, unsigned stride, const uint32_t at[], int k) {
    return _mm256_set_m128(_mm_loadu_ps(from + stride * at[k + 4]),
                           _mm_loadu_ps(from + stride * at[k]));
}
SIMD vf f_of_bytes(const uint8_t *from) {
    return _mm256_cvtepi32_ps(
        _mm256_cvtepu8_epi32(_mm_loadl_epi64((const __m128i *)(const void *)from)));
}
SIMD vd d_load_rows(const double *from, int stride) {
    (void)stride;
    return _mm256_loadu_pd(from);
}
SIMD vd d_load_at(const double *from, const uint16_t at[]) {
    return _mm256_set_pd(from[at[3]], from[at[2]], from[at[1]], from[at[0]]);
}
SIMD void d_load_four(const double *from, int stride, const uint16_t at[], vd out[4]) {
    vd row[4];
    for (int k = 0; k < 4; k++)
        row[k] = _mm256_loadu_pd(from + stride * at[k]);
    const vd even = _mm256_unpacklo_pd(row[0], row[1]), even2 = _mm256_unpacklo_pd(row[2], row[3]);
    const vd odd = _mm256_unpackhi_pd(row[0], row[1]), odd2 = _mm256_unpackhi_pd(row[2], row[3]);
    out[0] = _mm256_permute2f128_pd(even, even2, 0x20);
    out[1] = _mm256_permute2f128_pd(odd, odd2, 0x20);
    out[2] = _mm256_permute2f128_pd(even, even2, 0x31);
    out[3] = _mm256_permute2f128_pd(odd, odd2, 0x31);
}
SIMD vf f_swap(vf a, unsigned by) {
    return by == 1   ? _mm256_permute_ps(a, 0xb1)
           : by == 2 ? _mm256_permute_ps(a, 0x4e)
                     : _mm256_permute2f128_ps(a, a, 1);
}
SIMD vd d_of_floats(const float *from) {
    return _mm256_cvtps_pd(_mm_loadu_ps(from));
}
SIMD void d_store_floats(float *to, vd a) {
    _mm_storeu_ps(to, _mm256_cvtpd_ps(a));
}

#else

enum { VD_N = 2, VF_N = 4 };
typedef __m128d vd;
typedef __m128 vf;
typedef __m128d md;
typedef __m128 mf;
#define D_(op) _mm_##op##_pd
#define F_(op) _mm_##op##_ps

SIMD vd d_select(md m, vd a, vd b) {
    return _mm_blendv_pd(b, a, m);
}
SIMD vf f_select(mf m, vf a, vf b) {
    return _mm_blendv_ps(b, a, m);
}
SIMD md md_and(md a, md b) {
    return _mm_and_pd(a, b);
}
SIMD md md_or(md a, md b) {
    return _mm_or_pd(a, b);
}
SIMD md md_xor(md a, md b) {
    return _mm_xor_pd(a, b);
}
SIMD md md_and_not(md a, md b) {
    return _mm_andnot_pd(b, a);
}
SIMD unsigned md_bits(md m) {
    return (unsigned)_mm_movemask_pd(m);
}
SIMD md md_of_bits(unsigned bits) {
    const __m128i one = _mm_set_epi64x(2, 1);
    return _mm_castsi128_pd(
        _mm_cmpeq_epi64(_mm_and_si128(_mm_set1_epi64x((int64_t)bits), one), one));
}
SIMD mf mf_and(mf a, mf b) {
    return _mm_and_ps(a, b);
}
SIMD mf mf_or(mf a, mf b) {
    return _mm_or_ps(a, b);
}
SIMD mf mf_and_not(mf a, mf b) {
    return _mm_andnot_ps(b, a);
}
SIMD unsigned mf_bits(mf m) {
    return (unsigned)_mm_movemask_ps(m);
}
SIMD mf mf_of_bits(unsigned bits) {
    const __m128i one = _mm_set_epi32(8, 4, 2, 1);
    return _mm_castsi128_ps(
        _mm_cmpeq_epi32(_mm_and_si128(_mm_set1_epi32((int32_t)bits), one), one));
}
SIMD vf f_reciprocal_near(vf a) {
    return _mm_rcp_ps(a);
}
SIMD vf f_floor(vf a) {
    return _mm_floor_ps(a);
}
SIMD vf f_ceil(vf a) {
    return _mm_ceil_ps(a);
}
SIMD vd d_and_bits(vd a, uint64_t bits) {
    return _mm_and_pd(a, _mm_castsi128_pd(_mm_set1_epi64x((int64_t)bits)));
}
SIMD vf f_and_bits(vf a, uint32_t bits) {
    return _mm_and_ps(a, _mm_castsi128_ps(_mm_set1_epi32((int32_t)bits)));
}
SIMD vf f_of_doubles(const double *from) {
    return _mm_movelh_ps(_mm_cvtpd_ps(_mm_loadu_pd(from)), _mm_cvtpd_ps(_mm_loadu_pd(from + 2)));
}
SIMD vf f_load_rows(const float *from, int stride) {
    (void)stride;
    return _mm_loadu_ps(from);
}
SIMD void f_load_triples(const float *from, const uint32_t at[], vf out[3]) {
    vf row[4];
    for (int k = 0; k < 4; k++)
        row[k] = triple_(from + 3 * at[k]);
    const vf low = _mm_unpacklo_ps(row[0], row[1]), low2 = _mm_unpacklo_ps(row[2], row[3]);
    const vf high = _mm_unpackhi_ps(row[0], row[1]), high2 = _mm_unpackhi_ps(row[2], row[3]);
    out[0] = _mm_shuffle_ps(low, low2, 0x44);
    out[1] = _mm_shuffle_ps(low, low2, 0xee);
    out[2] = _mm_shuffle_ps(high, high2, 0x44);
}
SIMD vf f_row_of_four_(const float *from, unsigned stride, const uint32_t at[], int k) {
    return _mm_loadu_ps(from + stride * at[k]);
}
SIMD vf f_of_bytes(const uint8_t *from) {
    return _mm_cvtepi32_ps(_mm_cvtepu8_epi32(_mm_cvtsi32_si128(
        from[0] | from[1] << 8 | from[2] << 16 | (int)((uint32_t)from[3] << 24))));
}
SIMD vd d_load_rows(const double *from, int stride) {
    (void)stride;
    return _mm_loadu_pd(from);
}
SIMD vd d_load_at(const double *from, const uint16_t at[]) {
    return _mm_set_pd(from[at[1]], from[at[0]]);
}
SIMD void d_load_four(const double *from, int stride, const uint16_t at[], vd out[4]) {
    for (int k = 0; k < 4; k += 2) {
        const vd row = _mm_loadu_pd(from + stride * at[0] + k);
        const vd row2 = _mm_loadu_pd(from + stride * at[1] + k);
        out[k] = _mm_unpacklo_pd(row, row2);
        out[k + 1] = _mm_unpackhi_pd(row, row2);
    }
}
SIMD vf f_swap(vf a, unsigned by) {
    return by == 1 ? _mm_shuffle_ps(a, a, 0xb1) : _mm_shuffle_ps(a, a, 0x4e);
}
SIMD vd d_of_floats(const float *from) {
    return _mm_cvtps_pd(_mm_castsi128_ps(_mm_loadl_epi64((const __m128i *)from)));
}
SIMD void d_store_floats(float *to, vd a) {
    _mm_storel_pi((__m64 *)to, _mm_cvtpd_ps(a));
}

#endif

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
SIMD void i_pack(uint32_t *to, vi a, unsigned bits) {
    for (; bits; bits &= bits - 1)
        *to++ = (uint32_t)a[__builtin_ctz(bits)];
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

/* 1 / a with a relative error of 2^-22, for a of ordinary size. CPUs differ: for conservative tests
 * only. */
SIMD vf f_reciprocal(vf a) {
    const vf x = f_reciprocal_near(a);
    return x + x * (f_set(1.0f) - a * x);
}

#endif
#endif
