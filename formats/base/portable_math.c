#include "formats/base/portable_math.h"

#include <assert.h>
#include <float.h>
#include <stdint.h>
#include <string.h>

_Static_assert(FLT_EVAL_METHOD == 0, "doubles must be evaluated as doubles");

/* Adding and taking away 1.5 * 2^52 rounds a double below 2^51 to the nearest whole number. */
static const double ROUNDER = PORTABLE_ROUNDER;

/* Taylor series about 0 for |a| <= pi / 4; the first terms left out are below 2^-57 of the result.
 */
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
    /* 1 - z / 2 loses a bit that its remainder brings back. */
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
