/* test_mixed_tile.c - pictures of mixed meshes: tiles of rays give the bits of single rays,
 * whatever the ISA, the shape, the view, the scene. What these are is asked by test_mixed_kind.c.
 */
/* marks: long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "render/ray/open_volume.h"
#include "tests/support/mixed_file.h"
#include "tests/support/mixed_tile_wide.h"
#include "tests/support/pictures.h"
#include "tests/support/quadratic_file.h"
#include "tests/support/scratch.h"

static cell_mix mix;

/* Cells of a mesh's file, by all ISAs, and by vectors as wide as AVX-512's. */
static picture_volumes open_mesh(const char *mesh, uint32_t cells) {
    mesh_result result;
    mixed_file_convert(mesh, scratch_path("tile.leaf"), cells, UINT64_C(1) << 32, &result);
    picture_volumes v = pictures_open(scratch_path("tile.leaf"), 2);
    pictures_open_one(&v, scratch_path("tile.leaf"), "scalar", 2);
    v.of[v.count - 1]->kernels.tile = mixed_tile_wide;
    v.name[v.count - 1] = "wide";
    return v;
}

static picture_volumes open_all(int lab, uint32_t cells) {
    cell_mix_make(&mix, lab, FIELD_SEED);
    (void)mixed_file_write(mix.cell, mix.count, scratch_path("tile.vtk"));
    return open_mesh(scratch_path("tile.vtk"), cells);
}

static void test_every_shape(void **state) {
    (void)state;
    int hits = 0;
    for (int n = 0; n < hex_lab_count(); n++) {
        field_random r = {FIELD_SEED + (uint64_t)n};
        picture_volumes v = open_all(n, n % 2 ? 100 : 2000);
        const leafcast_surface surface = leafcast_surface_default(mix.lab.iso);
        const leafcast_scene scene = leafcast_scene_default();
        pictures_select(&v, &surface, 1);
        for (int kind = n % PICTURE_VIEWS; kind < PICTURE_VIEWS; kind += 8) {
            const leafcast_camera c = pictures_view(v.of[0], kind, &r);
            hits += pictures_alike(&v, &scene, &c, mix.lab.name);
        }
        pictures_close(&v);
    }
    print_message("%d pixels with surfaces\n", hits);
    assert_true(hits > (WATCHED ? 500 : 5000));
}

static void test_quadratic_tets(void **state) {
    static quadratic_lab lab;
    (void)state;
    int hits = 0;
    for (int n = 0; n < quadratic_lab_count(); n++) {
        field_random r = {FIELD_SEED + (uint64_t)n};
        quadratic_lab_make(&lab, n, FIELD_SEED);
        quadratic_file_write(&lab, n % 3, scratch_path("tile.mesh"));
        picture_volumes v = open_mesh(scratch_path("tile.mesh"), n % 2 ? 40 : 2000);
        const leafcast_surface surface = leafcast_surface_default(lab.iso);
        const leafcast_scene scene = leafcast_scene_default();
        pictures_select(&v, &surface, 1);
        for (int kind = n % PICTURE_VIEWS; kind < PICTURE_VIEWS; kind += 8) {
            const leafcast_camera c = pictures_view(v.of[0], kind, &r);
            hits += pictures_alike(&v, &scene, &c, lab.name);
        }
        pictures_close(&v);
    }
    print_message("%d pixels with surfaces\n", hits);
    assert_true(hits > (WATCHED ? 500 : 5000));
}

static void test_every_scene(void **state) {
    enum { SCENES = WATCHED ? 4 : 8 };
    (void)state;
    int hits = 0;
    field_random r = {5};
    picture_volumes v = open_all(1, 200);
    const leafcast_info info = leafcast_describe(v.of[0]);
    for (int kind = 0; kind < SCENES; kind++) {
        leafcast_surface s[3];
        for (int k = 0; k < 3; k++) {
            s[k] = leafcast_surface_default(0.1 + 0.1 * k);
            s[k].rgb[k] = 0.1f;
            s[k].opacity = kind % 4 == 3 ? 0.4f : 1.0f;
        }
        pictures_select(&v, s, 1 + kind % 3);
        leafcast_scene scene = pictures_scene(kind, &info);
        scene.lod = LEAFCAST_LOD_EXACT;
        const leafcast_camera c = pictures_view(v.of[0], kind % PICTURE_VIEWS, &r);
        hits += pictures_alike(&v, &scene, &c, "scenes");
    }
    pictures_close(&v);
    print_message("%d pixels with surfaces\n", hits);
    assert_true(hits > (WATCHED ? 50 : 200) * SCENES);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_shape),
        cmocka_unit_test(test_quadratic_tets),
        cmocka_unit_test(test_every_scene),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
