/* simd_one.h - the words of simd.h for vectors of one double: a template that needs no more of them
 * is plain C where this takes the place of simd.h. Include it before the template.
 */
#ifndef FORMATS_BASE_SIMD_ONE_H
#define FORMATS_BASE_SIMD_ONE_H

#ifndef SIMD_NAME

#include <math.h>
#include <stdbool.h>

#define SIMD static inline

enum { VD_N = 1 };
typedef double vd;
typedef bool md;

SIMD vd d_set(double a) {
    return a;
}
SIMD vd d_abs(vd a) {
    return fabs(a);
}
SIMD vd d_min(vd a, vd b) {
    return a < b ? a : b;
}
SIMD vd d_max(vd a, vd b) {
    return a > b ? a : b;
}
SIMD vd d_sqrt(vd a) {
    return sqrt(a);
}
SIMD vd d_select(md m, vd a, vd b) {
    return m ? a : b;
}
SIMD md d_lt(vd a, vd b) {
    return a < b;
}
SIMD md d_le(vd a, vd b) {
    return a <= b;
}
SIMD md d_gt(vd a, vd b) {
    return a > b;
}
SIMD md md_and(md a, md b) {
    return a && b;
}
SIMD md md_or(md a, md b) {
    return a || b;
}
SIMD md md_xor(md a, md b) {
    return a != b;
}
SIMD md md_and_not(md a, md b) {
    return a && !b;
}
SIMD unsigned md_bits(md m) {
    return m;
}
SIMD md md_of_bits(unsigned bits) {
    return bits & 1u;
}

#endif
#endif
