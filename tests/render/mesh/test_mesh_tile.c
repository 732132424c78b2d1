/* test_mesh_tile.c - pictures of meshes: tiles of rays give the bits of single rays, whatever the
 * ISA, the view, the scene, the threads, the treelets and their number at a time; and these are
 * what the reference says. */
/* marks: long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "render/ray/open_volume.h"
#include "tests/support/fixture.h"
#include "tests/support/mesh_pictures.h"
#include "tests/support/mesh_tile_wide.h"
#include "tests/support/tet_judge.h"
#include "tests/support/tet_meshes.h"

#ifdef __SANITIZE_ADDRESS__
enum { CUBES = 4, SCENES = 12, STEP = 23 };
#else
enum { CUBES = 6, SCENES = 18, STEP = 7 };
#endif

static void open_wide(picture_volumes *v, const char *path, int threads) {
    pictures_open_one(v, path, "scalar", threads);
    v->of[v->count - 1]->kernels.tile = mesh_tile_wide;
    v->name[v->count - 1] = "wide";
}

static picture_volumes open_all(const char *path, int threads) {
    picture_volumes v = pictures_open(path, threads);
    open_wide(&v, path, threads);
    return v;
}

/* ---- The same bits ---- */

static void test_every_mesh(void **state) {
    (void)state;
    assert_true(mesh_pictures_of_all(open_all, CUBES, 2, 77) > 50000);
}

static void test_every_scene(void **state) {
    (void)state;
    field_random r = {5};
    assert_true(mesh_pictures_of_scenes(open_all, "sphere", CUBES + 4, SCENES, &r) > 200 * SCENES);
    assert_true(mesh_pictures_of_scenes(open_all, "noise", CUBES + 4, SCENES, &r) > 200 * SCENES);
}

/* More surfaces on a ray than a walk has room for, too. */
static void test_many_layers(void **state) {
    (void)state;
    static const char *const names[] = {"sphere", "noise"};
    int hits = 0;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        lab_mesh lab;
        assert_true(lab_mesh_make(&lab, names[i], CUBES + 4, 7));
        picture_volumes v = open_all(lab_leaf_make(&lab, 700, false), 2);
        hits += pictures_of_layers(&v, lab.iso, 0.04, lab.name);
        pictures_close(&v);
        lab_mesh_release(&lab);
    }
    print_message("%d pixels with surfaces\n", hits);
    assert_true(hits > 5000);
}

/* However the mesh is cut, and however few treelets are there at a time. */
static void test_treelets(void **state) {
    (void)state;
    static picture want, got;
    static const uint32_t sizes[] = {16384, 700, 100};
    lab_mesh lab;
    assert_true(lab_mesh_make(&lab, "noise", CUBES + 4, 7));
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        const char *path = lab_leaf_make(&lab, sizes[i], false);
        for (uint32_t limit = 0; limit < 20; limit += limit < 2 ? 1 : 17) {
            for (int isa = 0; isa <= (int)cpu_best(); isa++) {
                const bool first = i == 0 && limit == 0 && isa == 0;
                const leafcast_options o = {.size = sizeof(leafcast_options),
                                            .isa = cpu_isa_name((cpu_isa)isa),
                                            .threads = 2,
                                            .experiments = EXPERIMENTS(.treelet_limit = limit)};
                mesh_pictures_draw(path, lab.iso, &o, first ? &want : &got);
                if (!first)
                    assert_memory_equal(&want, &got, sizeof want);
            }
        }
    }
    lab_mesh_release(&lab);
}

/* A picture by one thread and this kernel, with so many treelets at a time. */
static leafcast_stats draw_with(const char *path, double iso, tile_fn kernel, uint32_t limit,
                                int view) {
    static picture p;
    const leafcast_options o = {.size = sizeof(leafcast_options),
                                .threads = 1,
                                .experiments = EXPERIMENTS(.treelet_limit = limit)};
    const leafcast_surface surface = leafcast_surface_default(iso);
    const leafcast_scene scene = leafcast_scene_default();
    leafcast_stats stats = {.size = sizeof stats};
    field_random r = {(uint64_t)view};
    leafcast *v = NULL;
    assert_int_equal(leafcast_open(path, &o, &v), LEAFCAST_OK);
    assert_int_equal(leafcast_select(v, &surface, 1), LEAFCAST_OK);
    v->kernels.tile = kernel;
    const leafcast_camera c = pictures_view(v, 0, &r);
    pictures_draw(v, &scene, &c, &p, &stats);
    leafcast_close(v);
    return stats;
}

/* What lies behind a surface is not brought in: polygons that wait until they fill a vector are met
 * before another treelet is looked for. So treelets that are just enough for narrow vectors, and
 * few more, are for wide ones, in one pass. */
static void test_hidden_treelets(void **state) {
    (void)state;
    enum { VIEWS = WATCHED ? 3 : 12, MORE = 2 };
    lab_mesh lab;
    int passes = 0;
    assert_true(lab_mesh_make(&lab, "sphere", 24, 7));
    const char *path = lab_leaf_make(&lab, 100, false);
    for (int view = 0; view < VIEWS; view++) {
        const leafcast_stats narrow =
            draw_with(path, lab.iso, mesh_tile_kernels[CPU_SSE42], 0, view);
        const uint32_t enough = (uint32_t)narrow.treelets_loaded + MORE;
        passes += (int)draw_with(path, lab.iso, mesh_tile_wide, enough, view).passes;
    }
    lab_mesh_release(&lab);
    assert_int_equal(passes, VIEWS);
}

/* ---- The truth ---- */

/* Some of the pixels; what they found goes into the tally. */
static void judge_picture(const tet_ref *reference, double iso, leafcast *v,
                          const leafcast_camera *c, ref_tally *tally) {
    static picture p;
    leafcast_stats stats = {.size = sizeof stats};
    const leafcast_scene scene = leafcast_scene_default();
    pictures_draw(v, &scene, c, &p, &stats);
    for (int i = 0; i < PICTURE_PIXELS; i += STEP) {
        ref_ray look;
        leafcast_pixel_ray(c, i % PICTURE_WIDTH + 0.5, i / PICTURE_WIDTH + 0.5, look.o, look.d);
        (void)tet_judge_pixel(tally, reference, &look, &iso, 1, NULL, p.z[i]);
    }
}

static void test_against_reference(void **state) {
    (void)state;
    field_random r = {11};
    ref_tally tally = {0};
    for (int i = 0; i < lab_mesh_count(); i++) {
        lab_mesh lab;
        assert_true(lab_mesh_make(&lab, lab_mesh_name(i), CUBES, 3));
        const tet_ref_mesh ours = lab_mesh_reference(&lab);
        tet_ref *reference = tet_ref_create(&ours);
        leafcast *v = fixture_open(lab_leaf_make(&lab, 500, false), NULL);
        const leafcast_surface s = leafcast_surface_default(lab.iso);
        assert_non_null(reference);
        assert_int_equal(leafcast_select(v, &s, 1), LEAFCAST_OK);
        for (int kind = (i + 1) % 2; kind < PICTURE_VIEWS; kind += 2) {
            const uint64_t faults = tally.missed + tally.false_hits + tally.too_far;
            const leafcast_camera c = pictures_view(v, kind, &r);
            judge_picture(reference, lab.iso, v, &c, &tally);
            if (tally.missed + tally.false_hits + tally.too_far > faults)
                print_message("%s, view %d: %llu missed, %llu false, %llu too far in all\n",
                              lab.name, kind, (unsigned long long)tally.missed,
                              (unsigned long long)tally.false_hits,
                              (unsigned long long)tally.too_far);
        }
        leafcast_close(v);
        tet_ref_destroy(reference);
        lab_mesh_release(&lab);
    }
    print_message("%llu rays, %llu surfaces, %llu in the grazing band, worst %.2g edges\n",
                  (unsigned long long)tally.rays, (unsigned long long)tally.hits,
                  (unsigned long long)tally.grazing, tally.worst);
    assert_true(tally.hits > 50000 / STEP);
    assert_int_equal(tally.missed, 0);
    assert_int_equal(tally.false_hits, 0);
    assert_int_equal(tally.too_far, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_mesh),      cmocka_unit_test(test_every_scene),
        cmocka_unit_test(test_many_layers),     cmocka_unit_test(test_treelets),
        cmocka_unit_test(test_hidden_treelets), cmocka_unit_test(test_against_reference),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
