/* test_certificate.c - pictures of media against themselves with half the bound, and against
 * pictures that are wrong. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>

#include "render/app/certificate.h"
#include "tests/support/fixture.h"
#include "tests/support/pictures.h"

/* Three pixels: the same, off by less than both bounds, off by more. */
static void test_compare(void **state) {
    (void)state;
    double a[12] = {0.5, 0.25, 0.0, 1.0, 0.5, 0.25, 0.0, 1.0, 0.5, 0.25, 0.0, 1.0}, b[12];
    double bound[2][3] = {{0.0, 0.01, 0.01}, {0.0, 0.02, 0.02}};
    const leafcast_image first = {.rgba = a, .error = bound[0]},
                         second = {.rgba = b, .error = bound[1]};
    for (int i = 0; i < 12; i++)
        b[i] = a[i];
    b[5] += 0.015;
    certificate made = certificate_compare(&first, &second, 3);
    assert_true(made.made && made.outside == 0);
    assert_true(fabs(made.difference - 0.015) < 1e-15 && fabs(made.of_bounds - 0.5) < 1e-12);
    b[11] -= 0.031;
    made = certificate_compare(&first, &second, 3);
    assert_true(made.outside == 1 && fabs(made.difference - 0.031) < 1e-15);
    b[2] = (double)NAN; /* without a bound, and no number */
    made = certificate_compare(&first, &second, 3);
    assert_true(made.outside == 2 && isnan(made.difference));
}

static void test_a_medium(void **state) {
    (void)state;
    enum { SIDE = 16 };
    static double rgba[SIDE * SIDE][4], error[SIDE * SIDE];
    const leafcast_transfer_point points[2] = {{0.0, {0.1F, 0.2F, 0.9F}, 0.0},
                                               {255.0, {0.9F, 0.6F, 0.1F}, 0.3}};
    const leafcast_medium medium = {points, 2};
    const leafcast_image image = {.size = sizeof image, .rgba = rgba[0], .error = error};
    leafcast_scene scene = leafcast_scene_default();
    field_random r = {3};
    field f;
    mem m;
    certificate made = {.made = false};
    mem_init(&m, 0);
    assert_true(field_make(&f, "noise-u8", 20, 3));
    leafcast *v = fixture_open(fixture_leaf(&f, 4, 1, false), NULL);
    leafcast_camera view = pictures_view(v, 0, &r);
    view.width = view.height = SIDE;
    scene.media = &medium;
    scene.media_count = 1;
    scene.error = 1.0 / 16;
    assert_int_equal(leafcast_trace(v, &scene, &view, &image, NULL, NULL, NULL), LEAFCAST_OK);
    assert_int_equal(certificate_make(v, &scene, &view, &image, &m, &made), ST_OK);
    assert_true(made.made && made.outside == 0 && made.of_bounds <= 1.0);
    rgba[SIDE][1] += 0.2;
    assert_int_equal(certificate_make(v, &scene, &view, &image, &m, &made), ST_FAILED);
    assert_int_equal(made.outside, 1);
    leafcast_close(v);
    field_release(&f);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_compare),
                                       cmocka_unit_test(test_a_medium)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
