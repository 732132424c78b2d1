/* test_medium_stretch.c - a piece of a ray whose cuts are far off, and whose value is: what is seen
 * of it is no farther off than it says. Ordinary cuts are off by so little that nothing else in the
 * tests would tell whether that counts.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "render/medium/medium_stretch.h"
#include "tests/support/fields.h"

enum { SEED = 5, ROUNDS = 400, PIECES = 20, POINTS_MAX = 8 };

/* A few points in 0 .. 1; with steps some of them share a value. */
static int points_of(field_random *r, bool steps, leafcast_transfer_point p[POINTS_MAX]) {
    const int count = 3 + (int)field_random_below(r, POINTS_MAX - 2);
    double value = 0.0;
    for (int i = 0; i < count; i++) {
        const bool step = steps && i > 0 && field_random_below(r, 2);
        value += step ? 0.0 : field_random_in(r, 0.05, 1.0) / count;
        p[i] = (leafcast_transfer_point){.value = value, .extinction = field_random_in(r, 0, 2)};
        for (int c = 0; c < 3; c++)
            p[i].rgb[c] = field_random_in(r, 0, 1);
    }
    return count;
}

static segment piece_of(field_random *r) {
    segment s = {.t1 = field_random_in(r, 0.1, 2), .degree = field_random_below(r, 2) ? 3 : 1};
    for (int i = 0; i < 4; i++)
        s.b[i] = field_random_in(r, -0.2, 1.2);
    return s;
}

/* Cuts may be off by a part of the narrower span beside them, also where there is a step. */
static void let_cuts_be_off(transfer *t, double part) {
    for (int i = 1; i + 2 < t->spans; i++)
        t->span[i].give =
            part * fmin(t->span[i].to - t->span[i].from, t->span[i + 1].to - t->span[i + 1].from);
}

/* Returns how far the two are apart, as a share of what they may be. */
static double apart(const medium_stretch *a, const medium_stretch *b) {
    double worst = fabs(a->through - b->through) / (a->through_error + b->through_error + 0x1p-40);
    for (int c = 0; c < 3; c++)
        worst = fmax(worst, fabs(a->rgb[c] - b->rgb[c]) / (a->rgb_error + b->rgb_error + 0x1p-40));
    return worst;
}

/* Returns the worst of all. */
static double check(bool steps, double part, double value_error, double *change) {
    field_random r = {SEED};
    mem m;
    double worst = 0.0;
    mem_init(&m, 0);
    *change = 0.0;
    for (int i = 0; i < ROUNDS; i++) {
        leafcast_transfer_point points[POINTS_MAX + 1];
        const leafcast_medium medium = {points, points_of(&r, steps, points)};
        transfer exact, rough;
        assert_int_equal(transfer_init(&exact, &m, &medium), ST_OK);
        assert_int_equal(transfer_init(&rough, &m, &medium), ST_OK);
        let_cuts_be_off(&exact, 0.0);
        let_cuts_be_off(&rough, part);
        const medium_rule of_exact = {.transfer = &exact, .share = 1e-5};
        const medium_rule of_rough = {
            .transfer = &rough, .share = 1e-5, .error = {.value = value_error}};
        for (int k = 0; k < PIECES; k++) {
            const segment piece = piece_of(&r);
            segment moved = piece;
            for (int c = 0; c < 4; c++)
                moved.b[c] += field_random_in(&r, -value_error, value_error);
            const medium_stretch a = medium_of_piece(&of_exact, &piece);
            const medium_stretch b = medium_of_piece(&of_rough, &moved);
            worst = fmax(worst, apart(&a, &b));
            *change = fmax(*change, fabs(a.through - b.through));
        }
        transfer_release(&exact, &m);
        transfer_release(&rough, &m);
    }
    return worst;
}

static void check_all(bool steps, double part, double value_error) {
    double change;
    const double worst = check(steps, part, value_error, &change);
    print_message("# %s, off by %g of a span, value off by %g: %.3f of the bound\n",
                  steps ? "steps" : "smooth", part, value_error, worst);
    assert_true(worst <= 1.0);
    assert_true(change > 1e-8);
}

static void test_cuts_that_are_off(void **state) {
    /* With the last ones neighbouring cuts change places. */
    static const double parts[] = {1e-3, 0.03, 0.2}, value_errors[] = {0.0, 1e-3, 0.05, 0.2};
    (void)state;
    for (int steps = 0; steps < 2; steps++)
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 4; k++)
                check_all(steps, parts[i], value_errors[k]);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_cuts_that_are_off)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
