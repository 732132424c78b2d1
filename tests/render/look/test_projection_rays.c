/* test_projection_rays.c - projections of hostile volumes against the reference: every value, and
 * where it is.
 *
 *   test_projection_rays                    LEAFCAST_STRESS (1) pictures of each volume and kind,
 *                                           from LEAFCAST_SEED (1) on
 *   test_projection_rays VOLUME KIND SEED   one picture, every pixel; KIND: a leafcast_project
 */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/medium_lab.h"

static const char *program;

static uint64_t number_of(const char *name) {
    const char *text = getenv(name);
    return text ? strtoull(text, NULL, 10) : 1;
}

static const leafcast_options two_threads = {.size = sizeof two_threads, .threads = 2};

static void check_body(int index, medium_tally *all) {
    medium_body b;
    medium_tally t = {0};
    medium_body_make(&b, index, &two_threads);
    for (int kind = LEAFCAST_PROJECT_MAX; kind <= (int)LEAFCAST_PROJECT_FIRST; kind++)
        for (uint64_t n = 0; n < number_of("LEAFCAST_STRESS"); n++) {
            const uint64_t seed = (number_of("LEAFCAST_SEED") + n) * 1000 + (uint64_t)kind;
            medium_lab_project(&(medium_job){&b, NULL, kind, seed, program, false}, &t);
        }
    medium_tally_print(b.name, "projected", &t);
    if (medium_tally_faults(&t) > 0 && getenv("LEAFCAST_STRESS_STOP"))
        exit(1);
    medium_tally_add(all, &t);
    medium_body_release(&b);
}

static void test_projections(void **state) {
    (void)state;
    medium_tally all = {0};
    for (int i = 0; i < medium_body_count(); i++)
        check_body(i, &all);
    assert_int_equal(medium_tally_faults(&all), 0);
    assert_true(all.seen > all.rays / 4);
    assert_true(all.grazing < all.rays / 100);
}

static int rerun(char **argv) {
    for (int i = 0; i < medium_body_count(); i++) {
        if (strcmp(medium_body_name(i), argv[0]) != 0)
            continue;
        medium_body b;
        medium_tally t = {0};
        medium_body_make(&b, i, &two_threads);
        const medium_job job = {&b,      NULL, atoi(argv[1]), strtoull(argv[2], NULL, 10),
                                program, true};
        medium_lab_project(&job, &t);
        medium_tally_print(b.name, "projected", &t);
        medium_body_release(&b);
        return medium_tally_faults(&t) > 0;
    }
    return 2;
}

int main(int argc, char **argv) {
    program = argv[0];
    if (argc == 4)
        return rerun(argv + 1);
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_projections)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
