/* test_tet_kernel_lab.c - the tetrahedron kernel on hostile meshes, against the reference; at
 * length: tool_tet_stress. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

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

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(kernel_sees_what_is_there)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
