/* test_portable_math.c - the error bounds of portable_math.h against long double libm, and their
 * pinned bits.
 */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "formats/base/hash.h"
#include "formats/base/portable_math.h"

static const long double PI = 3.14159265358979323846264338327950288L;

enum { ROUNDS = 200000 };

static double ulps(double got, long double want) {
    double w = fabs((double)want);
    return (double)(fabsl(got - want) / (nextafter(w, INFINITY) - w));
}

static void check_sincos(double t) {
    /* The reduction below is exact, so that the argument of libm's functions is as good as t
     * itself. */
    double turns = t - nearbyint(t);
    const long double want[2] = {sinl(2 * PI * turns), cosl(2 * PI * turns)};
    double got[2];
    portable_sincos(t, &got[0], &got[1]);
    for (int i = 0; i < 2; i++) {
        if (!(fabsl(got[i] - want[i]) < DBL_EPSILON))
            fail_msg("%s(2 pi %.17g) is %.17g, off by %Lg", i ? "cos" : "sin", t, got[i],
                     got[i] - want[i]);
        if (fabsl(want[i]) > 0.1L && !(ulps(got[i], want[i]) < 2))
            fail_msg("%s(2 pi %.17g) is off by %.2f ulp", i ? "cos" : "sin", t,
                     ulps(got[i], want[i]));
    }
    assert_true(portable_sin(t) == got[0] && portable_cos(t) == got[1]);
}

static void test_sincos(void **state) {
    (void)state;
    srand48(11);
    for (int n = 0; n < ROUNDS; n++)
        check_sincos((drand48() - 0.5) * (n % 3 == 0 ? 2 : n % 3 == 1 ? 200 : 1e6));
    for (int n = -64; n <= 64; n++)
        for (int side = -1; side <= 1; side++)
            check_sincos(n / 16.0 + side * DBL_EPSILON);
    double s, c;
    portable_sincos(0.25, &s, &c);
    assert_true(s == 1 && c == 0);
    portable_sincos(-0.5, &s, &c);
    assert_true(s == 0 && c == -1);
}

static void test_exp(void **state) {
    (void)state;
    srand48(12);
    for (int n = 0; n < ROUNDS; n++) {
        double x = (2 * drand48() - 1) * (n % 3 == 0 ? 1 : n % 3 == 1 ? 20 : 700);
        if (!(ulps(portable_exp(x), expl(x)) < 1))
            fail_msg("exp(%.17g) is off by %.2f ulp", x, ulps(portable_exp(x), expl(x)));
    }
    assert_true(portable_exp(0) == 1 && portable_exp(-701) == 0 && portable_exp(-INFINITY) == 0);
}

static void test_log(void **state) {
    (void)state;
    srand48(13);
    for (int n = 0; n < ROUNDS; n++) {
        const double x = n % 3 == 0   ? 1.0 + (drand48() - 0.5) * 0x1p-8
                         : n % 3 == 1 ? ldexp(drand48() + 1e-9, (int)(drand48() * 2000) - 1000)
                                      : drand48() + 1e-300;
        const double got = portable_log(x);
        const long double want = logl(x);
        if (!(got == 0.0 && want == 0.0L) && !(ulps(got, want) < 3))
            fail_msg("log(%.17g) is off by %.2f ulp", x, ulps(got, want));
    }
    assert_true(portable_log(1) == 0 && portable_log(2) == 0x1.62e42fefa39efp-1);
    assert_true(ulps(portable_log(DBL_TRUE_MIN), logl(DBL_TRUE_MIN)) < 3);
    assert_true(ulps(portable_log(DBL_MAX), logl(DBL_MAX)) < 3);
}

static void test_angle(void **state) {
    (void)state;
    srand48(14);
    for (int n = 0; n < ROUNDS; n++) {
        const double scale = ldexp(1.0, (int)(drand48() * 40) - 20);
        const double y = (drand48() - 0.5) * scale, x = drand48() - 0.5;
        const long double want = atan2l(y, x) / (2 * PI);
        if (!(fabsl(portable_angle(y, x) - want) < 0x1p-54L))
            fail_msg("angle(%.17g, %.17g) is off by %Lg", y, x, portable_angle(y, x) - want);
    }
    assert_true(portable_angle(0, 0) == 0 && portable_angle(0, 3) == 0);
    assert_true(portable_angle(2, 0) == 0.25 && portable_angle(-2, 0) == -0.25);
    assert_true(portable_angle(0, -1) == 0.5 && portable_angle(3, 3) == 0.125);
}

/* The same bits on every machine: the hash of many results. */
static void test_bits(void **state) {
    (void)state;
    static double results[5][4096];
    for (int n = 0; n < 4096; n++) {
        double x = (n - 2048) * 0.0103125;
        portable_sincos(x, &results[0][n], &results[1][n]);
        results[2][n] = portable_exp(x * 10);
        results[3][n] = portable_log(n + 0.0103125);
        results[4][n] = portable_angle(x, 3.0 - n * 0.002);
    }
    assert_int_equal(hash_bytes(results, 3 * sizeof results[0]), 0x7e1f5c9139bdc7da);
    assert_int_equal(hash_bytes(results[3], 2 * sizeof results[0]), 0x189dd2f3ab7917ea);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sincos), cmocka_unit_test(test_exp),  cmocka_unit_test(test_log),
        cmocka_unit_test(test_angle),  cmocka_unit_test(test_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
