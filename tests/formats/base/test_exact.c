/* test_exact.c - the exact picture is the same bits whatever was resident when: any budget, treelet
 * size, backend, codec, number of threads. */
/* marks: threads, long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <string.h>

#include "formats/base/hash.h"
#include "tests/support/fixture.h"
#include "tests/support/watched.h"

/* Smaller pictures where every access is watched. */
enum { SIDE = WATCHED_THREADS ? 12 : WATCHED_MEMORY ? 20 : 56 };
enum { PIXELS = SIDE * SIDE, N = 53 };

typedef struct picture {
    float rgba[4][PIXELS], normal[3][PIXELS];
    double z[PIXELS];
    int32_t id[PIXELS];
} picture;

static leafcast_scene rich_scene(void) {
    leafcast_scene scene = leafcast_scene_default();
    scene.light_count = 2;
    scene.lights[0] = (leafcast_light){false, {1, 0.5, 2}, {0.8f, 0.8f, 0.7f}, 0};
    scene.lights[1] = (leafcast_light){true, {200, -80, 90}, {0.3f, 0.3f, 0.4f}, 0};
    scene.shadows = true;
    scene.shading = LEAFCAST_SHADING_PHONG;
    return scene;
}

static void select_three(leafcast *volume, double iso) {
    leafcast_surface s[3];
    for (int i = 0; i < 3; i++) {
        s[i] = leafcast_surface_default(iso * (0.8 + 0.2 * i));
        s[i].opacity = 0.35f;
        s[i].rgb[i] = 0.2f;
    }
    assert_int_equal(leafcast_select(volume, s, 3), LEAFCAST_OK);
}

static hash_id draw(const char *path, const leafcast_options *options, const leafcast_scene *scene,
                    double iso, leafcast_stats *stats) {
    static picture p;
    memset(&p, 0, sizeof p);
    leafcast *volume = fixture_open(path, options);
    select_three(volume, iso);
    const leafcast_camera camera = leafcast_standard_view(volume, 1.1, SIDE, SIDE);
    const leafcast_image image = {.size = sizeof image,
                                  .r = p.rgba[0],
                                  .g = p.rgba[1],
                                  .b = p.rgba[2],
                                  .a = p.rgba[3],
                                  .z = p.z,
                                  .normal = {p.normal[0], p.normal[1], p.normal[2]},
                                  .id = p.id,
                                  .provisional = NULL};
    assert_int_equal(leafcast_trace(volume, scene, &camera, &image, stats, NULL, NULL),
                     LEAFCAST_OK);
    leafcast_close(volume);
    return hash_identity(&p, sizeof p);
}

static void assert_same(hash_id a, hash_id b) {
    assert_true(a.lo == b.lo && a.hi == b.hi);
}

static field waves(void) {
    field f;
    assert_true(field_make(&f, "waves", N, FIELD_SEED));
    return f;
}

static void test_any_budget(void **state) {
    (void)state;
    field f = waves();
    const char *path = fixture_leaf(&f, 4, 1, false);
    const leafcast_scene scene = rich_scene();
    leafcast_stats all = {.size = sizeof(leafcast_stats)}, some = {.size = sizeof(leafcast_stats)};
    const hash_id want = draw(path, NULL, &scene, f.iso, &all);
    assert_true(all.shadow_rays > PIXELS / 4);
    assert_true(all.bytes_read <= all.bytes_active);
    const uint32_t limits[] = {1, 2, 17};
    for (size_t i = 0; i < 3; i++)
        for (leafcast_backend b = LEAFCAST_BACKEND_MAPPED; b <= LEAFCAST_BACKEND_ARENA; b++)
            for (int threads = WATCHED_THREADS ? 3 : 1; threads <= 3; threads += 2) {
                const leafcast_options o = {.size = sizeof(leafcast_options),
                                            .experiments = EXPERIMENTS(.treelet_limit = limits[i]),
                                            .threads = threads,
                                            .backend = b};
                assert_same(draw(path, &o, &scene, f.iso, &some), want);
                assert_int_equal(some.rays, all.rays);
            }
    field_release(&f);
}

static void test_any_memory(void **state) {
    (void)state;
    field f = waves();
    const char *path = fixture_leaf(&f, 4, 1, false);
    const leafcast_scene scene = rich_scene();
    leafcast_stats stats = {.size = sizeof stats};
    const hash_id want = draw(path, NULL, &scene, f.iso, &stats);
    /* The smallest budget is found by asking for too little. */
    leafcast_options o = {.size = sizeof(leafcast_options), .memory = 32 << 20, .threads = 2};
    while (o.memory > 1 << 10) {
        leafcast *volume = NULL;
        leafcast_status st = leafcast_open(path, &o, &volume);
        if (st == LEAFCAST_OK) {
            select_three(volume, f.iso);
            const leafcast_camera camera = leafcast_standard_view(volume, 1.1, SIDE, SIDE);
            const leafcast_image none = {.size = sizeof(leafcast_image)};
            st = leafcast_trace(volume, &scene, &camera, &none, &stats, NULL, NULL);
            assert_true(stats.bytes_peak <= o.memory);
            leafcast_close(volume);
        }
        if (st == LEAFCAST_NOMEM)
            break;
        assert_int_equal(st, LEAFCAST_OK);
        o.memory = o.memory * 3 / 4;
    }
    assert_true(o.memory < 8 << 20);
    o.memory = o.memory * 2 + PIXELS * 48;
    assert_same(draw(path, &o, &scene, f.iso, &stats), want);
    assert_true(stats.bytes_peak <= o.memory);
    field_release(&f);
}

static void test_any_file(void **state) {
    (void)state;
    skip_under_thread();
    field f = waves();
    const leafcast_scene scene = rich_scene();
    leafcast_stats stats = {.size = sizeof stats};
    const hash_id want = draw(fixture_leaf(&f, 4, 1, false), NULL, &scene, f.iso, &stats);
    assert_same(draw(fixture_leaf(&f, 5, 1, false), NULL, &scene, f.iso, &stats), want);
    assert_same(draw(fixture_leaf(&f, 6, 1, false), NULL, &scene, f.iso, &stats), want);
    assert_same(draw(fixture_leaf(&f, 4, 1, true), NULL, &scene, f.iso, &stats), want);
    /* Without a halo normals come from the cell alone, as they do on request with one. */
    leafcast_scene analytic = scene;
    analytic.analytic_normals = true;
    assert_same(draw(fixture_leaf(&f, 4, 0, false), NULL, &scene, f.iso, &stats),
                draw(fixture_leaf(&f, 5, 1, false), NULL, &analytic, f.iso, &stats));
    field_release(&f);
}

static void test_alternative_walks(void **state) {
    (void)state;
    skip_under_thread();
    field f = waves();
    const char *path = fixture_leaf(&f, 4, 1, false);
    const leafcast_scene scene = rich_scene();
    leafcast_stats stats = {.size = sizeof stats};
    const hash_id want = draw(path, NULL, &scene, f.iso, &stats);
    const char *names[] = {"scalar", "scalar-groups", "scalar-corners"};
    for (int i = 0; i < 3; i++) {
        const leafcast_options o = {.size = sizeof(leafcast_options), .isa = names[i]};
        assert_same(draw(path, &o, &scene, f.iso, &stats), want);
        assert_string_equal(stats.isa, names[i]);
    }
    field_release(&f);
}

static void test_reads_what_it_needs(void **state) {
    (void)state;
    field f;
    leafcast_stats stats = {.size = sizeof stats};
    assert_true(field_make(&f, "sphere", N, FIELD_SEED));
    const char *path = fixture_leaf(&f, 4, 1, false);
    leafcast_scene scene = leafcast_scene_default();
    scene.sweep = true;
    (void)draw(path, NULL, &scene, f.iso, &stats);
    assert_true(stats.bytes_active > 0);
    assert_int_equal(stats.bytes_read, stats.bytes_active);
    /* By the rays' own demand: no more than what they touched, and each treelet once. */
    scene.sweep = false;
    (void)draw(path, NULL, &scene, f.iso, &stats);
    assert_true(stats.bytes_read < stats.bytes_active);
    assert_int_equal(stats.bytes_read, stats.bytes_visible);
    /* An isovalue that nothing contains loads nothing. */
    (void)draw(path, NULL, &scene, 1e6, &stats);
    assert_int_equal(stats.treelets_loaded, 0);
    assert_int_equal(stats.bytes_read, 0);
    field_release(&f);
}

static void test_preview_becomes_exact(void **state) {
    (void)state;
    static picture p;
    field f = waves();
    leafcast_stats stats = {.size = sizeof stats};
    leafcast *volume = fixture_open(fixture_leaf(&f, 4, 1, false), NULL);
    select_three(volume, f.iso);
    const leafcast_camera camera = leafcast_standard_view(volume, 1.1, SIDE, SIDE);
    static uint8_t provisional[PIXELS];
    const leafcast_image image = {.size = sizeof image,
                                  .r = p.rgba[0],
                                  .g = p.rgba[1],
                                  .b = p.rgba[2],
                                  .a = p.rgba[3],
                                  .z = p.z,
                                  .normal = {p.normal[0], p.normal[1], p.normal[2]},
                                  .id = p.id,
                                  .provisional = provisional};
    leafcast_scene scene = leafcast_scene_default();
    scene.preview = true;
    /* The loader goes on between frames: sooner or later nothing is provisional. */
    uint64_t left = 1;
    for (int i = 0; i < 10000 && left > 0; i++) {
        assert_int_equal(leafcast_trace(volume, &scene, &camera, &image, &stats, NULL, NULL),
                         LEAFCAST_OK);
        left = stats.provisional_pixels;
        uint64_t marked = 0;
        for (int k = 0; k < PIXELS; k++)
            marked += provisional[k];
        assert_int_equal(marked, left);
    }
    assert_int_equal(left, 0);
    leafcast_close(volume);
    field_release(&f);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_any_budget),
        cmocka_unit_test(test_any_memory),
        cmocka_unit_test(test_any_file),
        cmocka_unit_test(test_alternative_walks),
        cmocka_unit_test(test_reads_what_it_needs),
        cmocka_unit_test(test_preview_becomes_exact),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
