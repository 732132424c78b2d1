/* test_intersect.c - each intersector on cells whose answer is known: planes, two surfaces, none.
 */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "render/experiments/intersect.h"
#include "tests/support/fields.h"

static const cell_box UNIT = {{0, 0, 0}, {1, 1, 1}, {1, 1, 1}, {false, false, false}};

static cell_visit visit_of(const ray *r) {
    cell_visit v;
    assert_true(cell_visit_of(r, &UNIT, &v));
    return v;
}

static bool first_hit(const intersector *x, const ray *r, const float samples[8], double iso,
                      const hit *after, hit *found) {
    const cell_visit v = visit_of(r);
    return x->next_hit(r, &v, samples, iso, 5, 77, after, found);
}

/* f = a . p + w: one surface at most, and a linear function along every ray. */
static void test_planes(void **state) {
    (void)state;
    const char *given = getenv("LEAFCAST_SEED");
    field_random random = {given ? strtoull(given, NULL, 10) : FIELD_SEED};
    print_message("# LEAFCAST_SEED=%llu\n", (unsigned long long)random.state);
    int seen = 0;
    for (int trial = 0; trial < 20000; trial++) {
        double a[3], w = field_random_in(&random, -1, 1);
        ray r = {.t0 = 0, .t1 = INFINITY};
        for (int i = 0; i < 3; i++) {
            a[i] = (double)field_random_below(&random, 64) / 32 - 1;
            r.o[i] = field_random_in(&random, -2, 3);
            r.d[i] = field_random_in(&random, 0.1, 0.9) - r.o[i];
        }
        float samples[8];
        for (int i = 0; i < 8; i++)
            samples[i] = (float)((i & 1) * a[0] + (i >> 1 & 1) * a[1] + (i >> 2) * a[2]);
        const cell_visit v = visit_of(&r);
        const double rate = a[0] * r.d[0] + a[1] * r.d[1] + a[2] * r.d[2];
        const double t = (w - a[0] * r.o[0] - a[1] * r.o[1] - a[2] * r.o[2]) / rate;
        if (fabs(rate) < 1e-3 || fabs(t - v.t_in) < 1e-6 || fabs(t - v.t_out) < 1e-6)
            continue;
        const bool there = t > v.t_in && t < v.t_out;
        seen += there;
        for (int k = 1; k < INTERSECTOR_COUNT; k++) {
            const intersector *x = intersector_at(k);
            const hit start = hit_before_all();
            hit h = hit_none();
            const bool found = x->next_hit(&r, &v, samples, w, 5, 77, &start, &h);
            if (found != there || (there && fabs(h.t - t) > 1e-9))
                fail_msg("%s: trial %d: %d t %.17g, not %d t %.17g", x->name, trial, found, h.t,
                         there, t);
            if (there) {
                assert_true(h.cell == 77 && h.iso == 5 && h.entering == (rate > 0));
                /* Strictly after: the same hit is not found again. */
                assert_false(x->next_hit(&r, &v, samples, w, 5, 77, &h, &h));
            }
        }
    }
    assert_true(seen > 1000);
}

/* M08 figure 4.9: along the diagonal f = 2 s (1 - s), outside at both ends. */
static const float SADDLE[8] = {0, 1, 1, 0, 0, 1, 1, 0};
static const ray DIAGONAL = {{-1, -1, 0.5}, {1, 1, 0}, 0, INFINITY, {0}};

static void test_two_surfaces(void **state) {
    (void)state;
    const double s = (1 - sqrt(0.5)) / 2;
    for (int k = 0; k < INTERSECTOR_COUNT; k++) {
        const intersector *x = intersector_at(k);
        const bool approximate = x->id == LEAFCAST_LINEAR || x->id == LEAFCAST_NEUBAUER;
        const double within = x->id == LEAFCAST_MIDPOINT    ? 1
                              : x->id == LEAFCAST_MARMITT_3 ? 0.01
                                                            : 1e-12;
        hit at = hit_before_all();
        assert_int_equal(first_hit(x, &DIAGONAL, SADDLE, 0.25, &at, &at), !approximate);
        if (approximate)
            continue;
        assert_true(fabs(at.t - (1 + s)) < within && at.entering);
        const bool second = first_hit(x, &DIAGONAL, SADDLE, 0.25, &at, &at);
        assert_int_equal(second, x->id != LEAFCAST_MIDPOINT);
        if (second)
            assert_true(fabs(at.t - (2 - s)) < within && !at.entering);
        assert_false(first_hit(x, &DIAGONAL, SADDLE, 0.25, &at, &at));
    }
}

static void test_inactive_cell(void **state) {
    (void)state;
    for (int k = 0; k < INTERSECTOR_COUNT; k++) {
        const hit start = hit_before_all();
        hit found = hit_none();
        assert_false(first_hit(intersector_at(k), &DIAGONAL, SADDLE, 1.5, &start, &found));
        assert_false(first_hit(intersector_at(k), &DIAGONAL, SADDLE, -0.5, &start, &found));
        assert_false(first_hit(intersector_at(k), &DIAGONAL, SADDLE, 0, &start, &found));
        assert_false(hit_exists(&found));
    }
}

/* Three roots: all are found, in order, by those that isolate them. */
static void test_three_surfaces(void **state) {
    (void)state;
    /* Along the main diagonal a cubic with control values -1, 3, -3, 1 (s = 1/2 is a root). */
    const float samples[8] = {-1, 3, 3, -3, 3, -3, -3, 1};
    const ray r = {{0, 0, 0}, {1, 1, 1}, 0, INFINITY, {0}};
    for (int k = 3; k < INTERSECTOR_COUNT; k++) {
        const intersector *x = intersector_at(k);
        hit at = hit_before_all();
        double t[4];
        int n = 0;
        while (n < 4 && first_hit(x, &r, samples, 0, &at, &at)) {
            assert_int_equal(at.entering, n % 2 == 0);
            t[n++] = at.t;
        }
        assert_int_equal(n, 3);
        assert_true(t[0] < t[1] && t[1] < t[2]);
        assert_true(fabs(t[1] - 0.5) < 1e-6 && fabs(t[0] + t[2] - 1) < 0.05);
    }
}

static void test_names(void **state) {
    (void)state;
    for (int k = 0; k < INTERSECTOR_COUNT; k++) {
        const intersector *x = intersector_at(k);
        assert_ptr_equal(intersector_find(x->id), x);
        assert_ptr_equal(intersector_named(x->name), x);
    }
    assert_ptr_equal(intersector_find(LEAFCAST_MARMITT)->next_hit, cell_next_hit);
    assert_null(intersector_named("marmitt-4"));
    assert_null(intersector_find((leafcast_intersector)99));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_planes),        cmocka_unit_test(test_two_surfaces),
        cmocka_unit_test(test_inactive_cell), cmocka_unit_test(test_three_surfaces),
        cmocka_unit_test(test_names),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
