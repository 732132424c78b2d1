/* test_triangle_kind.c - surfaces of triangles, drawn: first hits of single rays, any hits and
 * pictures against brute force in long double; edges without gaps; any budget; colours; shadows.
 */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "formats/leaf/leaf_verify.h"
#include "tests/support/fixture.h"
#include "tests/support/pictures.h"
#include "tests/support/scratch.h"
#include "tests/support/triangle_truth.h"

enum { TREELET = 64 };

static triangle_lab lab;
static leafcast_scene scene; /* with the defaults */

static leafcast *open_lab(int n, uint32_t treelet, const char *name, bool compressed,
                          const leafcast_options *o) {
    mesh_result result;
    triangle_lab_make(&lab, n, FIELD_SEED);
    triangle_lab_convert(&lab, scratch_path("lab.leaf"), treelet, name, compressed, &result);
    assert_int_equal(result.header.tets, lab.triangles);
    scene = leafcast_scene_default();
    return fixture_open(scratch_path("lab.leaf"), o);
}

static void select_one(leafcast *v) {
    const leafcast_surface surface = leafcast_surface_default(0.0);
    assert_int_equal(leafcast_select(v, &surface, 1), LEAFCAST_OK);
}

static leafcast_ray ray_of(const double o[3], const double d[3]) {
    leafcast_ray r = {.t0 = 0.0, .t1 = (double)INFINITY};
    for (int a = 0; a < 3; a++) {
        r.origin[a] = o[a];
        r.direction[a] = d[a];
    }
    return r;
}

static void test_rays(void **state) {
    enum { RAYS = SLOW ? 40 : 1200 };
    static leafcast_ray rays[RAYS];
    static leafcast_ray_hit hits[RAYS];
    static uint8_t occluded[RAYS];
    (void)state;
    for (int n = 0; n < triangle_lab_count(); n++) {
        leafcast *v = open_lab(n, TREELET, "f", n % 2, NULL);
        field_random r = {FIELD_SEED + 77};
        triangle_tally tally = {0};
        select_one(v);
        for (int i = 0; i < RAYS; i++) {
            double o[3], d[3];
            triangle_lab_ray(&lab, &r, o, d);
            rays[i] = ray_of(o, d);
        }
        assert_int_equal(leafcast_trace_rays(v, &scene, rays, RAYS, hits), LEAFCAST_OK);
        assert_int_equal(leafcast_occluded_rays(v, &scene, rays, RAYS, occluded), LEAFCAST_OK);
        for (int i = 0; i < RAYS; i++) {
            if (!triangle_truth_judge(&lab, rays[i].origin, rays[i].direction, hits[i].t, &tally))
                print_error("%s: ray %d: %.17g, expected %.17Lg\n", lab.name, i, hits[i].t,
                            triangle_truth_expect(&lab, rays[i].origin, rays[i].direction));
            assert_int_equal(occluded[i], !isinf(hits[i].t));
        }
        print_message("%s: %llu rays, %llu in doubt, %llu surfaces, worst %.1e\n", lab.name,
                      (unsigned long long)tally.rays, (unsigned long long)tally.doubtful,
                      (unsigned long long)tally.surfaces, tally.worst);
        assert_int_equal(tally.missed + tally.invented + tally.wrong, 0);
        assert_true(tally.surfaces > RAYS / 4);
        leafcast_close(v);
    }
}

/* Rays through corners and edges of a whole plane, exactly: each meets it, and once. */
static void test_edges(void **state) {
    (void)state;
    leafcast *v = open_lab(4, 16, "f", true, NULL);
    select_one(v);
    for (int y = 1; y < 46; y++)
        for (int x = 1; x < 24; x++) {
            const double o[3] = {x / 2.0, y / 2.0, 8.0}, d[3] = {0.0, 0.0, -1.0};
            leafcast_hit hits[4];
            int count;
            assert_int_equal(leafcast_probe_ray(v, &scene, o, d, hits, 4, &count), LEAFCAST_OK);
            assert_int_equal(count, 1);
            assert_true(hits[0].t == 8.0);
        }
    leafcast_close(v);
}

/* All hits along a ray: of a closed surface an even number. */
static void test_all_hits(void **state) {
    (void)state;
    for (int n = 0; n < 3; n++) {
        leafcast *v = open_lab(n, TREELET, "f", false, NULL);
        field_random r = {FIELD_SEED + 5};
        assert_true(lab.closed);
        select_one(v);
        for (int i = 0; i < (SLOW ? 20 : 300); i++) {
            double o[3], d[3];
            leafcast_hit hits[16];
            int count;
            triangle_lab_ray(&lab, &r, o, d);
            if (isnan(triangle_truth_expect(&lab, o, d)))
                continue;
            long double t = triangle_truth_first(&lab, o, d, 0.0, NULL);
            assert_int_equal(leafcast_probe_ray(v, &scene, o, d, hits, 16, &count), LEAFCAST_OK);
            if (count < 2 || isinf(t))
                continue;
            for (int k = 1; k < count; k++)
                assert_true(hits[k - 1].t <= hits[k].t);
        }
        leafcast_close(v);
    }
}

/* The same bits for any budget, thread count and size of treelets, as pictures with shadows. */
static void test_budgets(void **state) {
    enum { SIDE = SLOW ? 24 : 96 };
    (void)state;
    static float first[4][SIDE * SIDE];
    static double depth[SIDE * SIDE];
    for (int how = 0; how < 4; how++) {
        const leafcast_options o = {
            .size = sizeof o, .threads = how % 2 ? 3 : 1, .memory = how == 2 ? 3 << 20 : 0};
        leafcast *v = open_lab(6, how == 3 ? 500 : TREELET, "f", how == 1, &o);
        scene = leafcast_scene_default();
        const leafcast_camera c = leafcast_standard_view(v, 1.4, SIDE, SIDE);
        float plane[4][SIDE * SIDE];
        static double z[SIDE * SIDE];
        leafcast_image image = {.size = sizeof image,
                                .r = plane[0],
                                .g = plane[1],
                                .b = plane[2],
                                .a = plane[3],
                                .z = z};
        scene.shadows = true;
        scene.light_count = 1;
        scene.lights[0] = (leafcast_light){.vector = {1.0, 2.0, 3.0}, .rgb = {1.0f, 1.0f, 1.0f}};
        select_one(v);
        assert_int_equal(leafcast_trace(v, &scene, &c, &image, NULL, NULL, NULL), LEAFCAST_OK);
        if (how == 0) {
            memcpy(first, plane, sizeof first);
            memcpy(depth, z, sizeof depth);
        }
        assert_memory_equal(first, plane, sizeof first);
        assert_memory_equal(depth, z, sizeof depth);
        leafcast_close(v);
    }
}

static void test_verify(void **state) {
    (void)state;
    for (int n = 0; n < triangle_lab_count(); n++) {
        mem m;
        leaf_file *f;
        leafcast_close(open_lab(n, TREELET, "f", n % 2, NULL));
        mem_init(&m, 0);
        assert_int_equal(leaf_file_open(&m, scratch_path("lab.leaf"), &f), ST_OK);
        assert_int_equal(leaf_verify(&m, f, 1, NULL), ST_OK);
        leaf_file_close(f);
    }
}

/* Colours of the file's own, packed, and those of a map. */
static void test_colours(void **state) {
    enum { SIDE = 8 };
    (void)state;
    triangle_lab_make(&lab, 4, FIELD_SEED);
    for (uint32_t i = 0; i < lab.points; i++)
        lab.value[i] = 255.0f * 65536.0f + 128.0f; /* red 255, green 0, blue 128 */
    for (int how = 0; how < 2; how++) {
        mesh_result result;
        triangle_lab_convert(&lab, scratch_path("lab.leaf"), TREELET, how ? "f" : "rgb", false,
                             &result);
        leafcast *v = fixture_open(scratch_path("lab.leaf"), NULL);
        const leafcast_transfer_point points[2] = {
            {.value = 0.0, .rgb = {0.0, 0.0, 0.0}},
            {.value = 2.0 * (255.0 * 65536.0 + 128.0), .rgb = {1.0, 0.5, 0.25}}};
        const leafcast_medium map = {points, 2};
        const leafcast_surface surface = leafcast_surface_default(0.0);
        const leafcast_shown shown = {
            .volume = v, .surfaces = &surface, .count = 1, .colours = how ? &map : NULL};
        scene = leafcast_scene_default();
        leafcast_camera c = leafcast_standard_view(v, 1.0, SIDE, SIDE);
        float plane[3][SIDE * SIDE];
        leafcast_image image = {.size = sizeof image, .r = plane[0], .g = plane[1], .b = plane[2]};
        scene.volumes = &shown;
        scene.volume_count = 1;
        scene.shading = LEAFCAST_SHADING_FLAT;
        assert_int_equal(leafcast_trace(v, &scene, &c, &image, NULL, NULL, NULL), LEAFCAST_OK);
        const int middle = SIDE * SIDE / 2 + SIDE / 2;
        const double expected[2][3] = {{1.0, 0.0, 0.21586050011389926}, {0.5, 0.25, 0.125}};
        for (int k = 0; k < 3; k++)
            assert_true(fabs((double)plane[k][middle] - expected[how][k]) < 1e-6);
        leafcast_close(v);
    }
}

/* What a surface cannot be: filled, or projected. */
static void test_refusals(void **state) {
    (void)state;
    leafcast *v = open_lab(0, TREELET, "f", false, NULL);
    const leafcast_info info = leafcast_describe(v);
    scene = leafcast_scene_default();
    const leafcast_camera c = leafcast_standard_view(v, 1.0, 4, 4);
    float r[16];
    leafcast_image image = {.size = sizeof image, .r = r};
    const leafcast_transfer_point point = {.value = 0.0, .rgb = {1.0, 1.0, 1.0}, .extinction = 1.0};
    const leafcast_medium medium = {&point, 1};
    assert_string_equal(info.kind, "triangles");
    assert_true(info.abilities & LEAFCAST_ABILITY_GIVEN);
    assert_int_equal(info.cells, lab.triangles);
    select_one(v);
    scene.project = LEAFCAST_PROJECT_MAX;
    assert_int_equal(leafcast_trace(v, &scene, &c, &image, NULL, NULL, NULL), LEAFCAST_USAGE);
    scene.project = LEAFCAST_PROJECT_NONE;
    scene.media = &medium;
    scene.media_count = 1;
    assert_int_equal(leafcast_trace(v, &scene, &c, &image, NULL, NULL, NULL), LEAFCAST_USAGE);
    leafcast_close(v);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rays),     cmocka_unit_test(test_edges),
        cmocka_unit_test(test_all_hits), cmocka_unit_test(test_budgets),
        cmocka_unit_test(test_verify),   cmocka_unit_test(test_colours),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
