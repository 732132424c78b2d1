/* portable_math.h - sine, cosine, angle, exponential and logarithm with the same bits on every
 * machine.
 *
 * The results of libm differ between versions and CPUs. These functions use only + - * /, in a
 * fixed order, in IEEE doubles; the build forbids contraction to FMA. Errors, measured against long
 * double libm by tests/formats/base/test_portable_math.c: sine and cosine below 2^-52, and below 2
 * ulp of results above 0.1; the angle below 2^-54 turns; the exponential below 1 ulp; the logarithm
 * below 3 ulp.
 */
#ifndef FORMATS_BASE_PORTABLE_MATH_H
#define FORMATS_BASE_PORTABLE_MATH_H

/* portable_sincos() - sine and cosine of 2 pi t. The argument counts turns, so its reduction is
 * exact. |t| < 2^40. */
void portable_sincos(double t, double *sine, double *cosine);
double portable_sin(double t);
double portable_cos(double t);

/* portable_angle() - the angle from the x axis to the finite vector (x, y), in turns: -0.5 .. 0.5;
 * 0 for (0, 0). */
double portable_angle(double y, double x);

/* portable_exp() - e^x for x <= 700; 0 below -700. */
double portable_exp(double x);

/* portable_log() - the natural logarithm of a finite x > 0. */
double portable_log(double x);

/* The constants of portable_exp(), shared with its vector version. x = n ln 2 + r. ln 2 is in two
 * parts, so that n times the first is exact. The series is (e^r - 1 - r) / r^2, its last term
 * first. */
#define PORTABLE_ROUNDER  0x1.8p52
#define PORTABLE_LOG2_E   1.4426950408889634
#define PORTABLE_LN2_HIGH 0x1.62e42fefap-1
#define PORTABLE_LN2_LOW  0x1.cf79abc9e3b3ap-40
#define PORTABLE_EXP_SERIES                                                                       \
    {                                                                                             \
        1.0 / 6227020800.0, 1.0 / 479001600.0, 1.0 / 39916800.0, 1.0 / 3628800.0, 1.0 / 362880.0, \
            1.0 / 40320.0, 1.0 / 5040.0, 1.0 / 720.0, 1.0 / 120.0, 1.0 / 24.0, 1.0 / 6.0, 0.5     \
    }

#endif
