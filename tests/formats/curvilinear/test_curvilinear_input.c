/* test_curvilinear_input.c - curvilinear grids through the front door: names and components of
 * fields, what is told of a grid, what a pipe or a packed file gets.
 */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "formats/base/fault.h"
#include "formats/curvilinear/curvilinear_input.h"
#include "formats/curvilinear/curvilinear_input_facts.h"
#include "formats/curvilinear/curvilinear_input_kind.h"
#include "formats/curvilinear/plot3d_flow.h"
#include "formats/input_facts.h"
#include "formats/input_open.h"
#include "tests/support/plot3d_files.h"
#include "tests/support/scratch.h"

static const plot3d_form plain = {.zones = 1, .nodes = {{3, 4, 5}}};
enum { NODES = 60 };

/* ---- fields ---- */

static void test_names(void **state) {
    (void)state;
    mem m;
    mem_init(&m, 0);
    curvilinear_input *x;
    uint32_t components;
    const char *path = plot3d_write(&plain, PLOT3D_PART_GRID, "grid.bin");
    const curvilinear_hints hints = {
        .solutions = plot3d_one(plot3d_write(&plain, PLOT3D_PART_SOLUTION, "q.bin")),
        .functions = plot3d_one(plot3d_write(&plain, PLOT3D_PART_FUNCTIONS, "f.bin")),
        .name = "a\tfin"};
    assert_int_equal(curvilinear_input_open(&m, path, &hints, &x), ST_OK);
    assert_string_equal(curvilinear_input_format(x), "PLOT3D");
    assert_string_equal(curvilinear_input_name(x), "a\xef\xbf\xbd"
                                                   "fin");
    assert_string_equal(curvilinear_input_file(x), path);
    assert_int_equal(curvilinear_input_fields(x), PLOT3D_FLOWS + 2);
    assert_string_equal(curvilinear_input_field(x, 0, &components), "density");
    assert_int_equal(components, 1);
    assert_string_equal(curvilinear_input_field(x, 1, &components), "momentum");
    assert_int_equal(components, 3);
    assert_string_equal(curvilinear_input_field(x, PLOT3D_FLOWS + 1, &components), "function_2");
    assert_string_equal(curvilinear_input_taken(x, 0, &components), "density");
    static const char *const names[] = {"velocity_z", "function_1", "velocity"};
    assert_int_equal(curvilinear_input_take(x, names, 3), ST_OK);
    assert_string_equal(curvilinear_input_taken(x, 0, &components), "velocity");
    assert_int_equal(components, 3);
    float v[3][NODES];
    const curvilinear_source *s = curvilinear_input_source(x);
    for (uint32_t i = 0; i < 3; i++)
        assert_int_equal(s->values(s->own, 0, i, 0, 5, v[i]), ST_OK);
    for (uint32_t n = 0; n < NODES; n++) {
        double q[5];
        for (uint32_t i = 0; i < 5; i++)
            q[i] = plot3d_number(&plain, 0, n, 3 + i);
        assert_true(v[0][n] == (float)(q[3] / q[0]));
        assert_true(v[1][n] == (float)plot3d_number(&plain, 0, n, 8));
        const double w = sqrt(q[1] * q[1] + q[2] * q[2] + q[3] * q[3]) / q[0];
        assert_true(fabs((double)v[2][n] - w) < 1e-6 * w);
    }
    static const char *const bad[] = {"Density",     "density_x",  "velocity_", "velocity_w",
                                      "velocity_xy", "function_3", ""};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assert_int_equal(curvilinear_input_take(x, &bad[i], 1), ST_USAGE);
        assert_non_null(strstr(status_text(), "it has \"density\", \"momentum\""));
    }
    assert_int_equal(curvilinear_input_source(x)->fields, 3);
    curvilinear_input_close(x);
    assert_int_equal(mem_used(&m), 0);
}

static void test_components(void **state) {
    (void)state;
    mem m;
    mem_init(&m, 0);
    curvilinear_input *x = NULL;
    const char *path = plot3d_write(&plain, PLOT3D_PART_GRID, "grid.bin");
    curvilinear_hints hints = {.solutions =
                                   plot3d_one(plot3d_write(&plain, PLOT3D_PART_SOLUTION, "q.bin")),
                               .field = "momentum"};
    for (int c = -1; c <= 4; c++) {
        hints.component = c;
        const status st = curvilinear_input_open(&m, path, &hints, &x);
        assert_int_equal(st, c < 0 || c > 3 ? ST_USAGE : ST_OK);
        if (st != ST_OK)
            continue;
        float v[NODES];
        const curvilinear_source *s = curvilinear_input_source(x);
        assert_int_equal(s->values(s->own, 0, 0, 0, 5, v), ST_OK);
        double sum = 0;
        for (uint32_t i = 0; i < 3; i++)
            sum += pow(plot3d_number(&plain, 0, 7, 4 + i), 2);
        const double want = c ? plot3d_number(&plain, 0, 7, 3 + (uint32_t)c) : sqrt(sum);
        assert_true(v[7] == (float)want);
        curvilinear_input_close(x);
    }
    hints = (curvilinear_hints){0};
    assert_int_equal(curvilinear_input_open(&m, path, &hints, &x), ST_OK);
    float v[NODES] = {1};
    const curvilinear_source *s = curvilinear_input_source(x);
    assert_int_equal(curvilinear_input_fields(x), 0);
    assert_null(curvilinear_input_conditions(x));
    assert_int_equal(s->fields, 1);
    assert_int_equal(s->values(s->own, 0, 0, 0, 5, v), ST_OK);
    assert_true(v[0] == 0);
    curvilinear_input_close(x);
    hints.field = "density";
    assert_int_equal(curvilinear_input_open(&m, path, &hints, &x), ST_USAGE);
    assert_non_null(strstr(status_text(), "it has none"));
}

/* ---- the front door ---- */

static void test_kind(void **state) {
    (void)state;
    mem m;
    mem_init(&m, 0);
    input in;
    const char *path = plot3d_write(&plain, PLOT3D_PART_GRID, "grid.bin");
    assert_int_equal(input_open(&m, path, NULL, &in), ST_OK);
    assert_ptr_equal(in.kind, &curvilinear_input_kind);
    assert_string_equal(in.kind->format(in.own), "PLOT3D");
    assert_int_equal(in.kind->traits(in.own),
                     INPUT_ONE_LEVEL | INPUT_CHOICES | INPUT_STEPS | INPUT_SERIES);
    input_close(&in);
    /* Any file, if the layout is told; then it must be one. */
    path = scratch_text("a.nrrd", "NRRD0004\n");
    const input_hints hints = {.curvilinear.layout = "big"};
    assert_int_equal(input_open(&m, path, &hints, &in), ST_CORRUPT);
    assert_non_null(strstr(status_text(), "fit no layout"));
    assert_int_equal(mem_used(&m), 0);
}

/* A pipe is no curvilinear grid; if the layout says so, it is refused. */
static void test_pipe(void **state) {
    (void)state;
    size_t size;
    const uint8_t *bytes = plot3d_bytes(&plain, PLOT3D_PART_GRID, &size);
    for (int told = 0; told < 2; told++) {
        int ends[2], kept = dup(STDIN_FILENO);
        assert_int_equal(pipe(ends), 0);
        assert_int_equal(write(ends[1], bytes, size), size);
        close(ends[1]);
        dup2(ends[0], STDIN_FILENO);
        mem m;
        mem_init(&m, 0);
        input in;
        const input_hints hints = {.curvilinear.layout = told ? "big" : NULL};
        assert_int_equal(input_open(&m, "-", &hints, &in), ST_UNSUPPORTED);
        assert_true(!told || strstr(status_text(), "must be a regular file"));
        assert_int_equal(mem_used(&m), 0);
        dup2(kept, STDIN_FILENO);
        close(kept);
        close(ends[0]);
    }
}

/* ---- what is told ---- */

static status ask(const input_question *q, input_facts *x) {
    mem m;
    mem_init(&m, 0);
    const status st = input_facts_read(&m, q, NULL, x);
    assert_int_equal(mem_used(&m), 0);
    return st;
}

/* Counted here, cell by cell. */
static uint64_t cells_of(const plot3d_form *f, uint32_t z) {
    const uint32_t *n = f->nodes[z];
    uint64_t count = 0;
    for (uint32_t k = 0; k + 1 < n[2]; k++)
        for (uint32_t j = 0; j + 1 < n[1]; j++)
            for (uint32_t i = 0; i + 1 < n[0]; i++) {
                bool all = true;
                for (uint32_t c = 0; c < 8; c++) {
                    const uint64_t node =
                        i + (c & 1) + n[0] * (j + (c >> 1 & 1) + (uint64_t)n[1] * (k + (c >> 2)));
                    all = all && (!f->blanks || plot3d_blank(z, node) != 0);
                }
                count += all;
            }
    return count;
}

static void test_facts(void **state) {
    (void)state;
    static input_facts x;
    for (unsigned bits = 0; bits < 32; bits += 8) {
        const plot3d_form f = plot3d_form_of(bits);
        const input_question q = {.path = plot3d_write(&f, PLOT3D_PART_GRID, "grid.bin"),
                                  .hints.curvilinear = {.functions = plot3d_one(plot3d_write(
                                                            &f, PLOT3D_PART_FUNCTIONS, "f.bin"))}};
        assert_int_equal(ask(&q, &x), ST_OK);
        const curvilinear_input_facts *own = curvilinear_input_facts_of(&x);
        uint64_t cells = 0, blanked = 0, nodes = 0;
        double range[2] = {INFINITY, -INFINITY};
        for (uint32_t z = 0; z < f.zones; z++) {
            const uint64_t count = (uint64_t)f.nodes[z][0] * f.nodes[z][1] * f.nodes[z][2];
            cells += cells_of(&f, z);
            nodes += count;
            for (uint64_t n = 0; n < count; n++) {
                const bool none = f.blanks && plot3d_blank(z, n) == 0;
                blanked += none;
                if (!none) {
                    range[0] = fmin(range[0], plot3d_number(&f, z, n, 0));
                    range[1] = fmax(range[1], plot3d_number(&f, z, n, 0));
                }
            }
        }
        assert_int_equal(own->zones, f.zones);
        assert_int_equal(own->total, nodes);
        assert_int_equal(own->cells, cells);
        assert_int_equal(own->blanked, blanked);
        assert_int_equal(x.values.drawn, nodes - blanked);
        assert_int_equal(x.values.cells, cells);
        assert_true(own->bounds[0] == (float)range[0] && own->bounds[3] == (float)range[1]);
        assert_string_equal(x.field, "function_1");
        assert_int_equal(x.field_count, 2);
        assert_false(own->flows || x.lacks_values);
    }
}

/* A linear field on a sheared box: slope and area are known. */
static void test_slopes(void **state) {
    (void)state;
    static input_facts x;
    const plot3d_form f = {.zones = 1, .nodes = {{3, 4, 5}}, .little = true};
    size_t size;
    uint8_t *bytes = plot3d_bytes(&f, PLOT3D_PART_GRID, &size);
    for (uint32_t n = 0; n < NODES; n++) {
        const uint32_t i = n % 3, j = n / 3 % 4, k = n / 12;
        const float p[3] = {2.0f * (float)i + (float)j, (float)j, 3.0f * (float)k};
        for (int a = 0; a < 3; a++)
            memcpy(bytes + 12 + 4 * (n + NODES * (uint32_t)a), &p[a], 4);
    }
    const char *path = scratch_write("grid.bin", bytes, size);
    bytes = plot3d_bytes(&f, PLOT3D_PART_FUNCTIONS, &size);
    for (uint32_t n = 0; n < NODES; n++) {
        const float value = 4 * (3.0f * (float)(n / 12)); /* 4 z */
        memcpy(bytes + 16 + 4 * n, &value, 4);
    }
    const input_question q = {
        .path = path,
        .hints.curvilinear = {.functions = plot3d_one(scratch_write("f.bin", bytes, size))}};
    assert_int_equal(ask(&q, &x), ST_OK);
    bool any = false;
    for (uint32_t b = 0; b < x.values.bins; b++)
        if (x.values.active[b] > 0) {
            any = true;
            assert_true(x.values.active[b] == 6 && x.values.gradient[b] == 4);
            /* 2 x 3 cells of an area of 2, of 60 nodes that were all drawn. */
            assert_true(fabs((double)x.values.area[b] - 12) < 1e-5);
        }
    assert_true(any);
}

static void test_quick(void **state) {
    (void)state;
    static input_facts x;
    const plot3d_form f = plot3d_form_of(16);
    const input_question q = {.path = plot3d_write(&f, PLOT3D_PART_GRID, "grid.bin"),
                              .header_only = true,
                              .hints.curvilinear = {.solutions = plot3d_one(plot3d_write(
                                                        &f, PLOT3D_PART_SOLUTION, "q.bin")),
                                                    .field = "momentum_y"}};
    assert_int_equal(ask(&q, &x), ST_OK);
    const curvilinear_input_facts *own = curvilinear_input_facts_of(&x);
    assert_true(own->flows && own->flow[0] == 2.5 && own->flow[3] == 5.5);
    assert_int_equal(own->total, 72);
    assert_int_equal(own->nodes[1][1], 3);
    assert_string_equal(x.field, "momentum");
    assert_int_equal(x.components, 3);
    assert_int_equal(x.component, 2);
    assert_string_equal(x.name, "grid");
}

static void test_faults(void **state) {
    (void)state;
    static input_facts x;
    const plot3d_form f = plot3d_form_of(8);
    const input_question q = {.path = plot3d_write(&f, PLOT3D_PART_GRID, "grid.bin")};
    static const fault_kind kinds[] = {FAULT_ALLOC, FAULT_READ};
    for (int i = 0; i < 2; i++) {
        long k = 1;
        for (bool fired = true; fired; k++) {
            fault_arm(kinds[i], k);
            const status st = ask(&q, &x);
            fired = fault_fired(kinds[i]);
            fault_arm(kinds[i], 0);
            assert_true(fired ? st != ST_OK : st == ST_OK);
        }
        assert_true(k > 10);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_names), cmocka_unit_test(test_components),
        cmocka_unit_test(test_kind),  cmocka_unit_test(test_pipe),
        cmocka_unit_test(test_facts), cmocka_unit_test(test_slopes),
        cmocka_unit_test(test_quick), cmocka_unit_test(test_faults),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
