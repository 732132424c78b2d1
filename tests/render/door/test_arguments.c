/* test_arguments.c - what callers of leafcast.h pass wrongly is LEAFCAST_USAGE, and is named: sizes
 * of structs, values that no enumeration has, counts. Nothing is written, and the volume stays
 * usable. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <string.h>

#include "tests/support/fixture.h"

enum { SIDE = 4 };

typedef struct lab {
    leafcast *volume;
    leafcast_scene scene;
    leafcast_camera camera;
    leafcast_image image;
    leafcast_stats stats;
    double z[SIDE * SIDE];
} lab;

static field sphere;
static const char *path;

static void reset(lab *l) {
    l->scene = leafcast_scene_default();
    l->camera = leafcast_standard_view(l->volume, 2.2, SIDE, SIDE);
    l->image = (leafcast_image){.size = sizeof l->image, .z = l->z};
    l->stats = (leafcast_stats){.size = sizeof l->stats};
}

static int set_up(void **state) {
    static lab l;
    if (!field_make(&sphere, "sphere", 9, FIELD_SEED))
        return 1;
    path = fixture_leaf(&sphere, 4, 1, false);
    const leafcast_surface surface = leafcast_surface_default(sphere.iso);
    const leafcast_options o = {.size = sizeof o, .threads = 1};
    l.volume = fixture_open(path, &o);
    reset(&l);
    *state = &l;
    return leafcast_select(l.volume, &surface, 1) != LEAFCAST_OK;
}

static int tear_down(void **state) {
    leafcast_close(((lab *)*state)->volume);
    field_release(&sphere);
    return 0;
}

static leafcast_status trace(lab *l) {
    return leafcast_trace(l->volume, &l->scene, &l->camera, &l->image, &l->stats, NULL, NULL);
}

static void named(leafcast_status st, const char *name) {
    assert_int_equal(st, LEAFCAST_USAGE);
    if (!strstr(leafcast_error_text(), name))
        fail_msg("\"%s\" says nothing of %s", leafcast_error_text(), name);
}

/* Refused by a picture, by the question for room and by a ray if these look at it; then all is well
 * again. */
static void refused(lab *l, const char *name, bool of_scene) {
    const double origin[3] = {0, 0, 0}, direction[3] = {1, 0, 0};
    leafcast_hit hit;
    int count;
    for (int i = 0; i < SIDE * SIDE; i++)
        l->z[i] = 7;
    named(trace(l), name);
    for (int i = 0; i < SIDE * SIDE; i++)
        assert_true(l->z[i] == 7);
    if (strcmp(name, "leafcast_stats.size") != 0)
        named(leafcast_check_room(l->volume, &l->scene, &l->camera, &l->image, 0), name);
    if (of_scene)
        named(leafcast_probe_ray(l->volume, &l->scene, origin, direction, &hit, 1, &count), name);
    reset(l);
    assert_int_equal(trace(l), LEAFCAST_OK);
    assert_true(l->z[0] != 7);
}

static void test_pictures(void **state) {
    lab *l = *state;
    const size_t wrong[] = {0, 8, SIZE_MAX};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        l->scene.size = wrong[i];
        refused(l, "leafcast_scene.size", true);
        l->camera.size = wrong[i];
        refused(l, "leafcast_camera.size", false);
        l->image.size = wrong[i];
        refused(l, "leafcast_image.size", false);
        l->stats.size = wrong[i];
        refused(l, "leafcast_stats.size", false);
        l->scene.experiments = &(leafcast_scene_experiments){.size = wrong[i]};
        refused(l, "leafcast_scene.experiments.size", true);
    }
    for (int i = 0; i < 2; i++) {
        l->scene.shading = (leafcast_shading)(i ? -1 : LEAFCAST_SHADING_FLAT + 1);
        refused(l, "leafcast_scene.shading", true);
        l->scene.lod = (leafcast_lod)(i ? -1 : LEAFCAST_LOD_PIXEL + 1);
        refused(l, "leafcast_scene.lod", true);
        l->scene.experiments = INTERSECTOR((leafcast_intersector)(i ? -1 : LEAFCAST_SCHWARZE + 1));
        refused(l, "leafcast_scene.experiments.intersector", true);
        l->scene.light_count = i ? -1 : LEAFCAST_LIGHTS_MAX + 1;
        refused(l, "leafcast_scene.light_count", true);
        l->scene.clip_plane_count = i ? -1 : LEAFCAST_CLIP_PLANES_MAX + 1;
        refused(l, "leafcast_scene.clip_plane_count", true);
    }
    l->scene.samples = 2;
    refused(l, "samples", true);
}

static void test_filled_by_the_library(void **state) {
    lab *l = *state;
    leafcast_info info = {.size = 3};
    leafcast_scene scene = {.size = 3};
    leafcast_camera camera = {.size = 3};
    double origin[3], direction[3];
    const double iso = 0.5;
    named(leafcast_get_info(l->volume, &info), "leafcast_info.size");
    named(leafcast_init_scene(&scene), "leafcast_scene.size");
    named(leafcast_get_standard_view(l->volume, 2.2, 4, 4, &camera), "leafcast_camera.size");
    named(leafcast_fit_view(l->volume, 0, 0, &iso, 1, 0, 4, 4, &camera), "leafcast_camera.size");
    assert_true(info.size == 3 && scene.size == 3 && camera.size == 3 && camera.width == 0);
    camera = l->camera;
    leafcast_pixel_ray(&camera, 1, 1, origin, direction);
    assert_true(direction[0] != 0);
    camera.size--;
    leafcast_pixel_ray(&camera, 1, 1, origin, direction);
    assert_true(direction[0] == 0 && direction[1] == 0 && direction[2] == 0);
}

static void bad_options(leafcast_options o, const char *name) {
    leafcast *volume = NULL;
    named(leafcast_open(path, &o, &volume), name);
    assert_null(volume);
}

static void test_options(void **state) {
    (void)state;
    const leafcast_options good = {.size = sizeof good, .threads = 1};
    leafcast_options o = good;
    o.size++;
    bad_options(o, "leafcast_options.size");
    for (int i = 0; i < 2; i++) {
        o = good;
        o.backend = (leafcast_backend)(i ? -1 : LEAFCAST_BACKEND_ARENA + 1);
        bad_options(o, "leafcast_options.backend");
        o = good;
        leafcast_experiments e = {.size = i ? 0 : sizeof e + 1};
        o.experiments = &e;
        bad_options(o, "leafcast_options.experiments.size");
        e = (leafcast_experiments){.size = sizeof e};
        e.schema = (leafcast_schema)(i ? -1 : LEAFCAST_SCHEMA_REFIT + 1);
        bad_options(o, "leafcast_options.experiments.schema");
        e = (leafcast_experiments){.size = sizeof e};
        e.isopolygons = (leafcast_isopolygons)(i ? -1 : LEAFCAST_ISOPOLYGONS_CACHE + 1);
        bad_options(o, "leafcast_options.experiments.isopolygons");
    }
}

/* ---- Experiments are the caller's, and may be gone after the call ---- */

static uint64_t resident(const char *leaf, leafcast_experiments e) {
    const leafcast_options o = {.size = sizeof o, .threads = 1, .experiments = &e};
    const leafcast_surface surface = leafcast_surface_default(sphere.iso);
    lab l = {.volume = fixture_open(leaf, &o)};
    memset(&e, 0xff, sizeof e);
    assert_int_equal(leafcast_select(l.volume, &surface, 1), LEAFCAST_OK);
    reset(&l);
    l.scene.sweep = true;
    assert_int_equal(trace(&l), LEAFCAST_OK);
    leafcast_close(l.volume);
    return l.stats.bytes_resident;
}

static void test_of_a_volume(void **state) {
    (void)state;
    field f;
    assert_true(field_make(&f, "sphere", 49, FIELD_SEED));
    const char *leaf = fixture_leaf(&f, 4, 1, false);
    field_release(&f);
    const leafcast_experiments none = {.size = sizeof none};
    const uint64_t one = resident(leaf, *EXPERIMENTS(.treelet_limit = 1)),
                   two = resident(leaf, *EXPERIMENTS(.treelet_limit = 2));
    assert_true(0 < one && one < two && two < resident(leaf, none));
}

static void test_of_a_scene(void **state) {
    lab *l = *state;
    double middle[SIDE * SIDE];
    leafcast_scene_experiments e = *INTERSECTOR(LEAFCAST_MIDPOINT);
    leafcast_frame *frame = NULL;
    bool done = false;
    l->scene.experiments = &e;
    assert_int_equal(trace(l), LEAFCAST_OK);
    memcpy(middle, l->z, sizeof middle);
    assert_int_equal(leafcast_frame_begin(l->volume, &l->scene, &l->camera, &l->image, &frame),
                     LEAFCAST_OK);
    memset(&e, 0xff, sizeof e);
    reset(l);
    assert_int_equal(trace(l), LEAFCAST_OK);
    assert_memory_not_equal(middle, l->z, sizeof middle);
    assert_int_equal(leafcast_frame_advance(frame, INFINITY, &done, NULL), LEAFCAST_OK);
    leafcast_frame_end(frame);
    assert_true(done);
    assert_memory_equal(middle, l->z, sizeof middle);
}

static void test_version(void **state) {
    (void)state;
    assert_string_equal(leafcast_version(), LEAFCAST_VERSION);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pictures),   cmocka_unit_test(test_filled_by_the_library),
        cmocka_unit_test(test_options),    cmocka_unit_test(test_of_a_volume),
        cmocka_unit_test(test_of_a_scene), cmocka_unit_test(test_version),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
