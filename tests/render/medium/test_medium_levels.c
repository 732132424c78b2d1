/* test_medium_levels.c - bounds are about the data at full resolution, whatever level of detail is
 * drawn: every kind of picture that has a bound, at every lod there is, against the exact one.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

#include "render/app/certificate.h"
#include "tests/support/medium_lab.h"

enum { SIDE = 12, PIXELS = SIDE * SIDE, LODS = LEAFCAST_LOD_PIXEL + 1 };

static const double ASKED = 1e-4;

typedef struct levelled {
    double rgba[PIXELS][4], error[PIXELS];
    leafcast_stats stats;
} levelled;

static leafcast_image image_of(levelled *p) {
    p->stats.size = sizeof p->stats;
    return (leafcast_image){.size = sizeof(leafcast_image), .rgba = p->rgba[0], .error = p->error};
}

/* Two volumes of one device, and how they are filled. */
typedef struct bench {
    leafcast_device *device;
    medium_body of[2];
    leafcast_transfer_point points[2][2];
    leafcast_medium media[2];
    leafcast_shown shown[2];
    leafcast_surface surface;
    leafcast_scene scene;
    leafcast_camera camera;
} bench;

static void bench_make(bench *b) {
    assert_int_equal(leafcast_device_create(NULL, &b->device), LEAFCAST_OK);
    const leafcast_options o = {.size = sizeof o, .device = b->device};
    for (int i = 0; i < 2; i++) {
        int n = 0;
        while (strcmp(medium_body_name(n), i == 0 ? "noise-u8" : "sphere") != 0)
            n++;
        medium_body_make(&b->of[i], n, &o);
        const transfer_range *r = &b->of[i].range;
        b->shown[i] = (leafcast_shown){.volume = b->of[i].volume};
        assert_true(leafcast_describe(b->of[i].volume).levels > 1);
        for (int k = 0; k < 2; k++)
            b->points[i][k] = (leafcast_transfer_point){.value = k ? r->most : r->least,
                                                        .rgb = {k, 1.0, 1.0 - k},
                                                        .extinction = 4.0 * k / r->length};
        b->media[i] = (leafcast_medium){b->points[i], 2};
    }
    b->surface = leafcast_surface_default(b->of[0].field.iso);
    b->surface.opacity = 0.5F;
    b->scene = leafcast_scene_default();
    b->scene.volumes = b->shown;
    b->scene.shading = LEAFCAST_SHADING_FLAT;
    b->scene.error = ASKED;
    b->camera = leafcast_standard_view(b->of[0].volume, 2.2, SIDE, SIDE);
}

static void bench_release(bench *b) {
    medium_body_release(&b->of[0]);
    medium_body_release(&b->of[1]);
    leafcast_device_destroy(b->device);
}

/* ---- Pictures that have a bound ---- */

static void of_one(bench *b) {
    b->scene.volume_count = b->scene.media_count = 1;
    b->scene.media = b->media;
}

static void with_surface(bench *b) {
    of_one(b);
    b->shown[0].surfaces = &b->surface;
    b->shown[0].count = 1;
}

static void of_two(bench *b) {
    of_one(b);
    b->scene.volume_count = b->scene.media_count = 2;
}

/* One of them is not filled, but has a surface. */
static void surface_beside(bench *b) {
    static leafcast_medium media[2];
    of_two(b);
    media[0] = b->media[0];
    b->scene.media = media;
    b->surface = leafcast_surface_default(b->of[1].field.iso);
    b->shown[1].surfaces = &b->surface;
    b->shown[1].count = 1;
}

static void shaded(bench *b) {
    of_one(b);
    b->scene.shade_media = true;
}

static void projected(bench *b) {
    b->scene.volume_count = 1;
    b->scene.project = LEAFCAST_PROJECT_MAX;
}

static const struct {
    const char *name;
    void (*make)(bench *b);
    bool counted;
} KINDS[] = {{"one medium", of_one, true},       {"and a surface", with_surface, true},
             {"two media", of_two, true},        {"a surface beside", surface_beside, true},
             {"a shaded medium", shaded, false}, {"a projection", projected, false}};

static void draw(const bench *b, const leafcast_scene *scene, levelled *p) {
    const leafcast_image image = image_of(p);
    assert_int_equal(
        leafcast_trace(b->of[0].volume, scene, &b->camera, &image, &p->stats, NULL, NULL),
        LEAFCAST_OK);
}

/* Returns how far the worst pixel is off. */
static double judge(const char *name, int lod, const levelled *exact, const levelled *got,
                    bool counted) {
    double worst = 0.0;
    uint64_t above = 0;
    for (int i = 0; i < PIXELS; i++) {
        const double sure = isfinite(exact->error[i]) ? exact->error[i] : 0.0;
        above += got->error[i] > ASKED;
        for (int c = 0; c < 4; c++) {
            const double off = fabs(got->rgba[i][c] - exact->rgba[i][c]);
            worst = fmax(worst, off);
            if (!(off <= got->error[i] + sure))
                fail_msg("%s, lod %d, pixel %d: off by %g, bound %g", name, lod, i, off,
                         got->error[i]);
        }
    }
    if (counted)
        assert_int_equal(above, got->stats.uncertified_pixels);
    return worst;
}

static void test_every_level(void **state) {
    static levelled exact, got;
    (void)state;
    for (size_t k = 0; k < sizeof KINDS / sizeof *KINDS; k++) {
        bench b = {0};
        double worst = 0.0;
        bench_make(&b);
        KINDS[k].make(&b);
        draw(&b, &b.scene, &exact);
        for (int lod = 0; lod < LODS; lod++)
            for (uint32_t level = 0; level < 2; level++) {
                leafcast_scene scene = b.scene;
                scene.lod = (leafcast_lod)lod;
                scene.lod_level = level;
                draw(&b, &scene, &got);
                worst = fmax(worst, judge(KINDS[k].name, lod, &exact, &got, KINDS[k].counted));
            }
        if (!(worst > ASKED))
            fail_msg("%s: levels look like the data, off by %g", KINDS[k].name, worst);
        bench_release(&b);
    }
}

/* Full resolution by another name is certified as before. */
static void test_level_0(void **state) {
    static levelled got;
    bench b = {0};
    (void)state;
    bench_make(&b);
    of_one(&b);
    b.scene.lod = LEAFCAST_LOD_LEVEL;
    draw(&b, &b.scene, &got);
    assert_int_equal(got.stats.uncertified_pixels, 0);
    b.scene.lod = LEAFCAST_LOD_PIXEL;
    b.camera.fov = 1e-3;
    draw(&b, &b.scene, &got);
    assert_int_equal(got.stats.uncertified_pixels, 0);
    bench_release(&b);
}

/* The certificate compares with full resolution, too. */
static void test_certificate(void **state) {
    static levelled coarse;
    certificate c = {0};
    bench b = {0};
    mem m;
    (void)state;
    mem_init(&m, 0);
    bench_make(&b);
    of_one(&b);
    b.scene.lod = LEAFCAST_LOD_LEVEL;
    b.scene.lod_level = 1;
    draw(&b, &b.scene, &coarse);
    const leafcast_image image = image_of(&coarse);
    assert_int_equal(certificate_make(b.of[0].volume, &b.scene, &b.camera, &image, &m, &c), ST_OK);
    assert_true(c.made && c.difference > ASKED && c.of_bounds <= 1.0);
    bench_release(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_every_level),
                                       cmocka_unit_test(test_level_0),
                                       cmocka_unit_test(test_certificate)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
