/* test_isopolygon_cache.c - isopolygons that are kept give the bits of those made on the fly: by
 * tiles, packets and single rays, with many threads, new isovalues, more polygons than there is
 * room for, and few treelets at a time; and their memory is within the budget. */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <string.h>

#include "tests/support/fixture.h"
#include "tests/support/lab_leaf.h"
#include "tests/support/pictures.h"

enum { CUBES = 8, ISOS = 4, MODES = 3 };

static lab_mesh lab;
static const char *path;

static int set_up(void **state) {
    (void)state;
    if (!lab_mesh_make(&lab, "noise", CUBES, 7))
        return -1;
    path = lab_leaf_make(&lab, 300, false);
    return 0;
}

static int tear_down(void **state) {
    (void)state;
    lab_mesh_release(&lab);
    return 0;
}

/* One isovalue, several, and the same ones in the other order, which is the same selection. */
enum { ONE, UP, DOWN, CASES };

/* Twice: polygons are made, and then are there. */
static void draw_all(leafcast *v, int which, picture out[2], leafcast_stats *stats) {
    const int isos = which == ONE ? 1 : ISOS;
    leafcast_surface s[ISOS];
    leafcast_scene scene = leafcast_scene_default();
    scene.shadows = true;
    scene.light_count = 1;
    scene.lights[0] = (leafcast_light){.vector = {0.3, -0.5, 0.9}, .rgb = {1.0f, 1.0f, 1.0f}};
    for (int k = 0; k < isos; k++)
        s[k] = leafcast_surface_default(lab.iso + 0.05 * (which == DOWN ? isos - 1 - k : k));
    assert_int_equal(leafcast_select(v, s, isos), LEAFCAST_OK);
    const leafcast_camera c = leafcast_standard_view(v, 1.3, PICTURE_WIDTH, PICTURE_HEIGHT);
    for (int again = 0; again < 2; again++)
        pictures_draw(v, &scene, &c, &out[again], stats);
}

static void compare(leafcast_options o, const picture want[CASES][2]) {
    static picture got[2];
    leafcast_stats stats = {.size = sizeof stats};
    leafcast *v = fixture_open(path, &o);
    for (int round = 0; round < 4; round++) {
        const int which = round % CASES;
        draw_all(v, which, got, &stats);
        for (int again = 0; again < 2; again++)
            assert_memory_equal(&got[again], &want[which][again], sizeof got[0]);
    }
    leafcast_close(v);
}

static void test_same_bits(void **state) {
    (void)state;
    static picture want[CASES][2];
    leafcast_stats stats = {.size = sizeof stats};
    const leafcast_options plain = {
        .size = sizeof(leafcast_options), .isa = "scalar", .threads = 1};
    leafcast *v = fixture_open(path, &plain);
    draw_all(v, ONE, want[ONE], &stats);
    assert_true(stats.roots > 500);
    draw_all(v, UP, want[UP], &stats);
    draw_all(v, DOWN, want[DOWN], &stats);
    leafcast_close(v);
    for (int mode = 0; mode < MODES; mode++) {
        const leafcast_isopolygons how = (leafcast_isopolygons)mode;
        compare((leafcast_options){.size = sizeof(leafcast_options),
                                   .isa = "scalar",
                                   .threads = 3,
                                   .experiments = EXPERIMENTS(.isopolygons = how)},
                want);
        compare((leafcast_options){.size = sizeof(leafcast_options),
                                   .threads = 4,
                                   .experiments = EXPERIMENTS(.isopolygons = how)},
                want);
        compare((leafcast_options){.size = sizeof(leafcast_options),
                                   .threads = 4,
                                   .experiments = EXPERIMENTS(.packets = 8, .isopolygons = how)},
                want);
        compare(
            (leafcast_options){.size = sizeof(leafcast_options),
                               .threads = 2,
                               .experiments = EXPERIMENTS(.treelet_limit = 2, .isopolygons = how)},
            want);
    }
}

/* What is kept counts, and what there is no room for is not there. */
static void test_budget(void **state) {
    (void)state;
    static picture want[2], got[2];
    uint64_t held[MODES];
    leafcast_stats stats = {.size = sizeof stats};
    for (int mode = 0; mode < MODES; mode++) {
        leafcast_options o = {.size = sizeof(leafcast_options),
                              .threads = 1,
                              .experiments =
                                  EXPERIMENTS(.isopolygons = (leafcast_isopolygons)mode)};
        leafcast *v = fixture_open(path, &o);
        draw_all(v, ONE, mode ? got : want, &stats);
        held[mode] = stats.bytes_resident;
        leafcast_close(v);
        if (mode)
            assert_memory_equal(&got[1], &want[1], sizeof got[1]);
        o.memory = 16 << 20;
        v = fixture_open(path, &o);
        draw_all(v, ONE, got, &stats);
        assert_true(stats.bytes_peak <= o.memory);
        assert_memory_equal(&got[1], &want[1], sizeof got[1]);
        leafcast_close(v);
    }
    assert_true(held[1] > held[0] && held[2] == held[1]);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_same_bits),
                                       cmocka_unit_test(test_budget)};
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
