/* test_curvilinear_tile.c - pictures of curvilinear grids: tiles of rays give the bits of single
 * rays, whatever the ISA, the shape, the view, the scene, and the treelets at a time. What these
 * are is asked by test_curvilinear_kind.c.
 */
/* marks: long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "render/ray/open_volume.h"
#include "tests/support/curvilinear_file.h"
#include "tests/support/curvilinear_tile_wide.h"
#include "tests/support/fixture.h"
#include "tests/support/hex_lab.h"
#include "tests/support/pictures.h"
#include "tests/support/scratch.h"

/* Several treelets and many blocks, the last ones in part; bent, twisted, and with holes. */
enum { NODES_I = 38, NODES_J = 11, NODES_K = 36, NODES = NODES_I * NODES_J * NODES_K };

static const char *write_zone(const curvilinear_zone *zone) {
    const leaf_image image = curvilinear_file(zone, 1);
    const char *path = scratch_write("tile.leaf", image.bytes, image.size);
    free(image.bytes);
    return path;
}

static const char *write_large(void) {
    static float p[NODES][3], values[NODES];
    static uint8_t there[NODES];
    field_random r = {FIELD_SEED};
    for (uint32_t n = 0; n < NODES; n++) {
        const double x = n % NODES_I, y = n / NODES_I % NODES_J, z = n / (NODES_I * NODES_J);
        const double turn = 0.03 * z + 0.2 * sin(0.2 * x), shake = 0.3;
        p[n][0] = (float)(x + shake * field_random_unit(&r) + 2.0 * sin(0.15 * z));
        p[n][1] = (float)(y * cos(turn) - 0.2 * z * sin(turn) + shake * field_random_unit(&r));
        p[n][2] = (float)(z * cos(turn) + y * sin(turn) + shake * field_random_unit(&r));
        values[n] =
            (float)(sin(0.5 * x) * cos(0.4 * z) + 0.3 * sin(y) + 0.2 * field_random_unit(&r));
        there[n] = n % 97 != 5;
    }
    const curvilinear_zone zone = {
        {NODES_I, NODES_J, NODES_K}, (const float(*)[3])p, values, there};
    return write_zone(&zone);
}

static const char *write_shape(const hex_lab *s) {
    enum { ALL = HEX_LAB_NODES * HEX_LAB_NODES * HEX_LAB_NODES };
    static float p[ALL][3], values[ALL];
    memcpy(p, s->p, sizeof p);
    memcpy(values, s->value, sizeof values);
    const curvilinear_zone zone = {
        {HEX_LAB_NODES, HEX_LAB_NODES, HEX_LAB_NODES}, (const float(*)[3])p, values, NULL};
    return write_zone(&zone);
}

static picture_volumes open_all(const char *path) {
    picture_volumes v = pictures_open(path, 2);
    pictures_open_one(&v, path, "scalar", 2);
    v.of[v.count - 1]->kernels.tile = curvilinear_tile_wide;
    v.name[v.count - 1] = "wide";
    return v;
}

static void test_every_shape(void **state) {
    (void)state;
    int hits = 0;
    for (int n = 0; n < hex_lab_count(); n++) {
        hex_lab s;
        field_random r = {FIELD_SEED + (uint64_t)n};
        hex_lab_make(&s, n, FIELD_SEED);
        picture_volumes v = open_all(write_shape(&s));
        const leafcast_surface surface = leafcast_surface_default(s.iso);
        const leafcast_scene scene = leafcast_scene_default();
        pictures_select(&v, &surface, 1);
        for (int kind = WATCHED ? n % 4 : 0; kind < PICTURE_VIEWS; kind += WATCHED ? 4 : 1) {
            const leafcast_camera c = pictures_view(v.of[0], kind, &r);
            hits += pictures_alike(&v, &scene, &c, s.name);
        }
        pictures_close(&v);
    }
    print_message("%d pixels with surfaces\n", hits);
    assert_true(hits > (WATCHED ? 2000 : 50000));
}

static void test_every_scene(void **state) {
    enum { SCENES = WATCHED ? 6 : 18 };
    (void)state;
    int hits = 0;
    field_random r = {5};
    picture_volumes v = open_all(write_large());
    const leafcast_info info = leafcast_describe(v.of[0]);
    for (int kind = 0; kind < SCENES; kind++) {
        leafcast_surface s[3];
        for (int k = 0; k < 3; k++) {
            s[k] = leafcast_surface_default(0.3 + 0.1 * k);
            s[k].rgb[k] = 0.1f;
            s[k].opacity = kind % 4 == 3 ? 0.4f : 1.0f;
        }
        pictures_select(&v, s, 1 + kind % 3);
        leafcast_scene scene = pictures_scene(kind, &info);
        scene.lod = LEAFCAST_LOD_EXACT;
        const leafcast_camera c = pictures_view(v.of[0], kind % PICTURE_VIEWS, &r);
        hits += pictures_alike(&v, &scene, &c, "large");
    }
    pictures_close(&v);
    print_message("%d pixels with surfaces\n", hits);
    assert_true(hits > (WATCHED ? 100 : 200) * SCENES);
}

/* More surfaces on a ray than a walk has room for, too. */
static void test_many_layers(void **state) {
    (void)state;
    picture_volumes v = open_all(write_large());
    const int hits = pictures_of_layers(&v, 0.3, 0.04, "layers");
    pictures_close(&v);
    assert_true(hits > (WATCHED ? 500 : 2000));
}

/* However few treelets are there at a time. */
static void test_treelets(void **state) {
    (void)state;
    static picture want, got;
    const char *path = write_large();
    for (uint32_t limit = 0; limit < 3; limit++) {
        for (int isa = 0; isa <= (int)cpu_best(); isa++) {
            const bool first = limit == 0 && isa == 0;
            const leafcast_options o = {.size = sizeof o,
                                        .isa = cpu_isa_name((cpu_isa)isa),
                                        .threads = 2,
                                        .experiments = EXPERIMENTS(.treelet_limit = limit)};
            leafcast *v = fixture_open(path, &o);
            const leafcast_surface s = leafcast_surface_default(0.3);
            const leafcast_scene scene = leafcast_scene_default();
            assert_int_equal(leafcast_select(v, &s, 1), LEAFCAST_OK);
            const leafcast_camera c = leafcast_standard_view(v, 1.1, PICTURE_WIDTH, PICTURE_HEIGHT);
            pictures_draw(v, &scene, &c, first ? &want : &got, NULL);
            leafcast_close(v);
            if (!first)
                assert_memory_equal(&want, &got, sizeof want);
        }
    }
}

/* A cell is walked once for a tile, not once a ray. */
static void test_cells_of_tiles(void **state) {
    (void)state;
    static picture p;
    const char *path = write_large();
    uint64_t cells[2];
    for (int n = 0; n < 2; n++) {
        const leafcast_options o = {.size = sizeof o, .threads = 1, .isa = "scalar"};
        const leafcast_surface s = leafcast_surface_default(0.3);
        const leafcast_scene scene = leafcast_scene_default();
        leafcast_stats stats = {.size = sizeof stats};
        leafcast *v = fixture_open(path, &o);
        if (n == 1)
            v->kernels.tile = curvilinear_tile_wide;
        assert_int_equal(leafcast_select(v, &s, 1), LEAFCAST_OK);
        const leafcast_camera c = leafcast_standard_view(v, 1.1, PICTURE_WIDTH, PICTURE_HEIGHT);
        pictures_draw(v, &scene, &c, &p, &stats);
        cells[n] = stats.cells;
        leafcast_close(v);
    }
    print_message("%llu cells by rays, %llu by tiles\n", (unsigned long long)cells[0],
                  (unsigned long long)cells[1]);
    assert_true(cells[1] > 0 && (WATCHED ? 1 : 2) * cells[1] < cells[0]);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_shape),    cmocka_unit_test(test_every_scene),
        cmocka_unit_test(test_many_layers),    cmocka_unit_test(test_treelets),
        cmocka_unit_test(test_cells_of_tiles),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
