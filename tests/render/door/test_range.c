/* test_range.c - leafcast_range(): the values of one field at one step, against the values that the
 * file was made of.
 */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>

#include "tests/support/fixture.h"
#include "tests/support/mesh_leaves.h"

enum { FIELDS = 3, STEPS = 3, CELLS = 5, SEED = 23 };

/* Each set gets an extent of its own. */
static void spread(mesh_case *c, uint32_t set) {
    float *values = c->values + set * c->points;
    for (size_t p = 0; p < c->points; p++)
        values[p] = values[p] * (float)(set + 1) - 10.0f * (float)set;
}

static void check_mesh(int non_finite, const char *name) {
    mesh_case c = mesh_leaves_cube(CELLS, FIELDS, STEPS, SEED, non_finite);
    for (uint32_t set = 0; set < FIELDS * STEPS; set++)
        spread(&c, set);
    leafcast *v = fixture_open(mesh_leaves_make(&c, name), NULL);
    for (uint32_t set = 0; set < FIELDS * STEPS; set++) {
        double range[2] = {0, 0}, lo = INFINITY, hi = -INFINITY;
        for (size_t p = set * c.points; p < (set + 1) * c.points; p++) {
            lo = isfinite(c.values[p]) ? fmin(lo, (double)c.values[p]) : lo;
            hi = isfinite(c.values[p]) ? fmax(hi, (double)c.values[p]) : hi;
        }
        assert_true(lo < hi);
        assert_int_equal(leafcast_range(v, set / STEPS, set % STEPS, range), LEAFCAST_OK);
        assert_true(range[0] == lo && range[1] == hi);
    }
    leafcast_close(v);
    mesh_leaves_release(&c);
}

static void test_mesh(void **state) {
    (void)state;
    check_mesh(0, "range.leaf");
    check_mesh(7, "range_holes.leaf");
}

static void test_nothing_finite(void **state) {
    (void)state;
    double range[2];
    mesh_case c = mesh_leaves_cube(CELLS, 2, 1, SEED, 0);
    for (size_t p = c.points; p < 2 * c.points; p++)
        c.values[p] = NAN;
    leafcast *v = fixture_open(mesh_leaves_make(&c, "range_none.leaf"), NULL);
    assert_int_equal(leafcast_range(v, 0, 0, range), LEAFCAST_OK);
    assert_true(range[0] < range[1]);
    assert_int_equal(leafcast_range(v, 1, 0, range), LEAFCAST_OK);
    assert_true(range[0] > range[1]);
    leafcast_close(v);
    mesh_leaves_release(&c);
}

static void test_no_such_set(void **state) {
    (void)state;
    double range[2] = {1, 2};
    mesh_case c = mesh_leaves_cube(CELLS, FIELDS, STEPS, SEED, 0);
    leafcast *v = fixture_open(mesh_leaves_make(&c, "range_set.leaf"), NULL);
    assert_int_equal(leafcast_range(v, FIELDS, 0, range), LEAFCAST_USAGE);
    assert_int_equal(leafcast_range(v, 0, STEPS, range), LEAFCAST_USAGE);
    assert_true(range[0] == 1 && range[1] == 2);
    leafcast_close(v);
    mesh_leaves_release(&c);
}

static void test_grid(void **state) {
    (void)state;
    field f;
    assert_true(field_make(&f, "sphere", 40, FIELD_SEED));
    leafcast *v = fixture_open(fixture_leaf(&f, 4, 1, false), NULL);
    const leafcast_info info = leafcast_describe(v);
    double range[2];
    assert_int_equal(leafcast_range(v, 0, 0, range), LEAFCAST_OK);
    assert_true(range[0] == info.value_min && range[1] == info.value_max);
    leafcast_close(v);
    field_release(&f);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_mesh), cmocka_unit_test(test_nothing_finite),
        cmocka_unit_test(test_no_such_set), cmocka_unit_test(test_grid)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
