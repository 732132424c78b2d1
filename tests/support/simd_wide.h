/* simd_wide.h - the words of formats/base/simd.h for eight doubles with masks of bits, as AVX-512
 * has them, in plain C.
 *
 * Takes the place of simd.h in front of a template, so that the template's way with vectors of that
 * width runs on any CPU; what is left to CPUs with AVX-512 is that the words mean what they say
 * there, which test_simd.c asks.
 */
#ifndef FORMATS_BASE_SIMD_H
#define FORMATS_BASE_SIMD_H
#ifndef TESTS_SUPPORT_SIMD_WIDE_H
#define TESTS_SUPPORT_SIMD_WIDE_H

#include <math.h>
#include <stdint.h>
#include <string.h>

#pragma GCC diagnostic ignored "-Wpsabi" /* vectors do not leave their file */

#define SIMD_NAME(f) f##_wide
#define SIMD         static inline __attribute__((always_inline))

enum { VD_N = 8 };
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

#endif
#endif
