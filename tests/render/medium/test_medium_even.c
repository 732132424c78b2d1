/* test_medium_even.c - a cell whose samples are all equal has that value, to the bit: a step of the
 * transfer function just there leaves no doubt. And no bound exceeds what is possible at all.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "tests/support/medium_lab.h"

enum { NODES = 25, BLOCK = 5, SEEDS = 6 };

/* Cubes of 5^3 nodes, each of one of four values. */
static void make_plateaus(medium_body *b) {
    static const uint8_t of[4] = {60, 120, 30, 200};
    static uint8_t samples[NODES * NODES * NODES];
    static const long dims[3] = {NODES, NODES, NODES};
    uint8_t *out = samples;
    for (int z = 0; z < NODES; z++)
        for (int y = 0; y < NODES; y++)
            for (int x = 0; x < NODES; x++)
                *out++ = of[(x / BLOCK + 2 * (y / BLOCK) + 3 * (z / BLOCK)) % 4];
    medium_body_of_bytes(b, "plateaus", dims, samples);
}

static void test_steps_at_plateaus(void **state) {
    static const leafcast_transfer_point points[] = {
        {0.0, {0.0, 0.0, 0.0}, 0.0},   {60.0, {0.1, 0.2, 0.3}, 0.0},
        {60.0, {0.9, 0.5, 0.1}, 0.05}, {120.0, {0.2, 0.9, 0.4}, 0.05},
        {120.0, {0.9, 0.1, 0.9}, 0.3}, {255.0, {1.0, 1.0, 1.0}, 0.3}};
    const leafcast_medium medium = {points, sizeof points / sizeof *points};
    static medium_planes planes;
    double off[MEDIUM_PIXELS];
    int seen = 0, refused = 0;
    medium_body b;
    (void)state;
    make_plateaus(&b);
    for (uint64_t seed = 1; seed <= SEEDS; seed++) {
        const medium_job job = {&b, NULL, 0, seed, "test_medium_even", false};
        assert_int_equal(medium_lab_ask(&job, 1.0 / 510, &medium, &planes, off), LEAFCAST_OK);
        for (int i = 0; i < MEDIUM_PIXELS; i++) {
            assert_false(off[i] > planes.error[i]);
            seen += planes.rgba[i][3] > 0.0;
            refused += planes.error[i] > 1.0 / 510;
        }
    }
    print_message("# %d of %d pixels refused\n", refused, seen);
    assert_true(seen > 50 && refused < seen / 20);
    medium_body_release(&b);
}

/* Colours and the background are at most 1 here, alphas anyway. */
static void test_no_more_than_possible(void **state) {
    static medium_planes planes;
    double off[MEDIUM_PIXELS];
    int capped = 0;
    (void)state;
    for (int body = 1; body < medium_body_count(); body += 9) {
        medium_body b;
        medium_body_make(&b, body, NULL);
        for (int kind = 0; kind < hostile_transfer_kinds(); kind++) {
            const medium_job job = {&b, NULL, kind, 3, "test_medium_even", false};
            assert_int_equal(medium_lab_ask(&job, 1e-4, NULL, &planes, off), LEAFCAST_OK);
            for (int i = 0; i < MEDIUM_PIXELS; i++) {
                assert_true(planes.error[i] <= 1.0 + 1e-9);
                assert_false(off[i] > planes.error[i]);
                capped += planes.error[i] > 0.5;
            }
        }
        medium_body_release(&b);
    }
    assert_true(capped > 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_steps_at_plateaus),
                                       cmocka_unit_test(test_no_more_than_possible)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
