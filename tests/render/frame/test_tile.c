/* test_tile.c - tiles of rays give the bits of single rays: every ISA, any view, scene and field.
 */
/* marks: long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <string.h>

#include "formats/base/cpu.h"
#include "formats/base/fault.h"
#include "render/ray/open_volume.h"
#include "tests/support/fixture.h"
#include "tests/support/grid_tile_wide.h"
#include "tests/support/pictures.h"
#include "tests/support/watched.h"

static void open_wide(picture_volumes *v, const char *path, int threads) {
    pictures_open_one(v, path, "scalar", threads);
    v->of[v->count - 1]->kernels.tile = grid_tile_trace_wide;
    v->name[v->count - 1] = "wide";
}

static void open_alternatives(picture_volumes *v, const char *path, int threads) {
    static const char *const names[] = {"packets-16x16", "packets-8x8", "packets-4x4-by-cell",
                                        "tiles-by-cell"};
    for (size_t i = 0; i < sizeof names / sizeof *names && cpu_best() > CPU_SCALAR; i++)
        pictures_open_one(v, path, names[i], threads);
    open_wide(v, path, threads);
}

/* Kinds of views; rounds of all kinds, fewer where every access is watched. */
#ifdef __SANITIZE_ADDRESS__
enum { ROUNDS = 1, NEXT = 2, SCENES = 6 };
#else
enum { ROUNDS = 2, NEXT = 1, SCENES = 36 };
#endif

static void test_every_field(void **state) {
    (void)state;
    field_random r = {77};
    int hits = 0;
    for (int i = 0; i < field_count(); i++) {
        field f;
        assert_true(field_make(&f, field_name(i), 21, FIELD_SEED));
        const char *path = fixture_leaf(&f, 4, 1, false);
        picture_volumes v = pictures_open(path, 1);
        open_wide(&v, path, 1);
        const leafcast_surface s = leafcast_surface_default(f.iso);
        pictures_select(&v, &s, 1);
        const leafcast_scene scene = leafcast_scene_default();
        for (int kind = i % NEXT; kind < ROUNDS * PICTURE_VIEWS; kind += NEXT) {
            const leafcast_camera c = pictures_view(v.of[0], kind % PICTURE_VIEWS, &r);
            hits += pictures_alike(&v, &scene, &c, f.name);
        }
        pictures_close(&v);
        field_release(&f);
    }
    print_message("%d surfaces\n", hits);
    assert_true(hits > 40000 * ROUNDS / NEXT);
}

/* ---- Scenes ---- */

static void test_every_scene(void **state) {
    (void)state;
    static const char *const names[] = {"waves", "noise-u8", "rectilinear", "mirrored", "missing"};
    field_random r = {5};
    int hits = 0;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        field f;
        assert_true(field_make(&f, names[i], 40, FIELD_SEED));
        const char *path = fixture_leaf(&f, 4, i != 1, false);
        picture_volumes v = pictures_open(path, 2);
        open_alternatives(&v, path, 2);
        const leafcast_info info = leafcast_describe(v.of[0]);
        for (int kind = 0; kind < SCENES; kind++) {
            leafcast_surface s[3];
            for (int k = 0; k < 3; k++) {
                s[k] = leafcast_surface_default(f.iso + 0.1 * k * fabs(f.iso));
                s[k].rgb[k] = 0.1f;
                s[k].opacity = kind % 4 == 3 ? 0.4f : 1.0f;
            }
            pictures_select(&v, s, 1 + kind % 3);
            const leafcast_scene scene = pictures_scene(kind, &info);
            const leafcast_camera c = pictures_view(v.of[0], kind % PICTURE_VIEWS, &r);
            hits += pictures_alike(&v, &scene, &c, f.name);
        }
        pictures_close(&v);
        field_release(&f);
    }
    print_message("%d surfaces\n", hits);
    assert_true(hits > 1000 * SCENES);
}

/* More surfaces on a ray than a walk has room for, too. */
static void test_many_layers(void **state) {
    (void)state;
    static const char *const names[] = {"waves", "rectilinear", "missing"};
    int hits = 0;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        field f;
        assert_true(field_make(&f, names[i], 40, FIELD_SEED));
        const char *path = fixture_leaf(&f, 4, 1, false);
        picture_volumes v = pictures_open(path, 2);
        open_alternatives(&v, path, 2);
        hits += pictures_of_layers(&v, f.iso, 0.03 * fabs(f.iso) + 0.01, f.name);
        pictures_close(&v);
        field_release(&f);
    }
    print_message("%d pixels with surfaces\n", hits);
    assert_true(hits > 10000);
}

/* ---- What it takes ---- */

/* With few treelets allowed at a time, tiles and single rays take turns; with a preview of what is
 * resident, too. */
static void test_few_treelets(void **state) {
    (void)state;
    static picture want, got;
    field f;
    leafcast_stats stats = {.size = sizeof stats};
    assert_true(field_make(&f, "waves", 60, FIELD_SEED));
    const char *path = fixture_leaf(&f, 4, 1, false);
    const leafcast_surface s = leafcast_surface_default(f.iso);
    leafcast_scene scene = leafcast_scene_default();
    for (uint32_t limit = 1; limit < 40; limit += 13) {
        for (int isa = 0; isa <= (int)cpu_best(); isa++) {
            const leafcast_options o = {.size = sizeof(leafcast_options),
                                        .isa = cpu_isa_name((cpu_isa)isa),
                                        .threads = 2,
                                        .experiments = EXPERIMENTS(.treelet_limit = limit)};
            leafcast *v = fixture_open(path, &o);
            assert_int_equal(leafcast_select(v, &s, 1), LEAFCAST_OK);
            const leafcast_camera c = leafcast_standard_view(v, 1.1, PICTURE_WIDTH, PICTURE_HEIGHT);
            pictures_draw(v, &scene, &c, isa == 0 && limit == 1 ? &want : &got, &stats);
            if (isa > 0 || limit > 1)
                assert_memory_equal(&want, &got, sizeof want);
            leafcast_close(v);
        }
    }
    field_release(&f);
}

/* Where reads are slow, every tile waits, several times: for what lies behind, and for what lights
 * it. Single rays tell what is there. */
static void test_slow_reads(void **state) {
    (void)state;
    enum { SLOW_US = 300 };
    field f;
    field_random r = {9};
    int hits = 0;
    assert_true(field_make(&f, "waves", 40, FIELD_SEED));
    const char *path = fixture_leaf(&f, 4, 1, true);
    leafcast_surface s[2] = {leafcast_surface_default(f.iso),
                             leafcast_surface_default(1.1 * f.iso)};
    fault_delay(FAULT_READ, SLOW_US);
    for (int kind = 0; kind < SCENES / 3; kind++) {
        picture_volumes v = {.count = 0};
        pictures_open_one(&v, path, "scalar", 1);
        for (int isa = 1; isa <= (int)cpu_best(); isa++)
            pictures_open_one(&v, path, cpu_isa_name((cpu_isa)isa), 1);
        open_wide(&v, path, 1);
        const leafcast_info info = leafcast_describe(v.of[0]);
        s[0].opacity = s[1].opacity = kind % 4 == 3 ? 0.4f : 1.0f;
        pictures_select(&v, s, 2);
        const leafcast_scene scene = pictures_scene(kind, &info);
        const leafcast_camera c = pictures_view(v.of[0], kind % PICTURE_VIEWS, &r);
        hits += pictures_alike(&v, &scene, &c, f.name);
        pictures_close(&v);
    }
    fault_delay(FAULT_READ, 0);
    field_release(&f);
    print_message("%d surfaces\n", hits);
    assert_true(hits > 50 * SCENES);
}

/* A tile that waits goes on where it was: a picture of which nothing is there yet takes hardly more
 * steps than one of which all is. */
static void test_steps_again(void **state) {
    (void)state;
    enum { SLOW_US = 300 };
    static picture p;
    field f;
    assert_true(field_make(&f, "waves", 140, FIELD_SEED));
    const char *path = fixture_leaf(&f, 4, 1, false);
    const leafcast_surface s = leafcast_surface_default(f.iso);
    const leafcast_scene scene = leafcast_scene_default();
    for (int isa = 1; isa <= (int)cpu_best(); isa++) {
        leafcast_stats cold = {.size = sizeof(leafcast_stats)}, warm = cold;
        picture_volumes v = {.count = 0};
        pictures_open_one(&v, path, cpu_isa_name((cpu_isa)isa), 2);
        pictures_select(&v, &s, 1);
        const leafcast_camera c =
            leafcast_standard_view(v.of[0], 1.6, PICTURE_WIDTH, PICTURE_HEIGHT);
        fault_delay(FAULT_READ, SLOW_US);
        pictures_draw(v.of[0], &scene, &c, &p, &cold);
        fault_delay(FAULT_READ, 0);
        pictures_draw(v.of[0], &scene, &c, &p, &warm);
        assert_true(cold.treelets_loaded > 300);
        const double more = (double)cold.nodes / (double)warm.nodes;
        print_message("%s: %.2f of the steps\n", v.name[0], more);
        assert_true(more < 1.55); /* 1.3; where tiles begin anew, 1.8 */
        pictures_close(&v);
    }
    field_release(&f);
}

/* The same treelets count as visible. A tile takes fewer steps than its rays one by one, and finds
 * the same surfaces. */
static void assert_counts(const char *name) {
    static picture p;
    field f;
    assert_true(field_make(&f, name, 60, FIELD_SEED));
    picture_volumes v = pictures_open(fixture_leaf(&f, 4, 1, false), 2);
    const leafcast_surface s = leafcast_surface_default(f.iso);
    const leafcast_scene scene = leafcast_scene_default();
    pictures_select(&v, &s, 1);
    for (double distance = 0.6; distance < 3.0; distance += 0.8) {
        const leafcast_camera c =
            leafcast_standard_view(v.of[0], distance, PICTURE_WIDTH, PICTURE_HEIGHT);
        leafcast_stats single = {.size = sizeof(leafcast_stats)},
                       tiled = {.size = sizeof(leafcast_stats)};
        pictures_draw(v.of[CPU_SCALAR], &scene, &c, &p, &single);
        for (int isa = 1; isa < v.count; isa++) {
            for (int again = 0; again < 2; again++)
                pictures_draw(v.of[isa], &scene, &c, &p, &tiled);
            assert_int_equal(tiled.bytes_visible, single.bytes_visible);
            assert_true(WATCHED || tiled.nodes < single.nodes); /* small pictures have few rays */
            assert_true(tiled.roots >= single.roots / 2);
            assert_string_equal(tiled.isa, v.name[isa]);
        }
    }
    pictures_close(&v);
    field_release(&f);
}

/* Terraces and plateaus: surfaces where rays leave cells. */
static void test_counts(void **state) {
    (void)state;
    assert_counts("waves");
    assert_counts("terraces");
    assert_counts("plateau");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_field), cmocka_unit_test(test_every_scene),
        cmocka_unit_test(test_many_layers), cmocka_unit_test(test_few_treelets),
        cmocka_unit_test(test_slow_reads),  cmocka_unit_test(test_steps_again),
        cmocka_unit_test(test_counts)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
