/* test_medium_halving.c - media that ask for more than halving can give end all the same: a stretch
 * has a budget of parts, and a ray asks watch() on its way, not only between rays. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <string.h>

#include "render/medium/medium_overlay.h"
#include "tests/support/fixture.h"
#include "tests/support/mesh_leaves.h"

/* ---- One stretch ---- */

static const leafcast_transfer_point ramp[] = {{0.0, {1, 0, 0}, 0.0}, {1.0, {0, 1, 0}, 0.1}};

/* Of one that is known to be halved for ever: without the budget, 2^60 parts are looked at. */
static medium_stretch seen_of(double light, const medium_overlay_rule *rule) {
    mem m;
    transfer t;
    const leafcast_medium medium = {ramp, 2};
    mem_init(&m, 0);
    assert_int_equal(transfer_init(&t, &m, &medium), ST_OK);
    const medium_layer layer = {
        .transfer = &t, .b = {0.1, 0.9, -0.5, 1.2}, .light = {light, light, light}};
    const medium_stretch seen = medium_of_layers(rule, &layer, 1, 3.0);
    transfer_release(&t, &m);
    return seen;
}

static void test_budget(void **state) {
    (void)state;
    const medium_overlay_rule none = {.most_rgb = 1.0}; /* no error is allowed at all */
    const medium_overlay_rule some = {.share = 1e-6, .enough = 1e-9, .most_rgb = 1.0};
    const medium_overlay_rule wrong = {.share = (double)NAN, .most_rgb = INFINITY};
    const medium_stretch a = seen_of(1.0, &some), b = seen_of(1.0, &none);
    /* It is as good as it can be, and says how good that is. */
    assert_true(a.through > 0.0 && a.through < 1.0 && b.rgb_error > 0.0);
    for (int c = 0; c < 3; c++)
        assert_true(fabs(a.rgb[c] - b.rgb[c]) <= a.rgb_error + b.rgb_error);
    (void)seen_of(INFINITY, &wrong);
    (void)seen_of((double)NAN, &wrong);
}

/* ---- A picture ---- */

enum { SIDE = 8, LAST = 2 };

typedef struct listener {
    int asked, last; /* asked so often; false from the last one on; 0: never */
    double done;
} listener;

static bool watch(void *ctx, double done) {
    listener *l = ctx;
    assert_true(done >= l->done && done <= 1.0);
    l->done = done;
    return ++l->asked != l->last;
}

static leafcast_status draw(leafcast *v, listener *l) {
    double rgba[SIDE * SIDE * 4];
    const leafcast_medium medium = {ramp, 2};
    const leafcast_camera camera = leafcast_standard_view(v, 1.1, SIDE, SIDE);
    const leafcast_image image = {.size = sizeof image, .rgba = rgba};
    leafcast_scene scene = leafcast_scene_default();
    scene.media = &medium;
    scene.media_count = 1;
    scene.shade_media = true;
    return leafcast_trace(v, &scene, &camera, &image, NULL, watch, l);
}

/* All pixels are one tile, so who is asked more often is asked by rays. */
static void test_asks(void **state) {
    (void)state;
    mesh_case c = mesh_leaves_cube(18, 1, 1, FIELD_SEED, 0);
    const leafcast_options o = {.size = sizeof o, .threads = 1};
    leafcast *v = fixture_open(mesh_leaves_make(&c, "asked.leaf"), &o);
    listener all = {0}, some = {.last = LAST};
    mesh_leaves_release(&c);
    const leafcast_surface surface = leafcast_surface_default(1e9); /* none */
    assert_int_equal(leafcast_select(v, &surface, 1), LEAFCAST_OK);
    assert_int_equal(draw(v, &all), LEAFCAST_OK); /* treelets come, and rays wait for them */
    all = (listener){0};
    assert_int_equal(draw(v, &all), LEAFCAST_OK);
    print_message("asked %d times\n", all.asked);
    assert_true(all.asked > 1);
    assert_int_equal(draw(v, &some), LEAFCAST_STOPPED);
    assert_int_equal(some.asked, LAST);
    leafcast_close(v);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_budget), cmocka_unit_test(test_asks)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
