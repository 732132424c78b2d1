/* test_view_pace.c - grades for pictures that take the times of a model, and how soon they fit. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <string.h>

#include "render/view/view_pace.h"

#define BUDGET 0.034

/* A renderer: seconds a pixel at level 0, and the share of that at each coarser level. */
typedef struct model {
    double cost, per_level, more; /* more: seconds a picture, whatever its size */
    double tets;                  /* how many times that slow levels take */
} model;

static double takes(const model *m, const view_task *t, view_grade g) {
    const double cells = g.level < t->slow ? m->tets : 1.0;
    return m->more + cells * m->cost * pow(m->per_level, g.level) * view_pace_pixels(t, g);
}

static const view_task GRID = {
    .width = 1280, .height = 720, .levels = 4, .cells = 0.6, .guess = 8e-7, .apart = 1.0};

/* One picture as the viewer draws it: given up where it takes longer than it may. Its time, with
 * those that were given up before it. */
static double draw(view_pace *p, const view_task *t, const model *m, view_grade *drawn, int *lost) {
    double all = 0.0;
    *drawn = view_pace_choose(p, t, BUDGET);
    for (;;) {
        const double seconds = takes(m, t, *drawn), limit = 1.5 * BUDGET;
        if (seconds <= 2.0 * limit || view_pace_coarsest(p, t)) {
            view_pace_learn(p, t, *drawn, seconds, 1.0);
            return all + seconds;
        }
        view_pace_learn(p, t, *drawn, limit, limit / seconds);
        all += limit;
        ++*lost;
        *drawn = view_pace_coarser(p, t, BUDGET);
    }
}

/* After at most `settle` pictures each fits, and none is lost; the grade it settles at. */
static view_grade settles(view_pace *p, const view_task *t, const model *m, int settle) {
    view_grade g = {1, 0};
    int lost = 0, late = 0;
    for (int i = 0; i < settle; i++)
        (void)draw(p, t, m, &g, &lost);
    lost = 0;
    for (int i = 0; i < 200; i++)
        late += draw(p, t, m, &g, &lost) > 1.01 * BUDGET;
    assert_int_equal(lost, 0);
    assert_int_equal(late, 0);
    return g;
}

static void test_quick(void **state) {
    (void)state;
    view_pace p = {0};
    const view_grade g = settles(&p, &GRID, &(model){2e-8, 0.5, 0.0, 1.0}, 20);
    assert_int_equal(g.scale, 1);
    assert_int_equal(g.level, 0);
}

/* Whatever it costs, from what cannot be drawn in time by far to what always is: the grade is the
 * best that fits, as hysteresis has it. */
static void test_fits(void **state) {
    (void)state;
    for (double cost = 1e-8; cost < 1e-5; cost *= 1.3) {
        view_pace p = {0};
        const model m = {cost, 0.5, 0.0, 1.0};
        const view_grade g = settles(&p, &GRID, &m, 20);
        assert_true(takes(&m, &GRID, g) <= BUDGET);
        if (g.scale > 1) {
            const view_grade better = {g.scale - 1, 0};
            assert_true(takes(&m, &GRID, better) > 0.5 * BUDGET);
        }
    }
}

/* The coarsest is drawn, however long it takes. */
static void test_hopeless(void **state) {
    (void)state;
    view_pace p = {0};
    const model m = {1e-3, 0.9, 0.0, 1.0};
    view_grade g;
    int lost = 0;
    for (int i = 0; i < 5; i++)
        (void)draw(&p, &GRID, &m, &g, &lost);
    assert_true(view_pace_coarsest(&p, &GRID));
    assert_int_equal(g.scale, VIEW_SCALE_MAX);
    assert_int_equal(g.level, GRID.levels - 1);
    lost = 0;
    (void)draw(&p, &GRID, &m, &g, &lost);
    assert_int_equal(lost, 0);
}

/* A view that takes a hundred times as long, and back. */
static void test_changes(void **state) {
    (void)state;
    view_pace p = {0};
    const model quick = {2e-8, 0.5, 0.0, 1.0}, slow = {2e-6, 0.5, 0.0, 1.0};
    const view_grade fine = settles(&p, &GRID, &quick, 20);
    view_grade g;
    int lost = 0;
    (void)draw(&p, &GRID, &slow, &g, &lost);
    assert_in_range(lost, 1, 2);
    const view_grade coarse = settles(&p, &GRID, &slow, 10);
    assert_true(coarse.scale > fine.scale);
    const view_grade again = settles(&p, &GRID, &quick, 30);
    assert_int_equal(again.scale, fine.scale);
    assert_int_equal(again.level, fine.level);
}

/* A picture that another program has held up once changes little, and is forgotten. */
static void test_held_up(void **state) {
    (void)state;
    view_pace p = {0};
    const model m = {1e-7, 0.5, 0.0, 1.0};
    const view_grade before = settles(&p, &GRID, &m, 20);
    const double usual = takes(&m, &GRID, before);
    view_pace_learn(&p, &GRID, before, 1.4 * usual, 1.0);
    const view_grade next = view_pace_choose(&p, &GRID, BUDGET);
    assert_true(next.scale <= before.scale + 1);
    view_pace_learn(&p, &GRID, before, 1.5 * BUDGET, 1e-9); /* nothing of it was there */
    const view_grade after = settles(&p, &GRID, &m, 30);
    assert_int_equal(after.scale, before.scale);
    assert_int_equal(after.level, before.level);
}

/* It does not change from grade to grade where two would do. */
static void test_steady(void **state) {
    (void)state;
    for (double cost = 1e-8; cost < 1e-5; cost *= 1.07) {
        view_pace p = {0};
        view_grade g, before = {0, 0};
        int lost = 0, changes = 0;
        for (int i = 0; i < 100; i++) {
            const model m = {cost * (i % 2 ? 1.05 : 0.95), 0.5, 0.0, 1.0};
            (void)draw(&p, &GRID, &m, &g, &lost);
            changes += i >= 50 && (g.scale != before.scale || g.level != before.level);
            before = g;
        }
        assert_int_equal(changes, 0);
    }
}

/* Cells are about as large as pixels: many small ones are not looked at one by one. */
static void test_levels(void **state) {
    (void)state;
    view_task t = GRID;
    assert_int_equal(view_pace_level(&t, 1), 0);
    assert_int_equal(view_pace_level(&t, 4), 1);
    t.cells = 3.5;
    t.levels = 7;
    assert_int_equal(view_pace_level(&t, 1), 1);
    assert_int_equal(view_pace_level(&t, 4), 3);
    t.levels = 3;
    assert_int_equal(view_pace_level(&t, 4), 2);
    t.cells = 1e300;
    assert_int_equal(view_pace_level(&t, 16), 2);
    t.cells = INFINITY;
    assert_int_equal(view_pace_level(&t, 16), 2);
    t.levels = 1000;
    assert_int_equal(view_pace_level(&t, 16), VIEW_PACE_LEVELS - 1);
    t.cells = 0.0; /* the eye is inside */
    assert_int_equal(view_pace_level(&t, 16), 0);
}

/* A mesh has pixels alone to save; grades that differ by their level alone are one. */
static void test_no_levels(void **state) {
    (void)state;
    view_pace p = {0};
    view_task t = GRID;
    t.levels = 1;
    view_grade g = view_pace_choose(&p, &t, 1.0), before;
    assert_int_equal(g.scale, 1);
    while (!view_pace_coarsest(&p, &t)) {
        before = g;
        g = view_pace_coarser(&p, &t, 1.0);
        assert_true(g.scale > before.scale);
        assert_int_equal(g.level, 0);
    }
    assert_int_equal(g.scale, VIEW_SCALE_MAX);
}

/* Tets that take much longer than the coarse grid's cells are left alone from the first picture on,
 * and not tried again and again; those that do not are drawn. */
static void test_tets(void **state) {
    (void)state;
    view_task t = GRID;
    t.slow = 1;
    t.apart = 8.0;
    t.cells = 0.2;
    for (double tets = 4.0; tets < 200.0; tets *= 1.3)
        for (double cost = 3e-7; cost < 3e-6; cost *= 1.3) {
            view_pace p = {0};
            const model m = {cost, 0.6, 0.0, tets};
            view_grade g;
            int lost = 0;
            (void)draw(&p, &t, &m, &g, &lost);
            assert_true(lost <= 1);
            assert_true(g.level > 0);
            (void)settles(&p, &t, &m, 20);
        }
    view_pace p = {0};
    view_grade g = settles(&p, &t, &(model){1e-9, 0.6, 0.0, 8.0}, 60);
    assert_int_equal(g.scale, 1);
    assert_int_equal(g.level, 0);
    int lost = 0;
    for (int i = 0; i < 200; i++)
        (void)draw(&p, &t, &(model){5e-8, 0.6, 0.0, 200.0}, &g, &lost);
    assert_in_range(lost, 1, 3);
    assert_int_equal(view_pace_quick_level(&GRID, 1), 0);
    assert_int_equal(view_pace_quick_level(&t, 1), 1);
    assert_int_equal(view_pace_quick_level(&t, 32), 2);
    t.levels = 1;
    assert_int_equal(view_pace_quick_level(&t, 1), 0);
}

/* With no, one, two and all levels slow: the first one that is not. */
static void test_quick_levels(void **state) {
    (void)state;
    /* At cells of 0.6: level 0 is asked for at scale 1, level 1 at 4, level 2 at 8. */
    static const uint32_t expected[][3] = {{0, 1, 2}, {1, 1, 2}, {2, 2, 2}, {3, 3, 3}, {0, 1, 2}};
    static const uint32_t scales[] = {1, 4, 8};
    view_task t = GRID;
    t.apart = 8.0;
    for (t.slow = 0; t.slow <= 4; t.slow++)
        for (int i = 0; i < 3; i++)
            assert_int_equal(view_pace_quick_level(&t, scales[i]), expected[t.slow][i]);
    t.slow = 100; /* more than there are */
    assert_int_equal(view_pace_quick_level(&t, 4), 1);
    t.slow = 2; /* a picture of cells of a pixel: no other levels */
    t.levels = 1;
    assert_int_equal(view_pace_quick_level(&t, 4), 0);
    t.levels = 4;
    t.apart = 1.0; /* surfaces: as quick as any */
    assert_int_equal(view_pace_quick_level(&t, 1), 0);
}

/* Seconds that are expected of a level after one of another level took a second. */
static double expected_after(const view_task *t, uint32_t known, uint32_t of) {
    view_pace p = {0};
    view_pace_learn(&p, t, (view_grade){4, known}, 1.0, 1.0);
    return view_pace_seconds(&p, t, (view_grade){4, of}) - p.least / 3.0;
}

/* The time of one slow level says how long another takes, as quick ones do of each other; between
 * slow and quick ones it is `apart` times that. */
static void test_slow_levels(void **state) {
    (void)state;
    view_task t = GRID;
    t.apart = 8.0;
    for (t.slow = 0; t.slow <= t.levels; t.slow++)
        for (uint32_t known = 0; known < t.levels; known++)
            for (uint32_t of = 0; of < t.levels; of++) {
                const view_task alike = {.width = t.width,
                                         .height = t.height,
                                         .levels = t.levels,
                                         .cells = t.cells,
                                         .guess = t.guess,
                                         .apart = 1.0};
                const double more = (of < t.slow ? 8.0 : 1.0) / (known < t.slow ? 8.0 : 1.0);
                const double usual = expected_after(&alike, known, of);
                assert_true(fabs(expected_after(&t, known, of) - more * usual) <= 1e-9 * usual);
            }
}

/* Two slow levels of four, as of a thinned grid with a regular one inside: neither is drawn where
 * it takes too long, from the first picture on, and then pixels are not few if the regular grid's
 * cells are quick. Where they do not, both are drawn. With other numbers of slow levels each
 * picture soon fits, too. */
static void test_thinned(void **state) {
    (void)state;
    view_task t = GRID;
    t.apart = 8.0;
    t.cells = 0.2;
    for (t.slow = 0; t.slow <= t.levels; t.slow++)
        for (double tets = 4.0; tets < 60.0; tets *= 1.3)
            for (double cost = 3e-7; cost < 1e-6; cost *= 1.3) {
                view_pace p = {0};
                const model m = {cost, 0.6, 0.0, tets};
                view_grade g;
                int lost = 0;
                (void)draw(&p, &t, &m, &g, &lost);
                assert_true(lost <= 1);
                assert_true(t.slow != 2 || (g.level == 2 && g.scale <= 6));
                g = settles(&p, &t, &m, 20);
                assert_true(t.slow != 2 || (g.level == 2 && g.scale == 4));
            }
    t.slow = 2;
    view_pace p = {0};
    view_grade g = settles(&p, &t, &(model){1e-9, 0.6, 0.0, 8.0}, 60);
    assert_int_equal(g.scale, 1);
    assert_int_equal(g.level, 0);
    t.cells = 1.0; /* cells of level 1 are as large as pixels at scale 2 */
    p = (view_pace){0};
    g = settles(&p, &t, &(model){3e-8, 0.6, 0.0, 8.0}, 60);
    assert_int_equal(g.level, 1);
}

/* A picture that takes long beside other programs' work changes little. */
static void test_outlier(void **state) {
    (void)state;
    view_pace p = {0};
    const view_grade g = {2, 0};
    for (int i = 0; i < 20; i++)
        view_pace_learn(&p, &GRID, g, 0.02, 1.0);
    const double before = view_pace_seconds(&p, &GRID, g);
    view_pace_learn(&p, &GRID, g, 0.5, 1.0);
    assert_true(view_pace_seconds(&p, &GRID, g) > before);
    assert_true(view_pace_seconds(&p, &GRID, g) < 1.3 * before);
}

/* What was given up is tried again, while coarser levels are drawn. */
static void test_again(void **state) {
    (void)state;
    view_pace p = {0};
    const view_grade fine = {2, 0}, coarse = {2, 1};
    view_pace_learn(&p, &GRID, coarse, 0.01, 1.0);
    view_pace_learn(&p, &GRID, fine, 0.1, 0.05);
    view_pace_learn(&p, &GRID, coarse, 0.01, 1.0);
    const double before = view_pace_seconds(&p, &GRID, fine);
    assert_true(before > 0.028);
    for (int i = 0; i < 200; i++)
        view_pace_learn(&p, &GRID, coarse, 0.01, 1.0);
    assert_true(view_pace_seconds(&p, &GRID, fine) < 0.025);
}

static void test_small(void **state) {
    (void)state;
    view_pace p = {0};
    const view_task t = {
        .width = 1, .height = 1, .levels = 1, .cells = 1.0, .guess = 1e-6, .apart = 1.0};
    assert_true(view_pace_pixels(&t, (view_grade){16, 0}) == 1.0);
    assert_int_equal(view_pace_choose(&p, &t, BUDGET).scale, 1);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_quick),        cmocka_unit_test(test_fits),
        cmocka_unit_test(test_hopeless),     cmocka_unit_test(test_changes),
        cmocka_unit_test(test_held_up),      cmocka_unit_test(test_steady),
        cmocka_unit_test(test_levels),       cmocka_unit_test(test_no_levels),
        cmocka_unit_test(test_outlier),      cmocka_unit_test(test_again),
        cmocka_unit_test(test_tets),         cmocka_unit_test(test_small),
        cmocka_unit_test(test_quick_levels), cmocka_unit_test(test_slow_levels),
        cmocka_unit_test(test_thinned)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
