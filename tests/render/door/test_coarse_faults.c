/* test_coarse_faults.c - a preview whose coarse grid finds no memory is drawn without it, or
 * refused whole; the exact picture comes after either.
 */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "formats/base/fault.h"
#include "tests/support/coarse_subjects.h"
#include "tests/support/fixture.h"
#include "tests/support/pictures.h"
#include "tests/support/scratch.h"

static leafcast_status draw(leafcast *v, bool preview) {
    static picture p;
    leafcast_scene scene = leafcast_scene_default();
    scene.preview = preview;
    const leafcast_camera view = leafcast_standard_view(v, 1.3, PICTURE_WIDTH, PICTURE_HEIGHT);
    const leafcast_image image = {.size = sizeof image, .z = p.z, .provisional = p.provisional};
    return leafcast_trace(v, &scene, &view, &image, NULL, NULL, NULL);
}

/* The k-th allocation fails. Returns false if it never came. */
static bool fail_at(long k, int *drawn, int *refused) {
    const leafcast_surface s = leafcast_surface_default(0.4);
    leafcast *v = fixture_open(scratch_path("coarse.leaf"),
                               &(leafcast_options){.size = sizeof(leafcast_options), .threads = 1});
    assert_int_equal(leafcast_select(v, &s, 1), LEAFCAST_OK);
    fault_arm(FAULT_ALLOC, k);
    const leafcast_status st = draw(v, true);
    const bool fired = fault_fired(FAULT_ALLOC);
    fault_arm(FAULT_ALLOC, 0);
    assert_true(st == LEAFCAST_OK || st == LEAFCAST_NOMEM);
    *drawn += fired && st == LEAFCAST_OK;
    *refused += fired && st == LEAFCAST_NOMEM;
    assert_int_equal(draw(v, true), LEAFCAST_OK);
    assert_int_equal(draw(v, false), LEAFCAST_OK);
    leafcast_close(v);
    return fired;
}

static void test_no_memory(void **state) {
    (void)state;
    for (subject of = TETS; of < SUBJECTS; of++) {
        mem m;
        int drawn = 0, refused = 0;
        mem_init(&m, 0);
        coarse_subjects_make(&m, of, "coarse.leaf", NULL, true);
        for (long k = 1; fail_at(k, &drawn, &refused); k++)
            assert_true(k < 10000);
        assert_true(drawn > 5 && refused > 0);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_no_memory)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
