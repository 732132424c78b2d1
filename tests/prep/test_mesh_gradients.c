/* test_mesh_gradients.c - gradients at the vertices of meshes: against plain sums in long double;
 * the same bits whatever is held, and by however many threads.
 */
/* marks: threads, long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/fault.h"
#include "prep/mesh/mesh_gradients.h"
#include "tests/support/fields.h"
#include "tests/support/mesh_cases.h"
#include "tests/support/mesh_truth.h"
#include "tests/support/scratch.h"

static mem m;

/* ---- ours ---- */

/* How a case is gone through. */
typedef struct way {
    int threads;
    bool spilled;        /* points and values are in files, seen through the smallest windows */
    uint64_t band;       /* vertices; 0: all */
    size_t some;         /* tets added at a time */
    size_t point, value; /* so many of other steps and sets come before */
} way;

static status fill(mesh_spool *s, const void *from, size_t count, size_t before, bool spilled) {
    static const char other[12];
    status st = ST_OK;
    for (size_t i = 0; st == ST_OK && i < before; i++)
        st = mesh_spool_append(s, other, 1);
    if (st == ST_OK)
        st = mesh_spool_append(s, from, count);
    if (st == ST_OK && spilled)
        st = mesh_spool_spill(s);
    return st;
}

static status pass(mesh_gradients *g, const mesh_case *c, const mesh_record *records, const way *w,
                   mesh_spool *to) {
    const size_t some = w->some;
    status st = ST_OK;
    for (uint64_t band = 0; st == ST_OK && band < mesh_gradients_bands(g); band++) {
        mesh_gradients_begin(g, band, w->point, w->value);
        for (size_t at = 0; st == ST_OK && at < c->tet_count; at += some)
            st = mesh_gradients_add(g, records + at,
                                    c->tet_count - at < some ? c->tet_count - at : some);
        if (st == ST_OK)
            st = mesh_gradients_end(g, to);
    }
    return st;
}

/* The case's gradients, which are as many as its points; within what the plan says. */
static status gradients_of(const mesh_case *c, const way *w, float (*out)[3]) {
    mesh_spool points, values, to;
    pool *workers = NULL;
    mesh_gradients *g = NULL;
    mesh_record *records = calloc(c->tet_count, sizeof *records);
    for (size_t t = 0; t < c->tet_count; t++)
        memcpy(records[t].id, c->tets[t], sizeof records[t].id);
    mesh_spool_init(&points, &m, scratch_path("points"), sizeof(float[3]), 0);
    mesh_spool_init(&values, &m, scratch_path("values"), sizeof(float), 0);
    mesh_spool_init(&to, &m, scratch_path("gradients"), sizeof(float[3]), 0);
    status st = pool_create(&m, w->threads, &workers);
    if (st == ST_OK)
        st = fill(&points, c->points, c->point_count, w->point, w->spilled);
    if (st == ST_OK)
        st = fill(&values, c->values, c->point_count, w->value, w->spilled);
    const uint64_t room = w->spilled ? 0 : UINT64_C(1) << 40;
    mesh_gradients_plan plan =
        mesh_gradients_plan_make(&points, &values, c->point_count, w->spilled, w->threads, room);
    if (w->band)
        plan.band = w->band;
    const size_t before = mem_used(&m);
    if (st == ST_OK)
        st = mesh_gradients_create(&m, workers, &points, &values, c->point_count, &plan, &g);
    assert_true(mem_used(&m) - before <= mesh_gradients_memory(&plan, w->threads));
    if (st == ST_OK)
        st = pass(g, c, records, w, &to);
    if (st == ST_OK) {
        assert_int_equal(to.count, c->point_count);
        st = mesh_spool_read(&to, 0, c->point_count, out);
    }
    mesh_gradients_destroy(g);
    mesh_spool_release(&points);
    mesh_spool_release(&values);
    mesh_spool_release(&to);
    pool_destroy(workers);
    free(records);
    assert_int_equal(mem_used(&m), 0);
    return st;
}

/* ---- the truth ---- */

static void check_truth(const mesh_case *c, const float (*got)[3]) {
    mesh_truth *all = mesh_truth_gradients(c);
    size_t known = 0;
    for (size_t i = 0; i < c->point_count; i++) {
        known += all[i].volume > 0;
        mesh_truth_check(&all[i], got[i], i);
    }
    assert_true(known > c->point_count / 2);
    free(all);
}

static void test_truth(void **state) {
    (void)state;
    static const way ways[] = {{1, false, 0, 1u << 20, 0, 0}, {4, false, 0, 777, 0, 5},
                               {3, true, 0, 5000, 700, 2100}, {2, true, 7, 9001, 0, 0},
                               {7, false, 600, 1, 9, 0},      {2, false, 1, 1u << 20, 0, 0}};
    for (int kind = 0; kind < 4; kind++) {
        mesh_case c = kind < 2 ? mesh_cases_kuhn(9, 8, 4 + kind)
                               : mesh_cases_soup(700, 5000, FIELD_SEED + (uint64_t)kind);
        float(*first)[3] = malloc(c.point_count * sizeof *first);
        float(*other)[3] = malloc(c.point_count * sizeof *other);
        if (kind % 2)
            mesh_cases_shuffle(&c, FIELD_SEED);
        for (size_t i = 0; i < sizeof ways / sizeof *ways; i++) {
            assert_int_equal(gradients_of(&c, &ways[i], i ? other : first), ST_OK);
            if (i)
                assert_memory_equal(first, other, c.point_count * sizeof *first);
        }
        check_truth(&c, (const float(*)[3])first);
        mesh_cases_free(&c);
        free(first);
        free(other);
    }
}

/* ---- what can be said exactly ---- */

static const way plain = {2, false, 0, 1u << 20, 0, 0};

/* Numbers that doubles hold: not a bit is lost, at the border neither. */
static void test_linear(void **state) {
    (void)state;
    static const float want[3] = {3, -5, 0.25F};
    static float got[1000][3];
    mesh_case c = mesh_cases_kuhn(6, 7, 8);
    for (size_t i = 0; i < c.point_count; i++) {
        c.points[i][0] += 0.125F * c.points[i][1];
        c.values[i] = 7;
        for (int a = 0; a < 3; a++)
            c.values[i] += want[a] * c.points[i][a];
    }
    assert_true(c.point_count <= 1000);
    assert_int_equal(gradients_of(&c, &plain, got), ST_OK);
    for (size_t i = 0; i < c.point_count; i++)
        assert_memory_equal(got[i], want, sizeof want);
    mesh_cases_free(&c);
}

/* Flat tets and such with missing values have no say; who hears nobody has no gradient. */
static void test_no_say(void **state) {
    (void)state;
    static float got[1000][3];
    mesh_case c = mesh_cases_kuhn(1, 1, 3);
    const float none[3] = {0, 0, 0}, up[3] = {0, 0, 1};
    for (size_t i = 0; i < c.point_count; i++)
        c.values[i] = c.points[i][2];
    /* The uppermost layer is flat, with values that would pull. */
    for (size_t i = 12; i < 16; i++) {
        c.points[i][2] = 2;
        c.values[i] = 1000;
    }
    assert_int_equal(gradients_of(&c, &plain, got), ST_OK);
    for (size_t i = 0; i < 12; i++)
        assert_memory_equal(got[i], up, sizeof up);
    for (size_t i = 12; i < 16; i++)
        assert_memory_equal(got[i], none, sizeof none);
    /* Corner 0 belongs to all six tets of its cell. */
    c.values[0] = NAN;
    assert_int_equal(gradients_of(&c, &plain, got), ST_OK);
    for (size_t i = 0; i < 4; i++)
        assert_memory_equal(got[i], none, sizeof none);
    for (size_t i = 4; i < 12; i++)
        assert_memory_equal(got[i], up, sizeof up);
    c.values[0] = -INFINITY;
    assert_int_equal(gradients_of(&c, &plain, got), ST_OK);
    assert_memory_equal(got[3], none, sizeof none);
    mesh_cases_free(&c);
}

/* Larger than a float: scaled, not infinite, and the direction is kept. Far away: exact. */
static void test_extremes(void **state) {
    (void)state;
    static float got[1000][3];
    mesh_case c = mesh_cases_kuhn(2, 2, 2);
    for (size_t i = 0; i < c.point_count; i++) {
        c.values[i] = 0x1p120F * (c.points[i][0] - 2 * c.points[i][2]);
        for (int a = 0; a < 3; a++)
            c.points[i][a] *= 0x1p-60F;
    }
    assert_int_equal(gradients_of(&c, &plain, got), ST_OK);
    for (size_t i = 0; i < c.point_count; i++) {
        assert_true(got[i][0] > 0.1F * FLT_MAX && isfinite(got[i][0]));
        assert_true(got[i][1] == 0 && !signbit(got[i][1]) && got[i][2] == -2 * got[i][0]);
    }
    for (size_t i = 0; i < c.point_count; i++) {
        c.values[i] = 3 * c.points[i][0] * 0x1p60F;
        for (int a = 0; a < 3; a++)
            c.points[i][a] = c.points[i][a] * 0x1p60F + 0x1p20F;
    }
    assert_int_equal(gradients_of(&c, &plain, got), ST_OK);
    for (size_t i = 0; i < c.point_count; i++)
        assert_true(got[i][0] == 3 && got[i][1] == 0 && got[i][2] == 0);
    mesh_cases_free(&c);
}

static void test_faults(void **state) {
    (void)state;
    static float got[1000][3];
    const way spilled = {3, true, 100, 2000, 0, 0};
    mesh_case c = mesh_cases_kuhn(7, 8, 6);
    for (fault_kind kind = FAULT_ALLOC; kind < FAULT_KINDS; kind++) {
        long k = 0;
        for (bool fired = true; fired;) {
            fault_arm(kind, ++k);
            const status st = gradients_of(&c, &spilled, got);
            fired = fault_fired(kind);
            fault_arm(kind, 0);
            assert_true((st == ST_OK) == !fired);
            assert_true(st == ST_OK || *status_text());
        }
        assert_true(k > 1);
    }
    mesh_cases_free(&c);
}

static int set_up(void **state) {
    (void)state;
    mem_init(&m, 0);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(test_truth, set_up),  cmocka_unit_test_setup(test_linear, set_up),
        cmocka_unit_test_setup(test_no_say, set_up), cmocka_unit_test_setup(test_extremes, set_up),
        cmocka_unit_test_setup(test_faults, set_up),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
