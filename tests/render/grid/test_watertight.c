/* test_watertight.c - the short form of the stress lab's closed surfaces and shadows: `make stress`
 * runs the same at length (tool_stress.c).
 *
 *   test_watertight                                          LEAFCAST_STRESS (20000) as the measure
 *   test_watertight leak FORM PLACING SEED RAY               one ray
 *   test_watertight leak FORM PLACING SEED picture SIDE      the pictures of one solid
 *   test_watertight shadow FORM PLACING SEED VIEWS SIDE ISA  its shadows
 */
/* marks: long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/cpu.h"
#include "tests/support/leak_lab.h"
#include "tests/support/shadow_lab.h"
#include "tests/support/solids.h"

/* Less where every access is watched. */
#if defined __SANITIZE_THREAD__ || defined __SANITIZE_ADDRESS__
enum { DEFAULT_COUNT = 3000 };
#else
enum { DEFAULT_COUNT = 20000 };
#endif

enum { SEED = 20, THREADS = 2, SIDE = 24, SHADOW_SIDE = 40, VIEWS = 2 };

static const char *program;
static mem memory;
static pool *threads;

static uint64_t stress_count(void) {
    const char *text = getenv("LEAFCAST_STRESS");
    return text ? strtoull(text, NULL, 10) : DEFAULT_COUNT;
}

static int start_threads(void **state) {
    (void)state;
    return pool_create(&memory, THREADS, &threads) != ST_OK;
}

static int stop_threads(void **state) {
    (void)state;
    pool_destroy(threads);
    return mem_used(&memory) != 0;
}

static void stop_early(uint64_t faults) {
    if (faults && getenv("LEAFCAST_STRESS_STOP"))
        exit(1);
}

static void nothing_sees_through(void **state) {
    (void)state;
    leak_tally all = {0};
    leak_tally_heading(stderr);
    for (int which = 0; which < solid_count(); which++) {
        leak_tally sum = {0};
        for (int placing = 0; placing < placing_count(); placing++) {
            const leak_lab_job job = {
                .which = which,
                .placing = placing,
                .seed = SEED + (uint64_t)placing,
                .rays = stress_count() / 100,
                /* Pictures of each form in some placings, of each placing some forms. */
                .side = (which + placing) % 3 == 0 ? SIDE : 0,
                .rerun = program,
                .log = stderr,
            };
            leak_tally one;
            if (leak_lab_run(threads, &job, &one) != ST_OK)
                fail_msg("%s", status_text());
            leak_tally_add(&sum, &one);
            stop_early(leak_tally_faults(&one));
        }
        leak_tally_row(stderr, solid_name(which), &sum);
        leak_tally_add(&all, &sum);
    }
    assert_int_equal(leak_tally_faults(&all), 0);
    assert_true(all.excused < all.rays / 100);
    assert_true(all.pixels > 10000);
}

static void shadows_are_others(void **state) {
    (void)state;
    shadow_tally all = {0};
    shadow_tally_heading(stderr);
    for (int which = 0; which < solid_count(); which++) {
        shadow_tally sum = {0};
        for (int placing = 0; placing < placing_count(); placing++) {
            const shadow_lab_job job = {
                .which = which,
                .placing = placing,
                .seed = SEED + (uint64_t)placing,
                .views = VIEWS,
                .side = SHADOW_SIDE,
                .isa = cpu_isa_name((cpu_isa)(placing % ((int)cpu_best() + 1))),
                .rerun = program,
                .log = stderr,
            };
            shadow_tally one;
            if (shadow_lab_run(&job, &one) != ST_OK)
                fail_msg("%s", status_text());
            shadow_tally_add(&sum, &one);
            stop_early(shadow_tally_faults(&one));
        }
        shadow_tally_row(stderr, solid_name(which), &sum);
        shadow_tally_add(&all, &sum);
    }
    assert_int_equal(shadow_tally_faults(&all), 0);
    /* It did see what it is about. */
    assert_true(all.facing > 5000 && all.walled > 10000);
    assert_true(all.shaded > 1000 && all.judged - all.shaded > 1000);
    assert_true(all.unclear < all.judged / 20);
}

int main(int argc, char **argv) {
    program = argv[0];
    if (argc > 1)
        return strcmp(argv[1], "leak") == 0     ? leak_lab_rerun(argc - 2, argv + 2)
               : strcmp(argv[1], "shadow") == 0 ? shadow_lab_rerun(argc - 2, argv + 2)
                                                : 2;
    mem_init(&memory, 0);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_sees_through),
        cmocka_unit_test(shadows_are_others),
    };
    return cmocka_run_group_tests(tests, start_threads, stop_threads);
}
