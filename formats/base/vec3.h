/* vec3.h - vectors of three doubles.
 *
 * The same vectors give the same bits everywhere. An output may be an input only where the comment
 * says so.
 */
#ifndef FORMATS_BASE_VEC3_H
#define FORMATS_BASE_VEC3_H

#include <math.h>
#include <stdbool.h>

/* real_max(), real_min() - the greater, the less of two numbers; a, where b is NaN. As fmax() and
 * fmin(), which are calls. */
static inline double real_max(double a, double b) {
    return b > a ? b : a;
}
static inline double real_min(double a, double b) {
    return b < a ? b : a;
}

/* vec3_sub() - a - b; out may be a or b. */
static inline void vec3_sub(const double a[3], const double b[3], double out[3]) {
    for (int i = 0; i < 3; i++)
        out[i] = a[i] - b[i];
}

static inline double vec3_dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void vec3_cross(const double a[3], const double b[3], double out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* vec3_det() - a . (b x c): six times the volume of the tet that a, b and c span. */
static inline double vec3_det(const double a[3], const double b[3], const double c[3]) {
    double n[3];
    vec3_cross(b, c, n);
    return vec3_dot(a, n);
}

/* vec3_size() - |x| + |y| + |z|: rounding errors are measured relative to it. */
static inline double vec3_size(const double a[3]) {
    return fabs(a[0]) + fabs(a[1]) + fabs(a[2]);
}

/* vec3_length() - the length. Not for components near 1e-200 or 1e200, whose squares under- or
 * overflow. */
static inline double vec3_length(const double a[3]) {
    return sqrt(vec3_dot(a, a));
}

/* vec3_unit() - the unit vector along a; unit may be a. Any finite length will do, as a is scaled
 * first. Returns false, with unit untouched, for 0 and for infinite vectors; NaN components stay
 * NaN. */
static inline bool vec3_unit(const double a[3], double unit[3]) {
    double largest = 0.0;
    for (int i = 0; i < 3; i++)
        largest = fabs(a[i]) > largest ? fabs(a[i]) : largest;
    if (!(largest > 0.0 && largest < INFINITY))
        return false;
    for (int i = 0; i < 3; i++)
        unit[i] = a[i] / largest;
    const double length = vec3_length(unit);
    for (int i = 0; i < 3; i++)
        unit[i] /= length;
    return true;
}

#endif
