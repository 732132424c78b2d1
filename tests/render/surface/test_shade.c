/* test_shade.c - colours that can be worked out by hand. */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>

#include "render/surface/shade.h"

static const float RED[3] = {1.0f, 0.5f, 0.25f}, WHITE[3] = {1.0f, 1.0f, 1.0f};
static const float UP[3] = {0.0f, 0.0f, 1.0f}, DOWN[3] = {0.0f, 0.0f, -1.0f};
static const float SLANTED[3] = {0.6f, 0.0f, 0.8f};

static leafcast_scene scene_of(leafcast_shading shading) {
    return (leafcast_scene){.size = sizeof(leafcast_scene),
                            .ambient = 0.25f,
                            .specular = 0.5f,
                            .shininess = 3,
                            .shading = shading};
}

static void check_rgb(const float got[3], double r, double g, double b) {
    const double want[3] = {r, g, b};
    for (int i = 0; i < 3; i++)
        if (!(fabs((double)got[i] - want[i]) < 1e-6))
            fail_msg("component %d is %.9g, not %.9g", i, (double)got[i], want[i]);
}

static void test_diffuse(void **state) {
    (void)state;
    const leafcast_scene scene = scene_of(LEAFCAST_SHADING_DIFFUSE);
    float rgb[3];
    shade_point p = shade_point_of(&scene, RED, UP, UP);
    shade_ambient(&p, rgb);
    check_rgb(rgb, 0.25, 0.125, 0.0625);
    shade_light(&p, UP, WHITE, 1.0f, rgb);
    check_rgb(rgb, 1, 0.5, 0.25); /* eq. 4.6 with N . L = 1 is the colour itself */
    shade_ambient(&p, rgb);
    shade_light(&p, SLANTED, WHITE, 0.5f, rgb);
    check_rgb(rgb, 0.25 + 0.5 * 0.75 * 0.8, (0.25 + 0.3) * 0.5, (0.25 + 0.3) * 0.25);
}

static void test_both_sides_look_alike(void **state) {
    (void)state;
    const leafcast_scene scene = scene_of(LEAFCAST_SHADING_PHONG);
    shade_point a = shade_point_of(&scene, RED, SLANTED, UP);
    const float turned[3] = {-0.6f, 0.0f, -0.8f};
    shade_point b = shade_point_of(&scene, RED, turned, UP);
    float rgb_a[3], rgb_b[3];
    shade_ambient(&a, rgb_a);
    shade_ambient(&b, rgb_b);
    shade_light(&a, UP, WHITE, 1.0f, rgb_a);
    shade_light(&b, UP, WHITE, 1.0f, rgb_b);
    assert_memory_equal(rgb_a, rgb_b, sizeof rgb_a);
}

static void test_light_behind(void **state) {
    (void)state;
    const leafcast_scene scene = scene_of(LEAFCAST_SHADING_PHONG);
    const shade_point p = shade_point_of(&scene, RED, UP, UP);
    float rgb[3] = {0.0f, 0.0f, 0.0f};
    assert_false(shade_reaches(&p, DOWN));
    assert_true(shade_reaches(&p, SLANTED));
    shade_light(&p, DOWN, WHITE, 1.0f, rgb);
    check_rgb(rgb, 0, 0, 0);
}

static void test_phong(void **state) {
    (void)state;
    const leafcast_scene scene = scene_of(LEAFCAST_SHADING_PHONG);
    const shade_point p = shade_point_of(&scene, RED, UP, UP);
    float rgb[3] = {0.0f, 0.0f, 0.0f};
    shade_light(&p, SLANTED, WHITE, 1.0f, rgb); /* R . V = 0.8 */
    const double highlight = 0.5 * 0.8 * 0.8 * 0.8, diffuse = 0.75 * 0.8;
    check_rgb(rgb, diffuse + highlight, diffuse * 0.5 + highlight, diffuse * 0.25 + highlight);
}

static void test_flat(void **state) {
    (void)state;
    const leafcast_scene scene = scene_of(LEAFCAST_SHADING_FLAT);
    const shade_point p = shade_point_of(&scene, RED, SLANTED, UP);
    float rgb[3];
    shade_ambient(&p, rgb);
    assert_false(shade_reaches(&p, UP));
    shade_light(&p, UP, WHITE, 1.0f, rgb);
    check_rgb(rgb, 1, 0.5, 0.25);
}

static void test_no_normal_faces_the_eye(void **state) {
    (void)state;
    const leafcast_scene scene = scene_of(LEAFCAST_SHADING_DIFFUSE);
    const float none[3] = {0.0f, 0.0f, 0.0f};
    const shade_point p = shade_point_of(&scene, RED, none, SLANTED);
    check_rgb(p.normal, 0.6, 0, 0.8);
}

static void test_composite(void **state) {
    (void)state;
    float rgba[4] = {0.0f, 0.0f, 0.0f, 0.0f};
    shade_composite(rgba, RED, 0.5f);
    shade_composite(rgba, WHITE, 0.5f);
    check_rgb(rgba, 0.75, 0.5, 0.375);
    assert_true(rgba[3] == 0.75f);
    shade_background(rgba, (const float[4]){0.0f, 1.0f, 0.0f, 0.5f});
    check_rgb(rgba, 0.75, 0.625, 0.375);
    assert_true(rgba[3] == 0.875f);
    shade_composite(rgba, WHITE, 1.0f); /* an opaque surface ends it: alpha is exactly 1 */
    assert_true(rgba[3] == 1.0f);
}

static void test_normal(void **state) {
    (void)state;
    float n[3];
    assert_true(shade_normal((const double[3]){3e-300, 0, 4e-300}, n));
    check_rgb(n, -0.6, 0, -0.8);
    assert_true(shade_normal((const double[3]){-3e300, 0, 4e300}, n));
    check_rgb(n, 0.6, 0, -0.8);
    static const double without[][3] = {
        {0, 0, 0}, {INFINITY, 1, 1}, {1, NAN, 1}, {1e308, 1e308, 1}};
    for (size_t i = 0; i < sizeof without / sizeof *without; i++) {
        assert_false(shade_normal(without[i], n));
        check_rgb(n, 0.6, 0, -0.8);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_diffuse),      cmocka_unit_test(test_both_sides_look_alike),
        cmocka_unit_test(test_light_behind), cmocka_unit_test(test_phong),
        cmocka_unit_test(test_flat),         cmocka_unit_test(test_no_normal_faces_the_eye),
        cmocka_unit_test(test_composite),    cmocka_unit_test(test_normal),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
