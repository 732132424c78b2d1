/* portable_math.h - sine, cosine and exponential with the same bits on every machine.
 *
 * libm's differ between versions and CPUs. These use + - * alone, in a fixed order, in IEEE
 * doubles; the build forbids contraction to FMA. Errors, measured against long double libm by
 * tests/test_portable_math.c: sine and cosine below 2^-52, and below 2 ulp of results above 0.1;
 * the exponential below 1 ulp.
 */
#ifndef FORMATS_BASE_PORTABLE_MATH_H
#define FORMATS_BASE_PORTABLE_MATH_H

/* portable_sincos() - sine and cosine of 2 pi t: the argument counts turns, so that its reduction
 * is exact. |t| < 2^40. */
void portable_sincos(double t, double *sine, double *cosine);
double portable_sin(double t);
double portable_cos(double t);

/* portable_exp() - e^x for x <= 700; 0 below -700. */
double portable_exp(double x);

#endif
