/* test_coarse_levels.c - which levels of detail previews have, and which of these are of the
 * volume's kind of cells.
 */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdlib.h>

#include "tests/support/coarse_subjects.h"
#include "tests/support/curvilinear_steps.h"
#include "tests/support/fixture.h"
#include "tests/support/scratch.h"

static mem m;

static void convert(const curvilinear_zone *zone, const char *name) {
    curvilinear_steps s;
    curvilinear_result r;
    const curvilinear_options o = {.file = leaf_parameters_default(),
                                   .memory = UINT64_C(1) << 30,
                                   .threads = 2,
                                   .force = true,
                                   .coarse = true};
    curvilinear_steps_init(&s, zone, 1, 1, 1);
    if (curvilinear_convert(&m, &s.series, "g", scratch_path(name), &o, NULL, &r) != ST_OK)
        fail_msg("%s", status_text());
}

/* ---- What is told ---- */

static void check_info(const char *path, uint32_t preview_levels, uint32_t cell_levels) {
    leafcast *v = fixture_open(path, NULL);
    const leafcast_info info = leafcast_describe(v);
    assert_int_equal(info.preview_levels, preview_levels);
    assert_int_equal(info.cell_levels, cell_levels);
    leafcast_close(v);
}

/* A ring whose nodes that are left lie in a plane: no regular grid is made of it. */
static void make_ring(const char *name) {
    static const float around[5][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}, {1, 0}};
    float p[5 * 3 * 3][3], values[5 * 3 * 3];
    const curvilinear_zone zone = {.nodes = {5, 3, 3}, .p = (const float(*)[3])p, .values = values};
    for (int n = 0; n < 5 * 3 * 3; n++) {
        const float radius = 1.0F + (float)(n / 5 % 3);
        p[n][0] = radius * around[n % 5][0];
        p[n][1] = radius * around[n % 5][1];
        p[n][2] = (float)(n / 15);
        values[n] = radius;
    }
    convert(&zone, name);
}

static void test_told(void **state) {
    (void)state;
    for (subject of = TETS; of < SUBJECTS; of++) {
        coarse_subjects_make(&m, of, "plain.leaf", NULL, false);
        coarse_subjects_make(&m, of, "coarse.leaf", NULL, true);
        check_info(scratch_path("plain.leaf"), 1, 1);
        check_info(scratch_path("coarse.leaf"), of == THINNED ? 4 : 3, of == THINNED ? 2 : 1);
    }
    make_ring("ring.leaf");
    check_info(scratch_path("ring.leaf"), 2, 2);
    field f;
    assert_true(field_make(&f, "waves", 40, FIELD_SEED));
    check_info(fixture_leaf(&f, 4, 1, false), 3, 3); /* coarse grids are of its own kind */
    field_release(&f);
    assert_int_equal(leafcast_describe(NULL).cell_levels, 0);
}

int main(void) {
    mem_init(&m, 0);
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_told)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
