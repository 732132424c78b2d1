/* test_caps.c - caps where clips have cut isosurfaces open: every pixel against the value at the
 * place where its ray enters through the clip.
 */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "tests/support/fixture.h"
#include "tests/support/lab_leaf.h"
#include "tests/support/pictures.h"

enum { SIDE = 40, PIXELS = SIDE * SIDE };

typedef struct planes {
    float rgba[4][PIXELS], normal[3][PIXELS];
    double z[PIXELS], exact[PIXELS][4], error[PIXELS];
    int32_t id[PIXELS];
    leafcast_stats stats;
} planes;

static leafcast_status draw(leafcast *v, const leafcast_scene *scene, const leafcast_camera *view,
                            planes *p) {
    leafcast_image image = {.size = sizeof image,
                            .r = p->rgba[0],
                            .g = p->rgba[1],
                            .b = p->rgba[2],
                            .a = p->rgba[3],
                            .z = p->z,
                            .rgba = p->exact[0],
                            .error = p->error,
                            .id = p->id};
    for (int a = 0; a < 3; a++)
        image.normal[a] = p->normal[a];
    if (scene->samples > 1) /* those are of one */
        image.rgba = image.error = NULL;
    p->stats.size = sizeof p->stats;
    return leafcast_trace(v, scene, view, &image, &p->stats, NULL, NULL);
}

static leafcast_camera view_of(const leafcast *v, int kind, uint64_t seed) {
    field_random r = {seed};
    leafcast_camera view = pictures_view(v, kind, &r);
    view.width = view.height = SIDE;
    return view;
}

/* A plane through the middle that keeps what is behind it as seen from the eye, turned a little. */
static void cut_through(leafcast_scene *scene, const leafcast *v, const leafcast_camera *view) {
    const leafcast_info info = leafcast_describe(v);
    double *p = scene->clip_planes[0];
    p[3] = 0.0;
    for (int a = 0; a < 3; a++) {
        const double middle = 0.5 * (info.bounds[0][a] + info.bounds[1][a]);
        p[a] = view->look_at[a] - view->eye[a] + (a == 0 ? 0.3 : -0.2);
        p[3] -= p[a] * (middle + 0.01);
    }
    scene->clip_plane_count = 1;
}

/* Where a pixel's ray enters through the plane; false: it begins behind it, or leaves there. */
static bool entry_of(const leafcast_scene *scene, const leafcast_camera *view, int pixel, double *t,
                     double point[3]) {
    const double *p = scene->clip_planes[0];
    double o[3], d[3], at = p[3], slope = 0.0;
    leafcast_pixel_ray(view, pixel % SIDE + 0.5, pixel / SIDE + 0.5, o, d);
    for (int a = 0; a < 3; a++) {
        at += p[a] * o[a];
        slope += p[a] * d[a];
    }
    *t = -at / slope;
    for (int a = 0; a < 3; a++)
        point[a] = o[a] + *t * d[a];
    return slope > 0.0 && *t > 0.0;
}

static const leafcast_transfer_point ramp[2] = {{-1e3, {0.0, 0.25, 1.0}, 0.0},
                                                {1e3, {1.0, 0.5, 0.0}, 0.0}};

/* The cap's own colour by values. */
static double ramp_at(double value, int c) {
    const double w = fmin(fmax((value + 1e3) / 2e3, 0.0), 1.0);
    return (1.0 - w) * ramp[0].rgb[c] + w * ramp[1].rgb[c];
}

/* One pixel of a picture with caps beside the same without. Whether it has one. */
static bool check_pixel(leafcast *v, const leafcast_scene *scene, const leafcast_camera *view,
                        const leafcast_surface *s, const planes *open, const planes *capped,
                        int i) {
    leafcast_sample sample = {.inside = false};
    double t, point[3];
    const bool enters = entry_of(scene, view, i, &t, point);
    if (enters)
        assert_int_equal(leafcast_probe_point(v, point, &sample), LEAFCAST_OK);
    const bool cap = sample.inside && sample.value >= s->isovalue;
    if (!cap) {
        assert_true(capped->z[i] == open->z[i] && capped->id[i] == open->id[i]);
        for (int c = 0; c < 4; c++)
            assert_true(capped->rgba[c][i] == open->rgba[c][i]);
        return false;
    }
    assert_true(fabs(capped->z[i] - t) <= 1e-9 * t);
    assert_int_equal(capped->id[i], 0);
    for (int a = 0; a < 3; a++) {
        const double *p = scene->clip_planes[0];
        const double length = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
        assert_true(fabs((double)capped->normal[a][i] + p[a] / length) < 1e-6);
    }
    for (int c = 0; c < 4; c++) {
        const double own = c == 3               ? 1.0
                           : scene->cap_colours ? ramp_at(sample.value, c)
                                                : (double)s->rgb[c],
                     behind = (double)open->rgba[c][i], a = (double)s->opacity;
        assert_true(fabs((double)capped->rgba[c][i] - (a * own + (1.0 - a) * behind)) < 1e-5);
    }
    return true;
}

/* With and without caps; returns how many pixels have one. */
static int check_caps(leafcast *v, double isovalue, float opacity, bool by_value, int kind) {
    static planes open, capped;
    const leafcast_medium colours = {ramp, 2};
    leafcast_surface s = leafcast_surface_default(isovalue);
    leafcast_scene scene = leafcast_scene_default();
    const leafcast_camera view = view_of(v, kind, 7);
    int caps = 0;
    s.opacity = opacity;
    scene.shading = LEAFCAST_SHADING_FLAT;
    scene.background[2] = 0.5F;
    scene.background[3] = 1.0F;
    assert_int_equal(leafcast_select(v, &s, 1), LEAFCAST_OK);
    cut_through(&scene, v, &view);
    assert_int_equal(draw(v, &scene, &view, &open), LEAFCAST_OK);
    scene.caps = true;
    scene.cap_colours = by_value ? &colours : NULL;
    assert_int_equal(draw(v, &scene, &view, &capped), LEAFCAST_OK);
    for (int i = 0; i < PIXELS; i++)
        caps += check_pixel(v, &scene, &view, &s, &open, &capped, i);
    assert_true(capped.stats.covered_pixels >= (uint64_t)caps);
    return caps;
}

static int check_volume(leafcast *v, double isovalue) {
    int caps = 0;
    for (int kind = 0; kind < PICTURE_VIEWS; kind++) {
        caps += check_caps(v, isovalue, 1.0F, kind % 2 == 0, kind);
        caps += check_caps(v, isovalue, 0.4F, kind % 3 == 0, kind);
    }
    return caps;
}

static void test_every_pixel(void **state) {
    (void)state;
    static const char *const names[] = {"sphere", "noise-u8", "missing", "rectilinear"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        field f;
        assert_true(field_make(&f, names[i], 24, 3));
        leafcast *v = fixture_open(fixture_leaf(&f, 4, 1, i % 2 > 0), NULL);
        assert_true(check_volume(v, f.iso) > 100);
        leafcast_close(v);
        field_release(&f);
    }
    lab_mesh lab;
    assert_true(lab_mesh_make(&lab, "noise", 6, 5));
    leafcast *v = fixture_open(lab_leaf_make(&lab, 60, false), NULL);
    assert_true(check_volume(v, lab.iso) > 100);
    leafcast_close(v);
    lab_mesh_release(&lab);
}

/* The innermost of several surfaces. */
static void test_nested_surfaces(void **state) {
    (void)state;
    static planes p;
    field f;
    assert_true(field_make(&f, "linear", 20, 3));
    leafcast *v = fixture_open(fixture_leaf(&f, 4, 1, false), NULL);
    double range[2];
    int of[3] = {0};
    leafcast_scene scene = leafcast_scene_default();
    const leafcast_camera view = view_of(v, 0, 3);
    assert_int_equal(leafcast_range(v, 0, 0, range), LEAFCAST_OK);
    const double step = (range[1] - range[0]) / 4.0;
    const leafcast_surface s[3] = {leafcast_surface_default(range[0] + 3.0 * step),
                                   leafcast_surface_default(range[0] + step),
                                   leafcast_surface_default(range[0] + 2.0 * step)};
    assert_int_equal(leafcast_select(v, s, 3), LEAFCAST_OK);
    cut_through(&scene, v, &view);
    scene.caps = true;
    assert_int_equal(draw(v, &scene, &view, &p), LEAFCAST_OK);
    for (int i = 0; i < PIXELS; i++) {
        leafcast_sample at = {.inside = false};
        double t, point[3];
        if (entry_of(&scene, &view, i, &t, point))
            assert_int_equal(leafcast_probe_point(v, point, &at), LEAFCAST_OK);
        if (!at.inside || at.value < s[1].isovalue)
            continue;
        const int inner = at.value >= s[0].isovalue ? 0 : at.value >= s[2].isovalue ? 2 : 1;
        assert_int_equal(p.id[i], inner);
        of[inner]++;
    }
    assert_true(of[0] > 0 && of[1] > 0 && of[2] > 0);
    leafcast_close(v);
    field_release(&f);
}

/* Four samples, little memory, one thread or two, a medium behind: the same picture; and what a
 * medium may be off by is that behind an opaque cap no more. */
static void test_with_all_else(void **state) {
    (void)state;
    static planes want, got;
    const leafcast_transfer_point fog = {.rgb = {1.0, 1.0, 1.0}, .extinction = 0.02};
    const leafcast_medium medium = {&fog, 1};
    field f;
    assert_true(field_make(&f, "noise-u8", 40, 3));
    const char *path = fixture_leaf(&f, 4, 1, true);
    int exact = 0;
    leafcast_scene scene = leafcast_scene_default();
    const leafcast_surface s = leafcast_surface_default(f.iso);
    scene.caps = true;
    scene.samples = 4;
    for (size_t memory = 0; memory < 8; memory++) {
        const leafcast_options o = {.size = sizeof o,
                                    .memory = memory > 0 ? ((size_t)64 << 20) >> memory : 0,
                                    .threads = memory % 2 ? 2 : 1};
        leafcast *v = NULL;
        leafcast_status st = leafcast_open(path, &o, &v);
        if (st == LEAFCAST_OK)
            st = leafcast_select(v, &s, 1);
        const leafcast_camera view = v ? view_of(v, 1, 5) : (leafcast_camera){.width = 1};
        if (v)
            cut_through(&scene, v, &view);
        if (st == LEAFCAST_OK)
            st = draw(v, &scene, &view, memory > 0 ? &got : &want);
        assert_true(st == LEAFCAST_OK || (st == LEAFCAST_NOMEM && memory > 3));
        if (st == LEAFCAST_OK && memory > 0)
            assert_memory_equal(got.rgba, want.rgba, sizeof got.rgba);
        leafcast_close(v);
    }
    leafcast *v = fixture_open(path, NULL);
    const leafcast_camera view = view_of(v, 1, 5);
    assert_int_equal(leafcast_select(v, &s, 1), LEAFCAST_OK);
    scene.samples = 1;
    scene.media = &medium;
    scene.media_count = 1;
    assert_int_equal(draw(v, &scene, &view, &got), LEAFCAST_OK);
    for (int i = 0; i < PIXELS; i++) {
        double t, point[3];
        leafcast_sample at = {.inside = false};
        if (entry_of(&scene, &view, i, &t, point))
            assert_int_equal(leafcast_probe_point(v, point, &at), LEAFCAST_OK);
        if (!at.inside || at.value < s.isovalue)
            continue;
        exact++;
        assert_true(got.error[i] == 0.0 && got.exact[i][3] == 1.0);
        assert_true(got.rgba[0][i] == (float)got.exact[i][0]);
    }
    assert_true(exact > 100);
    leafcast_close(v);
    field_release(&f);
}

static bool until_drawn(void *ctx, double done) {
    (void)ctx;
    return done < 1.0;
}

/* Whoever watches a picture may stop it while its caps are drawn. */
static void test_stopped(void **state) {
    (void)state;
    static double z[PIXELS];
    const leafcast_image image = {.size = sizeof image, .z = z};
    field f;
    assert_true(field_make(&f, "sphere", 24, 3));
    leafcast *v = fixture_open(fixture_leaf(&f, 4, 1, false), NULL);
    const leafcast_surface s = leafcast_surface_default(f.iso);
    const leafcast_camera view = view_of(v, 0, 7);
    leafcast_scene scene = leafcast_scene_default();
    assert_int_equal(leafcast_select(v, &s, 1), LEAFCAST_OK);
    cut_through(&scene, v, &view);
    assert_int_equal(leafcast_trace(v, &scene, &view, &image, NULL, until_drawn, NULL),
                     LEAFCAST_OK);
    scene.caps = true;
    assert_int_equal(leafcast_trace(v, &scene, &view, &image, NULL, until_drawn, NULL),
                     LEAFCAST_STOPPED);
    leafcast_close(v);
    field_release(&f);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_pixel), cmocka_unit_test(test_nested_surfaces),
        cmocka_unit_test(test_with_all_else), cmocka_unit_test(test_stopped)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
