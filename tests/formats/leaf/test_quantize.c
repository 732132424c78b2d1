/* test_quantize.c - codes lose no surface: a range that holds an isovalue passes, for every range
 * and every isovalue; and integers on at most 256 values pass nothing else.
 */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>

#include "formats/leaf/quantize.h"
#include "tests/support/fields.h"

static bool passes(const quantizer *q, double lo, double hi, double iso) {
    return quantize_holds(quantizer_iso(q, iso), quantizer_floor(q, lo), quantizer_ceil(q, hi));
}

/* All ranges of u8 inside some own ranges, at all whole and half isovalues, and just beside them.
 */
static void test_exact(void **state) {
    (void)state;
    static const float owns[][2] = {{0, 255}, {3, 9}, {200, 201}, {0, 128}, {17, 255}};
    for (size_t i = 0; i < sizeof owns / sizeof owns[0]; i++) {
        quantizer q = quantizer_of(owns[i][0], owns[i][1], SAMPLE_U8);
        assert_true(q.exact);
        for (int twice = -2; twice <= 514; twice++)
            for (int nudge = -1; nudge <= 1; nudge++) {
                double iso = twice / 2.0;
                iso = nudge ? nextafter(iso, nudge * 1e9) : iso;
                quantized_limits c = quantizer_iso(&q, iso);
                for (int lo = (int)owns[i][0]; lo <= (int)owns[i][1]; lo++)
                    for (int hi = lo; hi <= (int)owns[i][1]; hi++)
                        if (quantize_holds(c, quantizer_floor(&q, lo), quantizer_ceil(&q, hi)) !=
                            (lo < iso && iso <= hi))
                            fail_msg("own %g..%g, range %d..%d, iso %.17g", q.lo, q.hi, lo, hi,
                                     iso);
            }
    }
}

static double random_sample(field_random *r, sample_type type, int magnitude) {
    switch (type) {
    case SAMPLE_U16: return (double)field_random_below(r, 65536);
    case SAMPLE_I16: return (double)field_random_below(r, 65536) - 32768;
    default: return (double)(float)(field_random_in(r, -1, 1) * pow(10, magnitude));
    }
}

static void test_conservative(void **state) {
    (void)state;
    static const sample_type types[] = {SAMPLE_U16, SAMPLE_I16, SAMPLE_F32};
    static const int magnitudes[] = {-44, -38, -30, -3, 0, 5, 30, 38};
    field_random r = {FIELD_SEED};
    for (int n = 0; n < 400000; n++) {
        sample_type type = types[n % 3];
        double v[4];
        for (int i = 0; i < 4; i++) {
            /* Far from the origin with little between them, as well. */
            v[i] = random_sample(&r, type, magnitudes[n / 3 % 8]);
            if (type == SAMPLE_F32 && n % 5 == 0)
                v[i] = (double)(float)(1e6 + v[i]);
        }
        double lo = fmin(v[0], v[1]), hi = fmax(v[0], v[1]);
        quantizer q = quantizer_of((float)fmin(lo, fmin(v[2], v[3])),
                                   (float)fmax(hi, fmax(v[2], v[3])), type);
        double isos[] = {hi,
                         nextafter(lo, INFINITY),
                         lo + (hi - lo) * field_random_unit(&r),
                         v[2],
                         ceil(v[3]),
                         floor(hi)};
        for (size_t i = 0; i < sizeof isos / sizeof isos[0]; i++)
            if (lo < isos[i] && isos[i] <= hi && !passes(&q, lo, hi, isos[i]))
                fail_msg("seed %d case %d: own %a..%a, range %a..%a, iso %a", FIELD_SEED, n, q.lo,
                         q.hi, lo, hi, isos[i]);
    }
}

static void test_monotone(void **state) {
    (void)state;
    field_random r = {FIELD_SEED};
    for (int n = 0; n < 20000; n++) {
        float a = (float)random_sample(&r, SAMPLE_F32, n % 60 - 30),
              b = (float)random_sample(&r, SAMPLE_F32, n % 60 - 30);
        quantizer q = quantizer_of(fminf(a, b), fmaxf(a, b), SAMPLE_F32);
        assert_int_equal(quantizer_floor(&q, q.lo), 0);
        double before = 0;
        for (int i = 0; i <= 50; i++) {
            double v = i < 50 ? q.lo + (q.hi - q.lo) * i / 50 : q.hi;
            double g = quantizer_map(&q, v);
            assert_true(g >= before && g <= 255);
            before = g;
        }
        assert_true(q.hi == q.lo || quantizer_ceil(&q, q.hi) == 255);
    }
}

static void test_corners(void **state) {
    (void)state;
    /* iso - lo rounds to a whole number here; the cell of samples 0 and 5 holds it all the same. */
    quantizer q = quantizer_of(-100, 100, SAMPLE_I16);
    assert_true(passes(&q, 0, 5, 1e-20));
    assert_true(passes(&q, -1, 0, -1e-20));
    assert_false(passes(&q, 0, 0, 1e-20));
    q = quantizer_of(-1e30F, 1e30F, SAMPLE_F32);
    assert_true(passes(&q, 0, 5, 1e-20));
    /* Outside the own range, at its ends, and isovalues that are none. */
    q = quantizer_of(10, 20, SAMPLE_U8);
    assert_false(passes(&q, 10, 20, 10));
    assert_true(passes(&q, 10, 20, 20));
    assert_false(passes(&q, 10, 20, 20.5));
    assert_false(passes(&q, 10, 20, (double)NAN));
    assert_false(passes(&q, 10, 20, (double)INFINITY));
    assert_false(passes(&q, 10, 20, -(double)INFINITY));
    /* A constant treelet, an empty one, an empty node. */
    q = quantizer_of(7, 7, SAMPLE_F32);
    assert_int_equal(quantizer_floor(&q, 7), 0);
    assert_int_equal(quantizer_ceil(&q, 7), 0);
    assert_false(passes(&q, 7, 7, 7));
    q = quantizer_of(INFINITY, -INFINITY, SAMPLE_F32);
    assert_false(quantize_holds(quantizer_iso(&q, 0), 0, 255));
    q = quantizer_of(0, 1, SAMPLE_F32);
    for (int i = 0; i <= 10; i++)
        assert_false(quantize_holds(quantizer_iso(&q, i / 10.0), 255, 0));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_exact),
        cmocka_unit_test(test_conservative),
        cmocka_unit_test(test_monotone),
        cmocka_unit_test(test_corners),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
