/* test_medium.c - pictures of media through hostile volumes with hostile transfer functions: every
 * channel of every pixel within its own bound, and that within the one asked for.
 *
 *   test_medium                       LEAFCAST_STRESS (1) pictures of each volume and kind
 *   test_medium VOLUME KIND SEED      one picture, every pixel
 */
/* marks: threads, long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/medium_lab.h"

enum { SEED = 1 };

static const char *program;

static uint64_t stress_count(void) {
    const char *text = getenv("LEAFCAST_STRESS");
    return text ? strtoull(text, NULL, 10) : 1;
}

static const leafcast_options two_threads = {.size = sizeof two_threads, .threads = 2};

/* Where rounding alone may be more than any bound. */
static bool is_hopeless(const char *kind) {
    static const char *const hopeless[] = {"needles", "splinters", "huge",
                                           "opaque",  "steps",     "many"};
    for (size_t i = 0; i < sizeof hopeless / sizeof *hopeless; i++)
        if (strcmp(kind, hopeless[i]) == 0)
            return true;
    return false;
}

/* All kinds of transfer functions in one volume. */
static void check_body(int index, medium_tally *all) {
    medium_body b;
    medium_tally of_body = {0};
    medium_body_make(&b, index, &two_threads);
    for (int kind = 0; kind < hostile_transfer_kinds(); kind++) {
        medium_tally t = {0};
        for (uint64_t i = 0; i < stress_count(); i++) {
            const uint64_t seed = SEED + i * 1000 + (uint64_t)kind;
            medium_lab_draw(&(medium_job){&b, kind, seed, program, false}, &t);
        }
        if (medium_tally_faults(&t) > 0)
            medium_tally_print(b.name, hostile_transfer_name(kind), &t);
        if (b.tame && !is_hopeless(hostile_transfer_name(kind)) && t.refused > 0) {
            fprintf(stderr, "# %s, %s: %llu refused without need\n", b.name,
                    hostile_transfer_name(kind), (unsigned long long)t.refused);
            t.loose++;
        }
        medium_tally_add(&of_body, &t);
    }
    medium_tally_print(b.name, "all", &of_body);
    medium_tally_add(all, &of_body);
    medium_body_release(&b);
}

static void test_within_the_bound(void **state) {
    (void)state;
    medium_tally all = {0};
    for (int i = 0; i < medium_body_count(); i++)
        check_body(i, &all);
    medium_tally_print("all", "all", &all);
    if (medium_tally_faults(&all) > 0)
        fail_msg("%llu faults", (unsigned long long)medium_tally_faults(&all));
    assert_true(all.seen > all.rays / 4);
    assert_true(all.grazing < all.rays / 100);
    assert_true(all.worst > 0.01);
}

static int rerun(char **argv) {
    for (int i = 0; i < medium_body_count(); i++) {
        if (strcmp(medium_body_name(i), argv[0]) != 0)
            continue;
        medium_body b;
        medium_tally t = {0};
        medium_body_make(&b, i, &two_threads);
        medium_lab_draw(
            &(medium_job){&b, atoi(argv[1]), strtoull(argv[2], NULL, 10), program, true}, &t);
        medium_tally_print(b.name, hostile_transfer_name(atoi(argv[1])), &t);
        medium_body_release(&b);
        return medium_tally_faults(&t) > 0;
    }
    return 2;
}

int main(int argc, char **argv) {
    program = argv[0];
    if (argc == 4)
        return rerun(argv + 1);
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_within_the_bound)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
