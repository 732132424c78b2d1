/* test_mesh_packet.c - packets of rays through meshes give the bits of single rays, whatever their
 * size, the ISA, the scene, the threads, the treelets and their number at a time; and large ones
 * save what W07 says they save. */
/* marks: long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "render/ray/open_volume.h"
#include "tests/support/fixture.h"
#include "tests/support/mesh_packet_wide.h"
#include "tests/support/mesh_pictures.h"
#include "tests/support/tet_batch_wide.h"
#include "tests/support/watched.h"

#ifdef __SANITIZE_ADDRESS__
enum { CUBES = 4, SCENES = 3, BALL = 16 };
#else
enum { CUBES = 6, SCENES = 12, BALL = 24 };
#endif

static const int SIDES[] = {2, 4, 8, 16};
enum { SIDE_COUNT = sizeof SIDES / sizeof *SIDES };

static void open_packets(picture_volumes *v, const char *path, const char *isa, int side,
                         int threads) {
    const leafcast_options o = {.size = sizeof(leafcast_options),
                                .isa = isa,
                                .threads = threads,
                                .experiments = EXPERIMENTS(.packets = side)};
    v->name[v->count] = isa;
    v->of[v->count++] = fixture_open(path, &o);
}

/* Single rays, then packets of every size by every ISA; as wide as AVX-512's, too. */
static picture_volumes open_all(const char *path, int threads) {
    picture_volumes v = {.count = 0};
    pictures_open_one(&v, path, "scalar", threads);
    for (int isa = 1; isa <= (int)cpu_best() && isa <= 3; isa++)
        for (int s = WATCHED ? isa % 2 : 0; s < SIDE_COUNT; s += WATCHED ? 2 : 1)
            open_packets(&v, path, cpu_isa_name((cpu_isa)isa), SIDES[s], threads);
    for (int s = 1; s < SIDE_COUNT; s += 2) {
        open_packets(&v, path, "scalar", SIDES[s], threads);
        v.of[v.count - 1]->kernels.tile = mesh_packet_wide;
        v.name[v.count - 1] = "wide";
    }
    return v;
}

static void test_every_mesh(void **state) {
    (void)state;
    assert_true(mesh_pictures_of_all(open_all, CUBES, 4, 78) > 5 * PICTURE_PIXELS);
}

static void test_every_scene(void **state) {
    (void)state;
    field_random r = {6};
    assert_true(mesh_pictures_of_scenes(open_all, "noise", CUBES + 4, SCENES, &r) >
                PICTURE_PIXELS / 8 * SCENES);
}

/* However the mesh is cut, and however few treelets are there at a time. */
static void test_treelets(void **state) {
    (void)state;
    static picture want, got;
    static const uint32_t sizes[] = {16384, 100}, limits[] = {1, 2, 19, 0};
    lab_mesh lab;
    assert_true(lab_mesh_make(&lab, "noise", CUBES + 4, 7));
    for (size_t i = 0; i < 2; i++) {
        const char *path = lab_leaf_make(&lab, sizes[i], false);
        const leafcast_options single = {
            .size = sizeof(leafcast_options), .isa = "scalar", .threads = 2};
        if (i == 0)
            mesh_pictures_draw(path, lab.iso, &single, &want);
        for (int k = 0; k < 4; k++) {
            for (int s = WATCHED ? k % 2 : 0; s < SIDE_COUNT; s += WATCHED ? 2 : 1) {
                const leafcast_options o = {
                    .size = sizeof(leafcast_options),
                    .threads = 2,
                    .experiments = EXPERIMENTS(.treelet_limit = limits[k], .packets = SIDES[s])};
                mesh_pictures_draw(path, lab.iso, &o, &got);
                assert_memory_equal(&want, &got, sizeof want);
            }
        }
    }
    lab_mesh_release(&lab);
}

/* ---- W07 table 4 ---- */

enum { BALL_SIDE = 512 };

static leafcast_stats count_ball(const char *path, int side, double *z) {
    const leafcast_options o = {.size = sizeof(leafcast_options),
                                .threads = 1,
                                .experiments = EXPERIMENTS(.packets = side)};
    leafcast *v = fixture_open(path, &o);
    const leafcast_surface surface = leafcast_surface_default(0.3);
    const leafcast_scene scene = leafcast_scene_default();
    const leafcast_image image = {.size = sizeof(leafcast_image), .z = z};
    leafcast_stats stats = {.size = sizeof stats};
    assert_int_equal(leafcast_select(v, &surface, 1), LEAFCAST_OK);
    const leafcast_camera c = leafcast_standard_view(v, 2.2, BALL_SIDE, BALL_SIDE);
    /* Twice: nothing is counted again because it was not there. */
    for (int i = 0; i < 2; i++)
        assert_int_equal(leafcast_trace(v, &scene, &c, &image, &stats, NULL, NULL), LEAFCAST_OK);
    leafcast_close(v);
    return stats;
}

static void fewer(const char *what, uint64_t small, uint64_t large, double least) {
    const double ratio = (double)small / (double)large;
    if (!(ratio >= least))
        fail_msg("%s: %llu by 2 x 2, %llu by 16 x 16: x %.2f, not x %g", what,
                 (unsigned long long)small, (unsigned long long)large, ratio, least);
    print_message("%s: x %.1f\n", what, ratio);
}

static void test_counts(void **state) {
    (void)state;
    const size_t bytes = (size_t)BALL_SIDE * BALL_SIDE * sizeof(double);
    if (WATCHED || !mesh_packet_kernels[cpu_best()])
        skip();
    double *z[2] = {malloc(bytes), malloc(bytes)};
    const char *path = lab_leaf_field("buckyball", BALL);
    const leafcast_stats small = count_ball(path, 2, z[0]), large = count_ball(path, 16, z[1]);
    assert_memory_equal(z[0], z[1], bytes);
    fewer("box tests", small.box_tests, large.box_tests, 30);
    fewer("isorange tests", small.isorange_tests, large.isorange_tests, 18);
    fewer("isopolygons", small.isopolygons, large.isopolygons, 10);
    /* A packet of 2 x 2 tests all its rays, and no intervals. */
    assert_int_equal(small.box_tests % 4, 0);
    assert_true(small.polygon_tests <= 4 * small.isopolygons);
    assert_int_equal(small.interval_tests, 0);
    assert_true(large.interval_tests > 0 && large.polygon_tests < 256 * large.isopolygons);
    const leafcast_stats tiles = count_ball(path, 0, z[1]);
    assert_memory_equal(z[0], z[1], bytes);
    assert_int_equal(tiles.isorange_tests + tiles.box_tests + tiles.isopolygons, 0);
    free(z[0]);
    free(z[1]);
}

static void test_refused(void **state) {
    (void)state;
    lab_mesh lab;
    leafcast *v = NULL;
    assert_true(lab_mesh_make(&lab, "sphere", 3, 7));
    const leafcast_options o = {.size = sizeof(leafcast_options),
                                .experiments = EXPERIMENTS(.packets = 3)};
    assert_int_equal(leafcast_open(lab_leaf_make(&lab, 300, false), &o, &v), LEAFCAST_USAGE);
    assert_non_null(strstr(leafcast_error_text(), "packets is 3"));
    lab_mesh_release(&lab);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_mesh), cmocka_unit_test(test_every_scene),
        cmocka_unit_test(test_treelets),   cmocka_unit_test(test_counts),
        cmocka_unit_test(test_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
