/* simd_isa.h - the types of simd.h, and those of its words that each ISA spells for itself. Include
 * simd.h, which says what the words do. */
#ifndef FORMATS_BASE_SIMD_ISA_H
#define FORMATS_BASE_SIMD_ISA_H

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

#endif
#endif
