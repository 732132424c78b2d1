/* simd_wide.h - the words of formats/base/simd.h for eight doubles and sixteen floats with masks
 * of bits, as AVX-512 has them, in plain C.
 *
 * Takes the place of simd.h in front of a template, so that the template's way with vectors of that
 * width runs on any CPU; what is left to CPUs with AVX-512 is that the words mean what they say
 * there, which test_simd.c asks.
 */
#ifndef FORMATS_BASE_SIMD_H
#define FORMATS_BASE_SIMD_H
#ifndef TESTS_SUPPORT_SIMD_WIDE_H
#define TESTS_SUPPORT_SIMD_WIDE_H

#include <assert.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

#pragma GCC diagnostic ignored "-Wpsabi" /* vectors do not leave their file */

#define SIMD_NAME(f) f##_wide
#define SIMD         static inline __attribute__((always_inline))

enum { VD_N = 8, VF_N = 16 };
typedef double vd __attribute__((vector_size(8 * sizeof(double)), aligned(16)));
typedef uint8_t md;

#define LANES(i) for (int i = 0; i < VD_N; i++)

SIMD vd d_load(const double *from) {
    vd v;
    memcpy(&v, from, sizeof v);
    return v;
}
SIMD void d_store(double *to, vd a) {
    memcpy(to, &a, sizeof a);
}
SIMD vd d_set(double a) {
    return (vd){a, a, a, a, a, a, a, a};
}
enum { D_ROW = 4 };
SIMD vd d_load_rows(const double *from, int stride) {
    vd v;
    LANES(i) v[i] = from[i / 4 * stride + i % 4];
    return v;
}
SIMD vd d_load_at(const double *from, const uint16_t at[]) {
    vd v;
    LANES(i) v[i] = from[at[i]];
    return v;
}
SIMD void d_load_four(const double *from, int stride, const uint16_t at[], vd out[4]) {
    for (int k = 0; k < 4; k++)
        LANES(i) out[k][i] = from[stride * at[i] + k];
}
SIMD vd d_of_floats(const float *from) {
    vd v;
    LANES(i) v[i] = (double)from[i];
    return v;
}
SIMD vd d_select(md m, vd a, vd b) {
    LANES(i) b[i] = m >> i & 1 ? a[i] : b[i];
    return b;
}
SIMD vd d_min(vd a, vd b) {
    LANES(i) b[i] = a[i] < b[i] ? a[i] : b[i];
    return b;
}
SIMD vd d_max(vd a, vd b) {
    LANES(i) b[i] = a[i] > b[i] ? a[i] : b[i];
    return b;
}
SIMD vd d_sqrt(vd a) {
    LANES(i) a[i] = sqrt(a[i]);
    return a;
}
SIMD vd d_abs(vd a) {
    LANES(i) a[i] = fabs(a[i]);
    return a;
}
SIMD vd d_and_bits(vd a, uint64_t keep) {
    uint64_t bits[VD_N];
    memcpy(bits, &a, sizeof bits);
    LANES(i) bits[i] &= keep;
    memcpy(&a, bits, sizeof a);
    return a;
}
SIMD md md_of_bits(unsigned bits) {
    return (md)bits;
}
SIMD unsigned md_bits(md m) {
    return m;
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

#define COMPARISON(name, op)                            \
    SIMD md name(vd a, vd b) {                          \
        unsigned bits = 0;                              \
        LANES(i) bits |= (unsigned)(a[i] op b[i]) << i; \
        return (md)bits;                                \
    }
COMPARISON(d_lt, <)
COMPARISON(d_le, <=)
COMPARISON(d_eq, ==)
COMPARISON(d_ge, >=)
COMPARISON(d_gt, >)

typedef uint64_t vl __attribute__((vector_size(8 * sizeof(uint64_t)), aligned(16)));

SIMD vl l_set(uint64_t a) {
    return (vl){a, a, a, a, a, a, a, a};
}
SIMD vl l_load(const uint64_t *from) {
    vl v;
    memcpy(&v, from, sizeof v);
    return v;
}
SIMD void l_store(uint64_t *to, vl a) {
    memcpy(to, &a, sizeof a);
}
SIMD vd d_gather(const double *from, vl at) {
    vd v;
    LANES(i) v[i] = from[at[i]];
    return v;
}
SIMD vl l_gather(const void *from, vl at) {
    uint64_t v[VD_N];
    LANES(i) memcpy(&v[i], (const char *)from + at[i], sizeof *v);
    return l_load(v);
}
enum { D_TABLE = 32, D_LOOKS_UP = 1 };
SIMD vl l_of_shorts(const uint16_t *from) {
    vl v;
    LANES(i) v[i] = from[i];
    return v;
}
SIMD vd d_look_up_half(const double *from, vl at) {
    LANES(i) assert(at[i] < D_TABLE / 2);
    return d_gather(from, at);
}
SIMD vd d_look_up(const double *from, vl at) {
    LANES(i) assert(at[i] < D_TABLE);
    return d_gather(from, at);
}
SIMD void d_pack(double *to, vd a, unsigned bits) {
    double packed[VD_N] = {0.0};
    int n = 0;
    LANES(i) if (bits >> i & 1) packed[n++] = a[i];
    memcpy(to, packed, sizeof packed);
}
SIMD void l_pack(uint64_t *to, vl a, unsigned bits) {
    vd same;
    memcpy(&same, &a, sizeof same);
    d_pack((double *)(void *)to, same, bits);
}
SIMD vd d_reverse(vd a) {
    return (vd){a[7], a[6], a[5], a[4], a[3], a[2], a[1], a[0]};
}
SIMD vd d_of_low_floats(vl a) {
    vd v;
    LANES(i) {
        const uint32_t low = (uint32_t)a[i];
        float x;
        memcpy(&x, &low, sizeof x);
        v[i] = (double)x;
    }
    return v;
}
SIMD vl l_mul(vl a, vl b) {
    LANES(i) a[i] = (a[i] & 0xffffffffu) * (b[i] & 0xffffffffu);
    return a;
}
SIMD md l_eq(vl a, vl b) {
    unsigned bits = 0;
    LANES(i) bits |= (unsigned)(a[i] == b[i]) << i;
    return (md)bits;
}
SIMD unsigned l_odd(vl a) {
    unsigned bits = 0;
    LANES(i) bits |= (unsigned)(a[i] & 1u) << i;
    return bits;
}

typedef float vf __attribute__((vector_size(16 * sizeof(float)), aligned(16)));
typedef int32_t vi __attribute__((vector_size(16 * sizeof(int32_t)), aligned(16)));
typedef uint16_t mf;

#define FLOATS(i) for (int i = 0; i < VF_N; i++)

SIMD void d_store_floats(float *to, vd a) {
    LANES(i) to[i] = (float)a[i];
}
SIMD vf f_of_doubles(const double *from) {
    vf v;
    for (int i = 0; i < VF_N; i++)
        v[i] = (float)from[i];
    return v;
}
SIMD vf f_load(const float *from) {
    vf v;
    memcpy(&v, from, sizeof v);
    return v;
}
SIMD vf f_load_rows(const float *from, int stride) {
    vf v;
    FLOATS(i) v[i] = from[i / 4 * stride + i % 4];
    return v;
}
SIMD vf f_of_bytes(const uint8_t *from) {
    vf v;
    FLOATS(i) v[i] = i < 8 ? (float)from[i] : 0.0f;
    return v;
}
SIMD void f_load_triples(const float *from, const uint32_t at[], vf out[3]) {
    for (int a = 0; a < 3; a++)
        FLOATS(i) out[a][i] = from[3 * at[i] + (uint32_t)a];
}
SIMD void f_load_fours(const float *from, unsigned stride, const uint32_t at[], vf out[4]) {
    for (unsigned k = 0; k < 4; k++)
        FLOATS(i) out[k][i] = from[stride * at[i] + k];
}
SIMD vf f_look_up(const float from[4], vi at) {
    vf v;
    FLOATS(i) assert(at[i] >= 0 && at[i] < 4);
    FLOATS(i) v[i] = from[at[i]];
    return v;
}
SIMD vi i_set(uint32_t a) {
    vi v;
    FLOATS(i) v[i] = (int32_t)a;
    return v;
}
SIMD vi i_load(const uint32_t *from) {
    vi v;
    memcpy(&v, from, sizeof v);
    return v;
}
SIMD void i_store(uint32_t *to, vi a) {
    memcpy(to, &a, sizeof a);
}
SIMD void i_pack(uint32_t *to, vi a, unsigned bits) {
    uint32_t packed[VF_N] = {0};
    int n = 0;
    FLOATS(i) if (bits >> i & 1) packed[n++] = (uint32_t)a[i];
    memcpy(to, packed, sizeof packed);
}
SIMD vi i_gather(const void *from, vi at) {
    vi v;
    FLOATS(i) {
        int32_t a;
        memcpy(&a, (const char *)from + at[i], sizeof a);
        v[i] = a;
    }
    return v;
}
SIMD vi i_look_up_16(const uint32_t from[16], vi at) {
    vi v;
    FLOATS(i) v[i] = (int32_t)from[at[i]];
    return v;
}
SIMD vf f_swap(vf a, unsigned by) {
    vf v;
    FLOATS(i) v[i] = a[(unsigned)i ^ by];
    return v;
}
SIMD void f_store(float *to, vf a) {
    memcpy(to, &a, sizeof a);
}
SIMD void f_stream(float *to, vf a) {
    assert((uintptr_t)to % sizeof a == 0);
    f_store(to, a);
}
SIMD void f_stream_end(void) {}
SIMD vf f_set(float a) {
    vf v;
    FLOATS(i) v[i] = a;
    return v;
}
SIMD vf f_select(mf m, vf a, vf b) {
    FLOATS(i) a[i] = m >> i & 1 ? a[i] : b[i];
    return a;
}
SIMD vf f_min(vf a, vf b) {
    FLOATS(i) a[i] = a[i] < b[i] ? a[i] : b[i];
    return a;
}
SIMD vf f_max(vf a, vf b) {
    FLOATS(i) a[i] = a[i] > b[i] ? a[i] : b[i];
    return a;
}
SIMD vf f_sqrt(vf a) {
    FLOATS(i) a[i] = sqrtf(a[i]);
    return a;
}
SIMD vf f_abs(vf a) {
    FLOATS(i) a[i] = fabsf(a[i]);
    return a;
}
SIMD vf f_floor(vf a) {
    FLOATS(i) a[i] = floorf(a[i]);
    return a;
}
SIMD vf f_ceil(vf a) {
    FLOATS(i) a[i] = ceilf(a[i]);
    return a;
}
/* As good as the approximate one, and no better than it may be. */
SIMD vf f_reciprocal(vf a) {
    FLOATS(i) a[i] = 1.0f / a[i] * (1.0f + (i % 2 ? 0x1p-22f : -0x1p-22f));
    return a;
}
SIMD vi f_to_int(vf a) {
    vi v;
    FLOATS(i) v[i] = (int32_t)a[i];
    return v;
}
SIMD vf f_of_ints(vi a) {
    vf v;
    FLOATS(i) v[i] = (float)a[i];
    return v;
}
SIMD int i_any(vi a) {
    int any = 0;
    FLOATS(i) any |= a[i];
    return any != 0;
}
SIMD mf mf_of_bits(unsigned bits) {
    return (mf)bits;
}
SIMD unsigned mf_bits(mf m) {
    return m;
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

#define COMPARISON_F(name, op)                           \
    SIMD mf name(vf a, vf b) {                           \
        unsigned bits = 0;                               \
        FLOATS(i) bits |= (unsigned)(a[i] op b[i]) << i; \
        return (mf)bits;                                 \
    }
COMPARISON_F(f_lt, <)
COMPARISON_F(f_le, <=)
COMPARISON_F(f_eq, ==)
COMPARISON_F(f_ge, >=)
COMPARISON_F(f_gt, >)

#endif
#endif
