/* test_cells.c - cells by their numbers: their corners and values against the field, and the way
 * back from points in them.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <string.h>

#include "tests/support/fixture.h"
#include "tests/support/mesh_cases.h"
#include "tests/support/scratch.h"

enum { CELLS_LOG2 = 4 };

static leafcast_cell cell_of(leafcast *v, uint32_t level, uint64_t number) {
    leafcast_cell c = {.size = sizeof c};
    assert_int_equal(leafcast_get_cell(v, level, number, &c), LEAFCAST_OK);
    assert_int_equal(c.cell, number);
    assert_int_equal(c.level, level);
    return c;
}

/* The point in the middle of a cell is in the cell, and has the mean of the corners' values: of a
 * trilinear form as of a linear one. */
static void check_middle(leafcast *v, const leafcast_cell *c) {
    double middle[3] = {0, 0, 0}, mean = 0;
    leafcast_sample s;
    for (int i = 0; i < c->corners; i++) {
        mean += (double)c->value[i] / c->corners;
        for (int a = 0; a < 3; a++)
            middle[a] += c->position[i][a] / c->corners;
    }
    assert_int_equal(leafcast_probe_point(v, middle, &s), LEAFCAST_OK);
    assert_true(s.inside);
    assert_int_equal(s.cell, c->cell);
    assert_true(fabs(s.value - mean) <= 1e-5 * (1 + fabs(mean)));
}

/* At a corner the nearest value is the corner's. */
static void check_corners(leafcast *v, const leafcast_cell *c) {
    for (int i = 0; i < c->corners; i++) {
        leafcast_sample s;
        assert_int_equal(leafcast_probe_point(v, c->position[i], &s), LEAFCAST_OK);
        assert_true(s.inside && s.nearest == (double)c->value[i]);
    }
}

static void check_refused(leafcast *v) {
    const leafcast_info info = leafcast_describe(v);
    leafcast_cell c = {.size = sizeof c};
    uint32_t index[3] = {7, 7, 7};
    assert_int_equal(leafcast_get_cell(v, 0, info.cells, &c), LEAFCAST_USAGE);
    assert_int_equal(leafcast_get_cell(v, info.levels, 0, &c), LEAFCAST_USAGE);
    c.size = 1;
    assert_int_equal(leafcast_get_cell(v, 0, 0, &c), LEAFCAST_USAGE);
    assert_int_equal(leafcast_cell_indices(v, 0, info.cells, index), 0);
    assert_int_equal(leafcast_cell_indices(v, info.levels, 0, index), 0);
    assert_int_equal(leafcast_cell_indices(NULL, 0, 0, index), 0);
    assert_int_equal(index[0], 7);
}

static void check_grid_cell(leafcast *v, const field *f, uint64_t number) {
    const leafcast_cell c = cell_of(v, 0, number);
    const long *n = f->dims;
    assert_int_equal(c.indices, 3);
    assert_int_equal(c.corners, 8);
    assert_int_equal(c.index[0] +
                         (uint64_t)(n[0] - 1) * (c.index[1] + (uint64_t)(n[1] - 1) * c.index[2]),
                     number);
    for (int i = 0; i < 8; i++) {
        const long at[3] = {c.index[0] + (i & 1), c.index[1] + (i >> 1 & 1), c.index[2] + (i >> 2)};
        assert_true(c.value[i] == f->samples[at[0] + n[0] * (at[1] + n[1] * at[2])]);
        for (int a = 0; a < 3; a++)
            assert_true(fabs(c.position[i][a] - (f->origin[a] + f->spacing[a] * (double)at[a])) <=
                        1e-9);
    }
    check_middle(v, &c);
    check_corners(v, &c);
}

static void test_grid(void **state) {
    (void)state;
    field f;
    assert_true(field_make(&f, "noise-u8", 37, FIELD_SEED));
    leafcast *v = fixture_open(fixture_leaf(&f, CELLS_LOG2, 1, false), NULL);
    const leafcast_info info = leafcast_describe(v);
    assert_string_equal(info.cell, "cell");
    assert_int_equal(info.nodes, f.dims[0] * f.dims[1] * f.dims[2]);
    assert_int_equal(info.cells, (f.dims[0] - 1) * (f.dims[1] - 1) * (f.dims[2] - 1));
    assert_true(info.abilities & LEAFCAST_ABILITY_LAYERS);
    for (uint64_t number = 0; number < info.cells; number += 997)
        check_grid_cell(v, &f, number);
    check_grid_cell(v, &f, info.cells - 1);
    check_refused(v);
    const leafcast_cell coarse = cell_of(v, 1, 1), fine = cell_of(v, 0, 2);
    assert_memory_equal(coarse.position[0], fine.position[0], sizeof fine.position[0]);
    leafcast_close(v);
    field_release(&f);
}

/* Kuhn's tets fill cubes of edge 1 or less, with an index of a tet below 6 in each. */
static void test_mesh(void **state) {
    (void)state;
    mem m;
    mesh_case c = mesh_cases_kuhn(5, 4, 3);
    mesh_result r;
    mem_init(&m, 0);
    c.options.treelet_tets = 50;
    assert_int_equal(mesh_cases_convert(&m, &c, "cells.leaf", 0, &r), ST_OK);
    leafcast *v = fixture_open(scratch_path("cells.leaf"), NULL);
    const leafcast_info info = leafcast_describe(v);
    assert_string_equal(info.cell, "tet");
    assert_int_equal(info.cells, c.tet_count);
    assert_int_equal(info.nodes, c.point_count);
    assert_int_equal(info.dims[0], 0);
    for (uint64_t number = 0; number < info.cells; number++) {
        const leafcast_cell one = cell_of(v, 0, number);
        assert_int_equal(one.corners, 4);
        assert_int_equal(one.indices, 0);
        check_middle(v, &one);
        check_corners(v, &one);
    }
    check_refused(v);
    leafcast_close(v);
    mesh_cases_free(&c);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_grid), cmocka_unit_test(test_mesh)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
