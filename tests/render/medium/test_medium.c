/* test_medium.c - pictures of media through hostile volumes with hostile transfer functions: every
 * channel of every pixel within its own bound, and that within the one asked for.
 *
 *   test_medium                       LEAFCAST_STRESS (1) pictures of each volume and kind, from
 *                                     LEAFCAST_SEED (1) on
 *   test_medium NAME                  one of the tests below; * is any text
 *   test_medium VOLUME KIND SEED      one picture, every pixel
 */
/* marks: threads, long, plain */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/cpu.h"
#include "tests/support/medium_lab.h"
#include "tests/support/watched.h"

enum { EVERY = WATCHED ? 27 : 1, EVERY_BITS = WATCHED ? 99 : 17 };

static const char *program;

static uint64_t number_of(const char *name) {
    const char *text = getenv(name);
    return text ? strtoull(text, NULL, 10) : 1;
}

/* By turns the kernels of this CPU and the scalar ones. */
static const leafcast_options with[2] = {
    {.size = sizeof(leafcast_options), .threads = 2},
    {.size = sizeof(leafcast_options), .threads = 2, .isa = "scalar"}};

/* Mutants are those of the scalar code. */
static const leafcast_options *options_of(int body) {
    return &with[getenv("LEAFCAST_STRESS_STOP") ? 1 : body % 2];
}

static void stop_at(const medium_tally *t) {
    if (medium_tally_faults(t) > 0 && getenv("LEAFCAST_STRESS_STOP"))
        exit(1);
}

/* Where rounding alone may be more than any bound. */
static bool is_hopeless(const char *kind) {
    static const char *const hopeless[] = {"needles",  "splinters", "huge", "opaque", "steps",
                                           "extremes", "leaning",   "grey", "many"};
    for (size_t i = 0; i < sizeof hopeless / sizeof *hopeless; i++)
        if (strcmp(kind, hopeless[i]) == 0)
            return true;
    return false;
}

/* All kinds of transfer functions in one volume. */
static void check_body(int index, medium_tally *all) {
    medium_body b;
    medium_tally of_body = {0};
    medium_body_make(&b, index, options_of(index));
    for (int kind = 0; kind < hostile_transfer_kinds(); kind++) {
        medium_tally t = {0};
        for (uint64_t i = 0; i < number_of("LEAFCAST_STRESS"); i++) {
            const uint64_t seed = (number_of("LEAFCAST_SEED") + i) * 1000 + (uint64_t)kind;
            medium_lab_draw(&(medium_job){&b, NULL, kind, seed, program, false}, &t);
        }
        if (medium_tally_faults(&t) > 0)
            medium_tally_print(b.name, hostile_transfer_name(kind), &t);
        if (b.tame && !is_hopeless(hostile_transfer_name(kind)) && t.needless > 0) {
            fprintf(stderr, "# %s, %s: %llu refused without need\n", b.name,
                    hostile_transfer_name(kind), (unsigned long long)t.needless);
            t.loose++;
        }
        stop_at(&t);
        medium_tally_add(&of_body, &t);
    }
    medium_tally_print(b.name, "all", &of_body);
    medium_tally_add(all, &of_body);
    medium_body_release(&b);
}

static void test_within_the_bound(void **state) {
    (void)state;
    skip_under_thread();
    medium_tally all = {0};
    for (int i = 0; i < medium_body_count(); i += getenv("LEAFCAST_STRESS_STOP") ? 8 : EVERY)
        check_body(i, &all);
    medium_tally_print("all", "all", &all);
    if (medium_tally_faults(&all) > 0)
        fail_msg("%llu faults", (unsigned long long)medium_tally_faults(&all));
    assert_true(all.seen > all.rays / 4);
    assert_true(all.grazing < all.rays / 100);
    assert_true(all.worst > 0.01);
}

/* ---- The same bits ---- */

static void draw_with(medium_body *b, const leafcast_options *o, int kind, medium_planes *planes) {
    assert_int_equal(medium_body_reopen(b, o), LEAFCAST_OK);
    assert_int_equal(medium_lab_planes(&(medium_job){b, NULL, kind, 7, program, false}, planes),
                     LEAFCAST_OK);
}

static void check_same(const medium_body *b, int kind, const char *how, const medium_planes *want,
                       const medium_planes *got) {
    for (int i = 0; i < MEDIUM_PIXELS; i++)
        if (memcmp(want->rgba[i], got->rgba[i], sizeof got->rgba[i]) != 0 ||
            memcmp(&want->error[i], &got->error[i], sizeof got->error[i]) != 0)
            fail_msg("%s, %s, %s, pixel %d: %a %a %a %a, bound %a, not %a %a %a %a, bound %a",
                     b->name, hostile_transfer_name(kind), how, i, got->rgba[i][0], got->rgba[i][1],
                     got->rgba[i][2], got->rgba[i][3], got->error[i], want->rgba[i][0],
                     want->rgba[i][1], want->rgba[i][2], want->rgba[i][3], want->error[i]);
}

/* Less and less memory, until it is too little. Returns how many budgets did. */
static int check_budgets(medium_body *b, int kind, const medium_planes *want) {
    static medium_planes got;
    leafcast_options o = {.size = sizeof o, .memory = 32 << 20, .threads = 2};
    for (int count = 0;; count++) {
        if (WATCHED && count == 2) /* with less, treelets come and go for long */
            return count;
        leafcast_status st = medium_body_reopen(b, &o);
        if (st == LEAFCAST_OK)
            st = medium_lab_planes(&(medium_job){b, NULL, kind, 7, program, false}, &got);
        if (st == LEAFCAST_NOMEM)
            return count;
        assert_int_equal(st, LEAFCAST_OK);
        check_same(b, kind, "little memory", want, &got);
        o.memory /= 2;
    }
}

/* Whatever the kernels, the threads, the memory. */
static void check_bits(int index) {
    static medium_planes want, got;
    medium_body b;
    medium_body_make(&b, index, NULL);
    for (int kind = index % 3; kind < hostile_transfer_kinds(); kind += WATCHED ? 9 : 3) {
        const leafcast_options one = {.size = sizeof one, .isa = "scalar", .threads = 1};
        draw_with(&b, &one, kind, &want);
        for (int isa = WATCHED_THREADS ? (int)cpu_best() : 0; isa <= (int)cpu_best(); isa++)
            for (int threads = WATCHED_THREADS ? 2 : 1; threads <= 2; threads++) {
                const leafcast_options o = {
                    .size = sizeof o, .isa = cpu_isa_name((cpu_isa)isa), .threads = threads};
                draw_with(&b, &o, kind, &got);
                check_same(&b, kind, o.isa, &want, &got);
            }
        assert_true(check_budgets(&b, kind, &want) > 1);
    }
    medium_body_release(&b);
}

static void test_same_bits(void **state) {
    (void)state;
    if (getenv("LEAFCAST_STRESS_STOP"))
        skip(); /* wrong on purpose, in the scalar code alone: that is found without this */
    for (int i = 1; i < medium_body_count(); i += EVERY_BITS)
        check_bits(i);
}

static int rerun(char **argv) {
    const int kind = atoi(argv[1]);
    for (int i = 0; i < medium_body_count(); i++) {
        if (strcmp(medium_body_name(i), argv[0]) != 0)
            continue;
        medium_body b;
        medium_tally t = {0};
        medium_body_make(&b, i, options_of(i));
        medium_lab_draw(&(medium_job){&b, NULL, kind, strtoull(argv[2], NULL, 10), program, true},
                        &t);
        medium_tally_print(b.name, hostile_transfer_name(kind), &t);
        medium_body_release(&b);
        return medium_tally_faults(&t) > 0;
    }
    return 2;
}

int main(int argc, char **argv) {
    program = argv[0];
    if (argc == 4)
        return rerun(argv + 1);
    if (argc == 2)
        cmocka_set_test_filter(argv[1]);
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_within_the_bound),
                                       cmocka_unit_test(test_same_bits)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
