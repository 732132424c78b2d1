/* test_map_treelets.c - the map of treelets, against their places told by whole numbers.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdlib.h>
#include <string.h>

#include "formats/leaf/leaf_file.h"
#include "prep/mesh/mesh_series.h"
#include "tests/support/fixture.h"
#include "tests/support/mesh_cases.h"
#include "tests/support/scratch.h"

enum { CELLS_LOG2 = 4, SIDE = 32 };

static const uint32_t DIMS[3] = {70, 55, 40};

static uint32_t least(uint32_t a, uint32_t b) {
    return a < b ? a : b;
}

/* Cells of level 0 that treelets of a level are wide. */
static uint32_t width_of(uint32_t level) {
    return 1u << (CELLS_LOG2 + level);
}

/* How many treelets of a level have some inside in common with block i of so many along an axis. */
static uint32_t expected_along(int axis, uint32_t level, uint32_t blocks, uint32_t i) {
    const uint32_t cells = DIMS[axis] - 1, width = width_of(level);
    uint32_t n = 0;
    for (uint32_t begin = 0; begin < cells; begin += width) {
        const uint32_t end = least(begin + width, cells);
        n += begin * blocks < (i + 1) * cells && end * blocks > i * cells;
    }
    return n;
}

static void check_places(leafcast *v, uint32_t level, const uint32_t blocks[3]) {
    leafcast_block *map = calloc((size_t)blocks[0] * blocks[1] * blocks[2], sizeof *map);
    const leafcast_block *b = map;
    assert_non_null(map);
    assert_int_equal(leafcast_map_treelets(v, level, blocks, map), LEAFCAST_OK);
    for (uint32_t z = 0; z < blocks[2]; z++)
        for (uint32_t y = 0; y < blocks[1]; y++)
            for (uint32_t x = 0; x < blocks[0]; x++, b++) {
                assert_int_equal(b->treelets, expected_along(0, level, blocks[0], x) *
                                                  expected_along(1, level, blocks[1], y) *
                                                  expected_along(2, level, blocks[2], z));
                assert_true(b->wanted <= b->treelets);
                assert_true(b->resident <= b->wanted && b->seen <= b->resident);
            }
    free(map);
}

/* Of all treelets of level 0. */
static leafcast_block sums(leafcast *v) {
    const uint32_t one[3] = {1, 1, 1};
    leafcast_block map;
    assert_int_equal(leafcast_map_treelets(v, 0, one, &map), LEAFCAST_OK);
    return map;
}

static void draw(leafcast *v, double isovalue, double fov) {
    static float rgb[3][SIDE * SIDE];
    const leafcast_surface surface = leafcast_surface_default(isovalue);
    leafcast_scene scene = {.size = sizeof scene};
    leafcast_camera c = {.size = sizeof c};
    leafcast_image image = {.size = sizeof image, .r = rgb[0], .g = rgb[1], .b = rgb[2]};
    assert_int_equal(leafcast_init_scene(&scene), LEAFCAST_OK);
    assert_int_equal(leafcast_select(v, &surface, 1), LEAFCAST_OK);
    assert_int_equal(leafcast_get_standard_view(v, 1.0, SIDE, SIDE, &c), LEAFCAST_OK);
    c.fov = fov;
    assert_int_equal(leafcast_trace(v, &scene, &c, &image, NULL, NULL, NULL), LEAFCAST_OK);
}

static void test_grid(void **state) {
    (void)state;
    field f;
    assert_true(field_make(&f, "noise-u8", 70, FIELD_SEED));
    for (int a = 0; a < 3; a++)
        f.dims[a] = DIMS[a];
    leafcast *v = fixture_open(fixture_leaf(&f, CELLS_LOG2, 1, false), NULL);
    const leafcast_info info = leafcast_describe(v);
    const uint32_t own[3] = {5, 4, 3}, some[3] = {7, 1, 16}, most[3] = {64, 3, 2};
    assert_int_equal(sums(v).treelets, 5 * 4 * 3);
    assert_int_equal(sums(v).wanted, 0); /* nothing is asked for */
    draw(v, 120.0, 35.0);
    for (uint32_t level = 0; level < info.levels; level++) {
        check_places(v, level, own);
        check_places(v, level, some);
        check_places(v, level, most);
    }
    const leafcast_block seen = sums(v);
    assert_int_equal(seen.wanted, 5 * 4 * 3); /* it is noise */
    assert_true(seen.seen > 0 && seen.seen == seen.resident);
    assert_true(seen.resident < seen.wanted); /* those behind others are not read */
    draw(v, 120.0, 1.0);                      /* the middle alone */
    assert_true(sums(v).seen > 0 && sums(v).seen < seen.seen);
    assert_int_equal(sums(v).resident, seen.resident);
    draw(v, 300.0, 35.0);
    assert_int_equal(sums(v).wanted, 0);
    assert_int_equal(sums(v).resident, 0);
    leafcast_sample sample;
    assert_int_equal(leafcast_probe_point(v, info.bounds[0], &sample), LEAFCAST_OK);
    assert_true(sample.inside);
    assert_int_equal(sums(v).resident, 0); /* it is there, but not for the picture */
    leafcast_close(v);
    field_release(&f);
}

/* Halves of the box along each axis: treelets are where the file's directory has their boxes. */
static void check_halves(leafcast *v, const leaf_file *f, int axis) {
    const double lo = (double)f->header.bounds[axis], hi = (double)f->header.bounds[3 + axis];
    const double middle = 0.5 * (lo + hi), rounding = 1e-6 * (hi - lo);
    uint32_t blocks[3] = {1, 1, 1}, halves[2] = {0};
    leafcast_block map[2];
    blocks[axis] = 2;
    for (uint32_t t = 0; t < f->layout.treelets; t++) {
        halves[0] += (double)f->mesh->bounds[t][axis] < middle - rounding;
        halves[1] += (double)f->mesh->bounds[t][3 + axis] > middle + rounding;
    }
    assert_int_equal(leafcast_map_treelets(v, 0, blocks, map), LEAFCAST_OK);
    assert_int_equal(map[0].treelets, halves[0]);
    assert_int_equal(map[1].treelets, halves[1]);
    assert_true(halves[0] < f->layout.treelets && halves[1] < f->layout.treelets);
}

static void test_mesh(void **state) {
    (void)state;
    mem m;
    mesh_case c = mesh_cases_kuhn(12, 12, 12);
    mesh_result r;
    leaf_file *f = NULL;
    mem_init(&m, 0);
    c.options.treelet_tets = 200;
    for (size_t i = 0; i < c.point_count; i++)
        for (int a = 0; a < 3; a++)
            c.points[i][a] += 5.0f;
    assert_int_equal(mesh_cases_convert(&m, &c, "map.leaf", 0, &r), ST_OK);
    mesh_cases_free(&c);
    assert_int_equal(leaf_file_open(&m, scratch_path("map.leaf"), &f), ST_OK);
    leafcast *v = fixture_open(scratch_path("map.leaf"), NULL);
    for (int a = 0; a < 3; a++)
        check_halves(v, f, a);
    assert_int_equal(sums(v).wanted, 0);
    draw(v, 0.4, 35.0);
    const leafcast_block seen = sums(v);
    assert_int_equal(seen.treelets, f->layout.treelets);
    assert_true(0 < seen.seen && seen.seen <= seen.resident && seen.resident <= seen.wanted);
    assert_true(seen.wanted < seen.treelets);
    leafcast_close(v);
    leaf_file_close(f);
}

static void test_usage(void **state) {
    (void)state;
    field f;
    leafcast_block map[1];
    const uint32_t none[3] = {1, 0, 1}, many[3] = {1, 1, 65}, one[3] = {1, 1, 1};
    assert_true(field_make(&f, "noise-u8", 20, FIELD_SEED));
    leafcast *v = fixture_open(fixture_leaf(&f, CELLS_LOG2, 1, false), NULL);
    assert_int_equal(leafcast_map_treelets(v, 0, none, map), LEAFCAST_USAGE);
    assert_int_equal(leafcast_map_treelets(v, 0, many, map), LEAFCAST_USAGE);
    assert_int_equal(leafcast_map_treelets(v, leafcast_describe(v).levels, one, map),
                     LEAFCAST_USAGE);
    leafcast_close(v);
    field_release(&f);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_grid),
        cmocka_unit_test(test_mesh),
        cmocka_unit_test(test_usage),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
