/* test_camera.c - the camera: hand-checked rays, the standard view, cameras that are none. */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <string.h>

#include "render/look/camera.h"
#include "tests/support/ref_camera.h"

static void check_vector(const double got[3], double x, double y, double z, double within) {
    const double want[3] = {x, y, z};
    for (int a = 0; a < 3; a++)
        if (!(fabs(got[a] - want[a]) <= within))
            fail_msg("component %d is %.17g, not %.17g", a, got[a], want[a]);
}

/* From the origin along +x, up +z, 90 degrees, 4 x 2 pixels: right is -y. */
static leafcast_camera plain(void) {
    return (leafcast_camera){.size = sizeof(leafcast_camera),
                             .look_at = {5, 0, 0},
                             .up = {0, 0, 2},
                             .fov = 90,
                             .width = 4,
                             .height = 2};
}

static void test_conventions(void **state) {
    (void)state;
    const leafcast_camera view = plain();
    camera c;
    double o[3], d[3];
    assert_int_equal(camera_init(&c, &view), ST_OK);
    camera_ray(&c, 2, 1, o, d);
    check_vector(o, 0, 0, 0, 0);
    check_vector(d, 1, 0, 0, 0);
    assert_false(signbit(d[1]) || signbit(d[2]));
    camera_ray(&c, 0, 0, o, d); /* the top left corner */
    check_vector(d, 1 / sqrt(6), 2 / sqrt(6), 1 / sqrt(6), 1e-15);
    camera_ray(&c, 3.5, 1.5, o, d); /* the last pixel's centre */
    const double length = sqrt(1 + 1.5 * 1.5 + 0.5 * 0.5);
    check_vector(d, 1 / length, -1.5 / length, -0.5 / length, 1e-15);
    assert_true(fabs(camera_pixel(&c, 1) - 1) < 1e-15);
}

static void test_agrees_with_reference(void **state) {
    (void)state;
    const double fov[] = {0.001, 1, 45, 60, 90, 120, 170, 179.9};
    for (size_t i = 0; i < sizeof fov / sizeof *fov; i++) {
        const leafcast_camera view = {.size = sizeof view,
                                      .eye = {3, -4, 5},
                                      .look_at = {1, 2, -7},
                                      .up = {0.1, 0.2, 1},
                                      .fov = fov[i],
                                      .width = 640,
                                      .height = 360};
        ref_camera other = {{3, -4, 5}, {1, 2, -7}, {0.1, 0.2, 1}, fov[i], 640, 360};
        camera c;
        assert_int_equal(camera_init(&c, &view), ST_OK);
        for (int y = 0; y < 360; y += 17)
            for (int x = 0; x < 640; x += 23) {
                double o[3], d[3];
                camera_ray(&c, x + 0.5, y + 0.5, o, d);
                ref_ray want = ref_primary_ray(&other, x, y);
                check_vector(d, want.d[0], want.d[1], want.d[2], 1e-13);
                assert_true(fabs(d[0] * d[0] + d[1] * d[1] + d[2] * d[2] - 1) < 1e-15);
            }
    }
}

static void test_standard_view(void **state) {
    (void)state;
    const double bounds[2][3] = {{-1, 0, 2}, {3, 1, 5}};
    const leafcast_camera view = camera_standard(bounds, 2.2, 100, 50);
    check_vector(view.look_at, 1, 0.5, 3.5, 0);
    const double k = 2.2 * 4 / sqrt(2);
    check_vector(view.eye, 1 + k, 0.5 + 0.6 * k, 3.5 + 0.8 * k, 1e-14);
    check_vector(view.up, 0, 0, 1, 0);
    assert_true(view.fov == 45 && view.width == 100 && view.height == 50);
}

static void refused(leafcast_camera view, const char *text) {
    camera c;
    assert_int_equal(camera_init(&c, &view), ST_USAGE);
    if (!strstr(status_text(), text))
        fail_msg("\"%s\" does not say \"%s\"", status_text(), text);
}

static void test_no_such_camera(void **state) {
    (void)state;
    leafcast_camera view = plain();
    view.width = 0;
    refused(view, "pixels");
    view.width = view.height = 65536;
    refused(view, "65536 x 65536 pixels: more than");
    view = plain();
    view.eye[1] = NAN;
    refused(view, "finite");
    view = plain();
    memcpy(view.eye, view.look_at, sizeof view.eye);
    refused(view, "same point");
    view = plain();
    memset(view.up, 0, sizeof view.up);
    refused(view, "no direction");
    view.up[0] = -3;
    refused(view, "along its up");
    const double fov[] = {0, -1, 180, NAN, INFINITY};
    for (size_t i = 0; i < sizeof fov / sizeof *fov; i++) {
        view = plain();
        view.fov = fov[i];
        refused(view, "field of view");
    }
}

/* Distances whose squares leave the range of double. */
static void test_far_and_near(void **state) {
    (void)state;
    for (int sign = -1; sign <= 1; sign += 2) {
        leafcast_camera view = plain();
        view.look_at[0] = pow(10, 250 * sign);
        camera c;
        double o[3], d[3];
        assert_int_equal(camera_init(&c, &view), ST_OK);
        camera_ray(&c, 2, 1, o, d);
        check_vector(d, 1, 0, 0, 0);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_conventions),   cmocka_unit_test(test_agrees_with_reference),
        cmocka_unit_test(test_standard_view), cmocka_unit_test(test_no_such_camera),
        cmocka_unit_test(test_far_and_near),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
