/* portable_math.h - sine, cosine, angle, exponential and logarithm with the same bits on every
 * machine.
 *
 * libm's differ between versions and CPUs. These use + - * / alone, in a fixed order, in IEEE
 * doubles; the build forbids contraction to FMA. Errors, measured against long double libm by
 * tests/test_portable_math.c: sine and cosine below 2^-52, and below 2 ulp of results above 0.1;
 * the angle below 2^-54 turns; the exponential below 1 ulp; the logarithm below 3 ulp.
 */
#ifndef FORMATS_BASE_PORTABLE_MATH_H
#define FORMATS_BASE_PORTABLE_MATH_H

/* portable_sincos() - sine and cosine of 2 pi t: the argument counts turns, so that its reduction
 * is exact. |t| < 2^40. */
void portable_sincos(double t, double *sine, double *cosine);
double portable_sin(double t);
double portable_cos(double t);

/* portable_angle() - of the vector (x, y), finite, from the x axis on, in turns: -0.5 .. 0.5; 0 of
 * (0, 0). */
double portable_angle(double y, double x);

/* portable_exp() - e^x for x <= 700; 0 below -700. */
double portable_exp(double x);

/* portable_log() - the natural logarithm of a finite x > 0. */
double portable_log(double x);

#endif
