/* exact_sum.h - sums of products of three doubles without any rounding: signs of determinants that
 * are what they are.
 */
#ifndef TESTS_SUPPORT_EXACT_SUM_H
#define TESTS_SUPPORT_EXACT_SUM_H

#include <stdint.h>

enum { EXACT_SUM_LIMBS = 204 };

/* A number in steps of 2^-3264, 32 bits a limb, carries not yet passed on. Room for 2^20 terms. */
typedef struct exact_sum {
    int64_t limb[EXACT_SUM_LIMBS];
    int first, end; /* all others are 0 */
} exact_sum;

void exact_sum_clear(exact_sum *s);

/* exact_sum_add() - += a b c; all finite. */
void exact_sum_add(exact_sum *s, double a, double b, double c);

/* exact_sum_value() - its sign is exact, its size right to 2^-62; the sum is spent. */
long double exact_sum_value(exact_sum *s);

/* exact_sum_volume() - the determinant of a - p, b - p, c - p, as exact_sum_value() gives it. */
long double exact_sum_volume(const double a[3], const double b[3], const double c[3],
                             const double p[3]);

#endif
