/* test_medium_asked.c - who asks for a smaller error never gets a larger one: neither the bound nor
 * the truth grows from 1e-2 to 1e-9, whatever the transfer function; not even where rounding alone
 * exceeds what is asked for.
 */
/* marks: long, plain */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdio.h>
#include <string.h>

#include "tests/support/medium_lab.h"
#include "tests/support/watched.h"

enum { ASKED = 8, EVERY = WATCHED ? 41 : 19, CUBES = WATCHED ? 8 : 12, SEEDS = WATCHED ? 2 : 6 };

/* A step that is shorter may round once more than the one before saved. */
static const double MORE = 1.05, SLACK = 1e-12;

/* Rising by decades with the value, over the length of a way: 1e-6 to 1e4, in one span or many. */
static leafcast_medium decades(const medium_body *b, int points, leafcast_transfer_point out[]) {
    const double width = b->range.most - b->range.least;
    for (int i = 0; i < points; i++) {
        const double w = (double)i / (points - 1);
        out[i] = (leafcast_transfer_point){.value = b->range.least + w * width,
                                           .rgb = {w, 1.0 - w, 0.5},
                                           .extinction = pow(10.0, 10.0 * w - 6.0)};
    }
    return (leafcast_medium){out, points};
}

/* One picture from 1e-2 to 1e-9. Returns how many pixels were refused at the last. */
static int check_sweep(const medium_job *job, const leafcast_medium *medium, const char *kind) {
    static medium_planes planes;
    double off[MEDIUM_PIXELS], least[MEDIUM_PIXELS];
    int refused = 0;
    for (int i = 0; i < MEDIUM_PIXELS; i++)
        least[i] = INFINITY;
    for (int k = 0; k < ASKED; k++) {
        const double asked = pow(10.0, -2 - k);
        assert_int_equal(medium_lab_ask(job, asked, medium, &planes, off), LEAFCAST_OK);
        for (int i = 0; i < MEDIUM_PIXELS; i++) {
            if (off[i] > planes.error[i])
                fail_msg("%s, %s, asked %g, pixel %d: off by %g, bound %g", job->body->name, kind,
                         asked, i, off[i], planes.error[i]);
            if (planes.error[i] > fmax(MORE * least[i], asked) + SLACK)
                fail_msg("%s, %s, asked %g, pixel %d: bound %g, but %g where more was asked for",
                         job->body->name, kind, asked, i, planes.error[i], least[i]);
            least[i] = fmin(least[i], planes.error[i]);
            refused += k == ASKED - 1 && planes.error[i] > asked;
        }
    }
    return refused;
}

static void test_decades(void **state) {
    static const int points[] = {2, 11, 64};
    leafcast_transfer_point p[64];
    int refused = 0;
    (void)state;
    for (int body = 0; body < medium_body_count(); body += EVERY) {
        medium_body b;
        medium_body_make(&b, body, NULL);
        for (int n = 0; n < 3; n++) {
            const leafcast_medium medium = decades(&b, points[n], p);
            refused += check_sweep(&(medium_job){&b, NULL, 0, 5, "test_medium_asked", false},
                                   &medium, "decades");
        }
        medium_body_release(&b);
    }
    assert_true(refused > 0); /* or rounding has never been the larger part */
}

static void test_hostile(void **state) {
    (void)state;
    for (int body = 1; body < medium_body_count(); body += EVERY) {
        medium_body b;
        medium_body_make(&b, body, NULL);
        for (int kind = 0; kind < hostile_transfer_kinds(); kind++)
            (void)check_sweep(
                &(medium_job){&b, NULL, kind, (uint64_t)kind, "test_medium_asked", false}, NULL,
                hostile_transfer_name(kind));
        medium_body_release(&b);
    }
}

/* A mesh's t errs by the size of its tets: by a millionth nothing is refused, nor is a bound wrong.
 */
static void test_meshes(void **state) {
    static const char *const names[] = {"sphere", "plateau", "tiny"};
    (void)state;
    for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
        medium_body b;
        medium_body_of_mesh(&b, names[n], CUBES);
        const double least = b.range.least, width = b.range.most - least, k = 20.0 / b.range.length;
        const leafcast_transfer_point p[] = {
            {.value = least, .rgb = {0.0, 0.5, 1.0}},
            {.value = least + 0.4 * width, .rgb = {1.0, 0.5, 0.0}, .extinction = 0.2 * k},
            {.value = least + width, .rgb = {1.0, 1.0, 1.0}, .extinction = k}};
        const leafcast_medium medium = {p, 3};
        int refused = 0, seen = 0;
        for (uint64_t seed = 0; seed < SEEDS; seed++) {
            static medium_planes planes;
            double off[MEDIUM_PIXELS];
            const medium_job job = {&b, NULL, 0, seed, "test_medium_asked", false};
            assert_int_equal(medium_lab_ask(&job, 1e-6, &medium, &planes, off), LEAFCAST_OK);
            for (int i = 0; i < MEDIUM_PIXELS; i++) {
                assert_false(off[i] > planes.error[i]);
                refused += planes.error[i] > 1e-6;
                seen += planes.error[i] > 1e-9;
            }
        }
        print_message("# %s: %d of %d pixels refused\n", b.name, refused, seen);
        assert_true(seen > SEEDS * MEDIUM_PIXELS / 4 && refused * 50 <= seen);
        medium_body_release(&b);
    }
}

/* Two media at one place. */
static void test_overlaid(void **state) {
    leafcast_transfer_point p[64];
    medium_body b, beside;
    (void)state;
    leafcast_device *device;
    assert_int_equal(leafcast_device_create(NULL, &device), LEAFCAST_OK);
    const leafcast_options o = {.size = sizeof o, .device = device};
    medium_body_make(&b, 1, &o);
    medium_body_make(&beside, 2, &o);
    const leafcast_medium medium = decades(&b, 11, p);
    (void)check_sweep(&(medium_job){&b, &beside, 0, 5, "test_medium_asked", false}, &medium,
                      "decades");
    medium_body_release(&beside);
    medium_body_release(&b);
    leafcast_device_destroy(device);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_decades), cmocka_unit_test(test_hostile),
        cmocka_unit_test(test_meshes), cmocka_unit_test(test_overlaid)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
