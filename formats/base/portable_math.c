#include "formats/base/portable_math.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

_Static_assert(FLT_EVAL_METHOD == 0, "doubles must be evaluated as doubles");

/* Adding and taking away 1.5 * 2^52 rounds a double below 2^51 to the nearest whole number. */
static const double ROUNDER = PORTABLE_ROUNDER;

/* Taylor series about 0 for |a| <= pi / 4. The first omitted term is below 2^-57 of the result. */
static double sine_series(double a) {
    double z = a * a;
    double p = -1.0 / 1307674368000.0;
    p = p * z + 1.0 / 6227020800.0;
    p = p * z - 1.0 / 39916800.0;
    p = p * z + 1.0 / 362880.0;
    p = p * z - 1.0 / 5040.0;
    p = p * z + 1.0 / 120.0;
    p = p * z - 1.0 / 6.0;
    return a + a * (z * p);
}

static double cosine_series(double a) {
    double z = a * a;
    double p = 1.0 / 20922789888000.0;
    p = p * z - 1.0 / 87178291200.0;
    p = p * z + 1.0 / 479001600.0;
    p = p * z - 1.0 / 3628800.0;
    p = p * z + 1.0 / 40320.0;
    p = p * z - 1.0 / 720.0;
    p = p * z + 1.0 / 24.0;
    /* 1 - z / 2 loses a bit, which its remainder restores. */
    double half = 0.5 * z, head = 1 - half;
    return head + (((1 - head) - half) + z * z * p);
}

void portable_sincos(double t, double *sine, double *cosine) {
    double rounded = 4 * t + ROUNDER;
    double quarter = rounded - ROUNDER;
    /* Exact: t and quarter / 4 are close, and both are multiples of t's last bit. */
    double rest = t - 0.25 * quarter;
    double a = rest * 6.283185307179586;
    double s = sine_series(a), c = cosine_series(a);
    int64_t q = (int64_t)quarter;
    *sine = q & 1 ? c : s;
    *cosine = q & 1 ? s : c;
    if (q & 2)
        *sine = -*sine;
    if ((q + 1) & 2)
        *cosine = -*cosine;
}

double portable_sin(double t) {
    double s, c;
    portable_sincos(t, &s, &c);
    return s;
}

double portable_cos(double t) {
    double s, c;
    portable_sincos(t, &s, &c);
    return c;
}

/* The angle of (1, q), 0 <= q <= 1, in turns: the angle of the nearest eighth from a table, and the
 * rest by a series. Its first omitted term is below 2^-60. */
static double angle_of_slope(double q) {
    static const double EIGHTHS[9] = {0x0.0p+0,
                                      0x1.4444750777668p-6,
                                      0x1.3f670b6bdc73dp-5,
                                      0x1.d3c3a482f3ab5p-5,
                                      0x1.2e4051d9df308p-4,
                                      0x1.6c266f6edfc1ep-4,
                                      0x1.a37f5c4c419efp-4,
                                      0x1.d49ab3ac8b1bbp-4,
                                      0x1.0000000000000p-3};
    const int k = (int)(8.0 * q + 0.5);
    const double c = k / 8.0, r = (q - c) / (1.0 + q * c), z = r * r;
    double p = -1.0 / 11.0;
    p = p * z + 1.0 / 9.0;
    p = p * z - 1.0 / 7.0;
    p = p * z + 1.0 / 5.0;
    p = p * z - 1.0 / 3.0;
    return EIGHTHS[k] + (r + r * (z * p)) * 0.15915494309189535;
}

double portable_angle(double y, double x) {
    const double across = fabs(x), up = fabs(y);
    if (!(across > 0.0) && !(up > 0.0))
        return 0.0;
    double turns = up <= across ? angle_of_slope(up / across) : 0.25 - angle_of_slope(across / up);
    turns = x < 0.0 ? 0.5 - turns : turns;
    return y < 0.0 ? -turns : turns;
}

double portable_exp(double x) {
    assert(x <= 700);
    if (x < -700)
        return 0;
    static const double series[] = PORTABLE_EXP_SERIES;
    double rounded = x * PORTABLE_LOG2_E + PORTABLE_ROUNDER;
    double n = rounded - PORTABLE_ROUNDER;
    double r = (x - n * PORTABLE_LN2_HIGH) - n * PORTABLE_LN2_LOW;
    double p = series[0];
    for (size_t i = 1; i < sizeof series / sizeof *series; i++)
        p = p * r + series[i];
    double value = 1 + (r + r * r * p);
    uint64_t bits = (uint64_t)((int64_t)n + 1023) << 52;
    double scale;
    memcpy(&scale, &bits, sizeof scale);
    return value * scale;
}

double portable_log(double x) {
    int exponent;
    assert(x > 0.0 && x <= DBL_MAX);
    double m = frexp(x, &exponent);
    if (m < 0.7071067811865476) {
        m *= 2.0;
        exponent--;
    }
    /* ln m = 2 artanh s, |s| <= 0.1716. */
    const double s = (m - 1.0) / (m + 1.0), z = s * s;
    double p = 0.0;
    for (int k = 25; k >= 3; k -= 2)
        p = p * z + 1.0 / k;
    const double rest = 2.0 * s + 2.0 * s * (z * p), n = exponent;
    return n * PORTABLE_LN2_HIGH + (rest + n * PORTABLE_LN2_LOW);
}
