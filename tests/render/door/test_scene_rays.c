/* test_scene_rays.c - rays and points of the caller's own through scenes of several volumes; scenes
 * that cannot be are refused. */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <string.h>

#include "tests/support/scene_stage.h"

/* ---- Rays of the caller's own ---- */

enum { RAYS = WATCHED ? 600 : 2500 };

static void rays_meet_what_pixels_see(void **state) {
    const scene_stage *s = *state;
    static picture p;
    static leafcast_ray rays[PICTURE_PIXELS];
    static leafcast_ray_hit hits[PICTURE_PIXELS];
    static uint8_t occluded[PICTURE_PIXELS];
    const leafcast_camera c = scene_stage_view(68);
    scene_pair v;
    scene_stage_open(&v, s, NULL, 1);
    pictures_draw(v.volume[0], &v.scene, &c, &p, NULL);
    for (int i = 0; i < PICTURE_PIXELS; i++) {
        leafcast_pixel_ray(&c, i % PICTURE_WIDTH + 0.5, i / PICTURE_WIDTH + 0.5, rays[i].origin,
                           rays[i].direction);
        rays[i].t1 = INFINITY;
    }
    assert_int_equal(leafcast_trace_rays(v.volume[0], &v.scene, rays, PICTURE_PIXELS, hits),
                     LEAFCAST_OK);
    for (int i = 0; i < PICTURE_PIXELS; i++) {
        assert_true(hits[i].t == p.z[i] && hits[i].surface == p.id[i]);
        if (p.id[i] < 0)
            continue;
        assert_int_equal(hits[i].volume, p.id[i] == 2);
        assert_true(hits[i].isovalue == (p.id[i] < 2 ? scene_stage_isos[p.id[i]] : s->lab.iso));
        assert_true(hits[i].error_bound < 1e-6);
        for (int a = 0; a < 3; a++)
            assert_true(hits[i].normal[a] == p.normal[a][i]);
        /* Up to just before it there is nothing. */
        rays[i].t1 = i % 2 ? hits[i].t * (1 + 1e-9) : hits[i].t - 1e-6;
    }
    assert_int_equal(leafcast_occluded_rays(v.volume[0], &v.scene, rays, PICTURE_PIXELS, occluded),
                     LEAFCAST_OK);
    for (int i = 0; i < PICTURE_PIXELS; i++)
        assert_int_equal(occluded[i], p.id[i] >= 0 && i % 2);
    scene_stage_close(&v);
}

static void rays_are_checked(void **state) {
    const leafcast_ray bad[] = {{{0, 0, 0}, {0, 0, 0}, 0, 1},
                                {{NAN, 0, 0}, {1, 0, 0}, 0, 1},
                                {{0, 0, 0}, {1, 0, 0}, 2, 1},
                                {{0, 0, 0}, {1, 0, 0}, NAN, 1}};
    leafcast_ray_hit hit;
    scene_pair v;
    scene_stage_open(&v, *state, NULL, 0);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_int_equal(leafcast_trace_rays(v.volume[0], &v.scene, &bad[i], 1, &hit),
                         LEAFCAST_USAGE);
    assert_int_equal(leafcast_trace_rays(v.volume[0], &v.scene, bad, 0, &hit), LEAFCAST_OK);
    scene_stage_close(&v);
}

static void points_are_sampled(void **state) {
    static double points[RAYS][3];
    static leafcast_sample samples[RAYS];
    const scene_stage *s = *state;
    field_random r = {3};
    scene_pair v;
    int inside = 0;
    scene_stage_open(&v, s, NULL, 1);
    for (int i = 0; i < RAYS; i++)
        for (int a = 0; a < 3; a++)
            points[i][a] = 40 * field_random_unit(&r) - 2;
    assert_int_equal(leafcast_sample_points(v.volume[0], (const double(*)[3])points, RAYS, samples),
                     LEAFCAST_OK);
    for (int i = 0; i < RAYS; i++) {
        const long double at[3] = {points[i][0], points[i][1], points[i][2]};
        const long double truly = ref_value(&s->grid, at, 0);
        assert_int_equal(samples[i].inside, !isnan(truly));
        inside += samples[i].inside;
        if (samples[i].inside)
            assert_true(fabsl((long double)samples[i].value - truly) < 1e-6L);
    }
    assert_true(inside > RAYS / 2 && inside < RAYS);
    scene_stage_close(&v);
}

/* Rays and probes look for surfaces; where a scene has only media there are none. */
static void media_are_no_surfaces(void **state) {
    const scene_stage *s = *state;
    const leafcast_transfer_point point = {0.5, {1, 1, 1}, 0.1};
    const leafcast_medium media[2] = {{&point, 1}, {NULL, 0}};
    const leafcast_camera c = scene_stage_view(68);
    leafcast_ray ray = {.t1 = (double)INFINITY};
    leafcast_ray_hit first = {.t = 0};
    leafcast_hit hits[4];
    uint8_t occluded = 1;
    int count = -1;
    scene_pair v;
    scene_stage_open(&v, s, NULL, 0);
    leafcast_pixel_ray(&c, PICTURE_WIDTH * 0.5, PICTURE_HEIGHT * 0.5, ray.origin, ray.direction);
    v.scene.media = media;
    v.scene.media_count = 2;
    v.shown[0].count = v.shown[1].count = 0;
    assert_int_equal(leafcast_trace_rays(v.volume[0], &v.scene, &ray, 1, &first), LEAFCAST_OK);
    assert_true(isinf(first.t) && first.surface == -1);
    assert_int_equal(leafcast_occluded_rays(v.volume[0], &v.scene, &ray, 1, &occluded),
                     LEAFCAST_OK);
    assert_int_equal(occluded, 0);
    assert_int_equal(
        leafcast_probe_ray(v.volume[0], &v.scene, ray.origin, ray.direction, hits, 4, &count),
        LEAFCAST_OK);
    assert_int_equal(count, 0);
    scene_stage_close(&v);
}

/* ---- Scenes that cannot be ---- */

static void scenes_are_checked(void **state) {
    static picture p;
    const scene_stage *s = *state;
    const leafcast_camera c = scene_stage_view(68);
    leafcast_image image = {.size = sizeof image, .z = p.z};
    scene_pair v, w;
    scene_stage_open(&v, s, NULL, 0);
    scene_stage_open(&w, s, NULL, 0);
#define REFUSED()                                                                         \
    assert_int_equal(leafcast_trace(v.volume[0], &v.scene, &c, &image, NULL, NULL, NULL), \
                     LEAFCAST_USAGE)
    v.shown[1].volume = w.volume[1]; /* of another device */
    REFUSED();
    v.scene.volume_count = 1;
    v.shown[0].step = 1;
    REFUSED();
    v.shown[0].step = 0;
    v.shown[0].count = 0;
    REFUSED();
    v.shown[0].count = 2;
    image.width = PICTURE_WIDTH;
    image.height = PICTURE_HEIGHT;
    image.x = 1; /* beyond the picture */
    REFUSED();
    image.x = 0;
    image.stride = PICTURE_WIDTH - 1;
    REFUSED();
    image.stride = 0;
    assert_int_equal(leafcast_trace(v.volume[0], &v.scene, &c, &image, NULL, NULL, NULL),
                     LEAFCAST_OK);
    const leafcast_options o = {.size = sizeof o, .device = v.device, .memory = 1 << 20};
    leafcast *none;
    assert_int_equal(leafcast_open(s->grid_path, &o, &none), LEAFCAST_USAGE);
    scene_stage_close(&v);
    scene_stage_close(&w);
}

/* Media without points are none. */
static void media_of_nothing_change_nothing(void **state) {
    const scene_stage *s = *state;
    static picture with, without;
    const leafcast_medium nothing[2] = {{NULL, 0}, {NULL, 0}};
    const leafcast_camera c = scene_stage_view(68);
    scene_pair v;
    scene_stage_open(&v, s, NULL, 0);
    leafcast_scene scene = scene_stage_lit(&v);
    pictures_draw(v.volume[0], &scene, &c, &without, NULL);
    scene.media = nothing;
    scene.media_count = 2;
    pictures_draw(v.volume[0], &scene, &c, &with, NULL);
    scene_stage_same(&with, &without);
    v.shown[0].count = v.shown[1].count = 0;
    const leafcast_image image = {.size = sizeof image, .z = with.z};
    assert_int_equal(leafcast_trace(v.volume[0], &scene, &c, &image, NULL, NULL, NULL),
                     LEAFCAST_USAGE);
    scene_stage_close(&v);
}

/* Values do not fall, nor rise by less than anything can tell. */
static void transfer_functions_are_checked(void **state) {
    const scene_stage *s = *state;
    static const struct {
        leafcast_transfer_point points[2];
        const char *why; /* NULL: fine */
    } cases[] = {
        {{{-1e-290, {1, 1, 1}, 1}, {0, {1, 1, 1}, 0}}, NULL},
        {{{3, {1, 1, 1}, 1}, {3, {1, 1, 1}, 0}}, NULL},
        {{{0, {1, 1, 1}, 1}, {1e-291, {1, 1, 1}, 0}}, "point 2 of the transfer function: its"},
        {{{4, {1, 1, 1}, 1}, {3, {1, 1, 1}, 0}}, "point 2 of the transfer function has a smaller"},
        {{{4, {1, -1, 1}, 1}, {5, {1, 1, 1}, 0}}, "leafcast_scene.media[0].points[0].rgb[1] is -1"},
        {{{4, {1, 1, 1}, 1}, {(double)NAN, {1, 1, 1}, 0}}, "media[0].points[1].value is"},
        {{{4, {1, 1, 1}, 1}, {5, {1, 1, 1}, -1}}, "media[0].points[1].extinction"},
    };
    static picture p;
    const leafcast_camera c = scene_stage_view(68);
    const leafcast_image image = {.size = sizeof image, .z = p.z};
    scene_pair v;
    scene_stage_open(&v, s, NULL, 0);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const leafcast_medium media[2] = {{cases[i].points, 2}, {NULL, 0}};
        v.scene.media = media;
        v.scene.media_count = 2;
        assert_int_equal(leafcast_trace(v.volume[0], &v.scene, &c, &image, NULL, NULL, NULL),
                         cases[i].why ? LEAFCAST_USAGE : LEAFCAST_OK);
        if (cases[i].why)
            assert_non_null(strstr(leafcast_error_text(), cases[i].why));
    }
    scene_stage_close(&v);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rays_meet_what_pixels_see),
        cmocka_unit_test(rays_are_checked),
        cmocka_unit_test(points_are_sampled),
        cmocka_unit_test(media_are_no_surfaces),
        cmocka_unit_test(scenes_are_checked),
        cmocka_unit_test(media_of_nothing_change_nothing),
        cmocka_unit_test(transfer_functions_are_checked),
    };
    return cmocka_run_group_tests(tests, scene_stage_set, scene_stage_clear);
}
