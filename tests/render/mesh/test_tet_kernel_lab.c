/* test_tet_kernel_lab.c - the tetrahedron kernel on hostile meshes, against the reference; at
 * length: tool_tet_stress. */
/* marks: long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/support/tet_lab.h"
#include "tests/support/tet_meshes.h"

enum { RAYS = 1500, SEED = 7 }; /* $LEAFCAST_STRESS: other than RAYS */

static void kernel_sees_what_is_there(void **state) {
    (void)state;
    const char *wanted = getenv("LEAFCAST_STRESS");
    const uint64_t rays = wanted ? strtoull(wanted, NULL, 10) : RAYS;
    tet_lab_row all = {0};
    tet_lab_heading(stdout);
    for (int which = 0; which < lab_mesh_count(); which++) {
        tet_lab_row row;
        const tet_lab_job job = {.which = which,
                                 .seed = SEED,
                                 .count = rays,
                                 .rerun = "build/release/tests/tool_tet_stress",
                                 .log = stdout};
        tet_lab_run(&job, &row);
        tet_lab_print(stdout, lab_mesh_name(which), &row);
        tet_lab_add(&all, &row);
        if (tet_lab_faults(&row))
            fail_msg("%s: %llu faults", lab_mesh_name(which),
                     (unsigned long long)tet_lab_faults(&row));
    }
    tet_lab_print(stdout, "all", &all);
    /* It was put to the test: surfaces, of closed ones too, and few excuses. */
    assert_true(all.tally.hits > rays * 10);
    assert_true(all.stopped > rays);
    assert_true(all.tally.grazing * 20 < all.tally.rays);
    assert_true(all.touches * 500 < all.tally.rays);
}

static int case_of(const char *name) {
    int which = 0;
    while (strcmp(lab_mesh_name(which), name) != 0)
        which++;
    return which;
}

/* Rays that the judge, not the kernel, was wrong about. */
static void judge_was_wrong(void **state) {
    (void)state;
    static const struct {
        const char *name;
        uint64_t index;
    } rays[] = {
        /* along an edge at the rim of a hole of less than 45 degrees */
        {"holes", 8897},
        {"holes", 15692},
        {"holes", 18095},
        /* in a face between what is 1e-31 above iso and what falls to -1e29 */
        {"wild", 14217},
        /* through a tetrahedron by a way of no length: either side */
        {"plateau-turned", 30732},
    };
    for (size_t i = 0; i < sizeof rays / sizeof rays[0]; i++) {
        tet_lab_row row;
        const tet_lab_job job = {.which = case_of(rays[i].name),
                                 .seed = 5,
                                 .first = rays[i].index,
                                 .count = 1,
                                 .rerun = "build/release/tests/tool_tet_stress",
                                 .log = stdout};
        tet_lab_run(&job, &row);
        assert_int_equal(row.tally.rays, 1);
        assert_int_equal(tet_lab_faults(&row), 0);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(kernel_sees_what_is_there),
                                       cmocka_unit_test(judge_was_wrong)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
