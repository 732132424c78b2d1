/* test_interest.c - intervals sorted and merged without a change to what meets them, and the floats
 * that stand for their ends. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <float.h>
#include <math.h>

#include "tests/support/interests.h"

/* The least float that reaches a value. */
static void test_threshold(void **state) {
    (void)state;
    static const double values[] = {
        0.0,  -0.0,  1e-310, -1e-310, 1e-46,  -1e-46,     1.0,         0.1,   1e30,   -1e30,
        1e39, -1e39, 1e300,  -1e300,  3.4e38, 16777217.0, -16777217.0, 1e-45, -1e-45, FLT_MAX};
    for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
        const float at = value_limits_threshold(values[i]);
        assert_true((double)at >= values[i]);
        const float below = nextafterf(at, -INFINITY);
        assert_true((double)below < values[i] || (at == 0.0f && values[i] <= 0.0));
    }
    assert_true(value_limits_threshold(1e39) == INFINITY);
    assert_true(value_limits_threshold(-1e39) == -FLT_MAX);
}

/* Ends at floats, beside them by less than a float's step, and beyond all floats. */
static const double ends[] = {-(double)INFINITY,
                              -1e300,
                              -(double)FLT_MAX,
                              -2.5,
                              -1e-310,
                              0.0,
                              1e-45,
                              1.0,
                              1.0 + 1e-12,
                              2.0,
                              2.5,
                              3.0,
                              (double)FLT_MAX,
                              1e39,
                              (double)INFINITY};
static const float samples[] = {-FLT_MAX, -3.0f, -2.5f,       -1e-45f, -0.0f, 0.0f, 1e-45f,
                                1.0f,     2.0f,  1.00000012f, 2.25f,   2.5f,  3.0f, FLT_MAX};
enum { ENDS = sizeof ends / sizeof *ends, SAMPLES = sizeof samples / sizeof *samples };

static void assert_meets(const interests *set) {
    for (int i = 0; i < SAMPLES; i++)
        for (int k = 0; k < SAMPLES; k++) {
            const float a = fminf(samples[i], samples[k]), b = fmaxf(samples[i], samples[k]);
            if (interest_meets(&set->in, a, b) != interests_meet(set, (double)a, (double)b))
                fail_msg("%g .. %g and %s", (double)a, (double)b, interests_name(set));
        }
    assert_false(interest_meets(&set->in, INFINITY, -INFINITY));
}

static interest_interval of_bits(double a, double b, int open) {
    interest_interval i = {fmin(a, b), fmax(a, b), open & 1, open & 2};
    if (i.lo == i.hi)
        i.lo_open = false;
    return i;
}

static void test_one(void **state) {
    (void)state;
    for (int i = 0; i < ENDS; i++)
        for (int k = i; k < ENDS; k++)
            for (int open = 0; open < 4; open++) {
                interests set = {.count = 1, .raw = {of_bits(ends[i], ends[k], open)}};
                set.in = interest_of_intervals(set.raw, 1);
                assert_int_equal(set.in.count, 1);
                assert_meets(&set);
            }
}

/* Nothing is left over, nothing could be merged further. */
static void assert_normal(const interests *set) {
    for (int i = 1; i < set->in.count; i++) {
        const interest_interval *a = &set->in.of[i - 1], *b = &set->in.of[i];
        const bool sets = (a->lo < a->hi || !a->hi_open) && (b->lo < b->hi || !b->hi_open);
        if (a->hi > b->lo || (a->hi == b->lo && sets && !(a->hi_open && b->lo_open)))
            fail_msg("%d and %d of %s", i - 1, i, interests_name(set));
    }
}

static void test_many(void **state) {
    (void)state;
    field_random r = {FIELD_SEED};
    static const double few[] = {-1, 0, 0.5, 1, 2, 3};
    for (int n = 0; n < 4000; n++) {
        interests set;
        if (n % 2)
            interests_random(&set, &r, ends + 1, ENDS - 2);
        else
            interests_random(&set, &r, few, 6);
        assert_meets(&set);
        assert_normal(&set);
        /* The order in which they are given, and what is given twice, make no difference. */
        interests turned = set;
        for (int i = 0; i < set.count; i++)
            turned.raw[i] = set.raw[set.count - 1 - i];
        if (turned.count < INTEREST_MAX)
            turned.raw[turned.count++] = set.raw[0];
        turned.in = interest_of_intervals(turned.raw, turned.count);
        assert_true(interest_same(&set.in, &turned.in));
        interest other = set.in;
        other.of[other.count - 1].hi_open ^= true;
        assert_false(interest_same(&set.in, &other));
    }
}

/* What stays beside what, and what goes. */
static void test_isovalues(void **state) {
    (void)state;
    static const struct {
        interest_interval a, b;
        int left;
    } cases[] = {
        {{2, 2, false, true}, {2, 3, true, false}, 2},  /* no value past 2 makes a side change */
        {{2, 2, false, true}, {2, 3, false, false}, 1}, /* implied */
        {{2, 2, false, true}, {1, 2, false, true}, 1}, /* what changes side at 2 is below it, too */
        {{2, 2, false, true}, {2, 2, false, false}, 1},
        {{2, 2, false, true}, {2, 2, false, true}, 1},
        {{1, 2, false, true}, {2, 3, true, false}, 2}, /* a constant cell of 2 meets neither */
        {{1, 2, false, true}, {2, 3, false, false}, 1},
        {{1, 2, false, false}, {2, 3, true, false}, 1},
        {{1, 2, false, true}, {2, 2, false, false}, 1},
        {{1, 4, false, true}, {2, 3, false, false}, 1},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        interests set = {.count = 2, .raw = {cases[i].a, cases[i].b}};
        set.in = interest_of_intervals(set.raw, 2);
        assert_int_equal(set.in.count, cases[i].left);
        assert_meets(&set);
    }
    static const double isovalues[] = {3, 1, 2, 1};
    const interest in = interest_of_isovalues(isovalues, 4);
    assert_int_equal(in.count, 3);
    for (int i = 0; i < 3; i++) {
        assert_true(in.of[i].lo == i + 1 && in.of[i].hi == i + 1);
        assert_true(in.limits[i].reach == in.limits[i].beyond);
    }
}

/* Codes are conservative, and exact where they lose nothing. */
static void test_codes(void **state) {
    (void)state;
    field_random r = {FIELD_SEED};
    for (int n = 0; n < 30000; n++) {
        static const sample_type types[] = {SAMPLE_U8, SAMPLE_I16, SAMPLE_F32};
        const sample_type type = types[n % 3];
        double v[4];
        for (int i = 0; i < 4; i++) {
            const double x = field_random_in(&r, -1, 1);
            v[i] = type == SAMPLE_U8    ? floor(128 + 127 * x)
                   : type == SAMPLE_I16 ? floor(n % 2 ? 1e4 * x : 90 * x)
                                        : (double)(float)(1e6 * (n % 5 == 0) + x);
        }
        const double lo = fmin(v[0], v[1]), hi = fmax(v[0], v[1]);
        const quantizer q = quantizer_of((float)fmin(lo, fmin(v[2], v[3])),
                                         (float)fmax(hi, fmax(v[2], v[3])), type);
        interests set;
        interest_part part;
        interests_random(&set, &r, v, 4);
        interest_within(&part, &set.in, &q);
        bool holds = false;
        for (int i = 0; i < part.count; i++)
            holds |= quantize_holds(part.codes[i], quantizer_floor(&q, lo), quantizer_ceil(&q, hi));
        const bool meets = interests_meet(&set, lo, hi);
        if (meets ? !holds : holds && q.exact)
            fail_msg("seed %d case %d: own %a .. %a, range %a .. %a, %s", FIELD_SEED, n, q.lo, q.hi,
                     lo, hi, interests_name(&set));
    }
    const quantizer nothing = quantizer_of(INFINITY, -INFINITY, SAMPLE_F32);
    const interest all = interest_of_all();
    interest_part part;
    interest_within(&part, &all, &nothing);
    assert_int_equal(part.count, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_threshold), cmocka_unit_test(test_one),   cmocka_unit_test(test_many),
        cmocka_unit_test(test_isovalues), cmocka_unit_test(test_codes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
