/* test_input_facts.c - what is said of an input: cut files, empty ones, the k-th allocation and
 * read that fails, a stop.
 */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/fault.h"
#include "formats/grid/volume_facts.h"
#include "formats/input_facts.h"
#include "formats/leaf/histogram_draw.h"
#include "formats/mesh/mesh_input_facts.h"
#include "formats/mesh/mesh_stream.h"
#include "tests/support/scratch.h"

enum { X = 5, Y = 4, Z = 40 };

static const char *make_grid(void) {
    static char bytes[200 + X * Y * Z];
    int size = snprintf(bytes, 200,
                        "NRRD0004\ntype: uint8\ndimension: 3\nsizes: %d %d %d\nencoding: raw\n\n",
                        X, Y, Z);
    for (int i = 0; i < X * Y * Z; i++)
        bytes[size + i] = (char)(i % 251);
    return scratch_write("grid.nrrd", bytes, (size_t)size + X * Y * Z);
}

/* A row of tets that share a face with the next; the value of point i is i. */
static const char *make_mesh(uint64_t points) {
    const char *path = scratch_path("row.mesh");
    const uint64_t tets = points > 3 ? points - 3 : 0;
    mem m;
    mesh_stream_writer *w;
    mesh_stream_header h = {.name = "row", .field = "i", .points = points, .tets = tets};
    mem_init(&m, 0);
    assert_int_equal(mesh_stream_create(&m, path, true, &h, &w), ST_OK);
    for (uint64_t i = 0; i < points; i++) {
        const float t = (float)i;
        const float xyz[1][3] = {{t, t * t, i % 2 ? 1.0f : 0.0f}};
        assert_int_equal(mesh_stream_points(w, 1, xyz), ST_OK);
    }
    for (uint64_t i = 0; i < points; i++)
        assert_int_equal(mesh_stream_values(w, 1, &(float){(float)i}), ST_OK);
    for (uint32_t i = 0; i < tets; i++) {
        const uint32_t ids[1][4] = {{i, i + 1, i + 2, i + 3}};
        assert_int_equal(mesh_stream_tets(w, 1, ids), ST_OK);
    }
    assert_int_equal(mesh_stream_commit(w), ST_OK);
    return path;
}

static status ask(const char *path, size_t limit, const progress *p, input_facts *x) {
    mem m;
    mem_init(&m, limit);
    const input_question q = {.path = path};
    status st = input_facts_read(&m, &q, p, x);
    assert_int_equal(mem_used(&m), 0);
    return st;
}

static void test_grid(void **state) {
    (void)state;
    static input_facts x;
    assert_int_equal(ask(make_grid(), 0, NULL, &x), ST_OK);
    assert_string_equal(x.kind->name, "grid");
    assert_true(x.traits & INPUT_LATTICE && !(x.traits & INPUT_RAW));
    assert_string_equal(x.format, "NRRD");
    assert_int_equal(volume_facts_of(&x)->dims[2], Z);
    assert_true(x.range[0] == 0 && x.range[1] == 250);
    assert_int_equal(x.values.drawn, X * Y * Z);
    assert_int_equal(x.values.cells, (X - 1) * (Y - 1) * (Z - 1));
}

static void test_mesh(void **state) {
    (void)state;
    static input_facts x;
    assert_int_equal(ask(make_mesh(100), 0, NULL, &x), ST_OK);
    assert_string_equal(x.kind->name, "mesh");
    assert_int_equal(mesh_input_facts_of(&x)->report.tets, 97);
    assert_true(x.range[0] == 0 && x.range[1] == 99);
    const float *bounds = mesh_input_facts_of(&x)->bounds;
    assert_true(bounds[3] == 99 && bounds[4] == 99 * 99 && bounds[5] == 1);
    assert_int_equal(x.values.drawn, 97);
    /* more tets than are kept: a share of them, spread over all */
    assert_int_equal(ask(make_mesh(300003), 0, NULL, &x), ST_OK);
    assert_int_equal(x.values.total, 300000);
    uint32_t kept = 300000;
    while (kept > HISTOGRAM_TETS)
        kept /= 2;
    assert_int_equal(x.values.drawn, kept);
    for (int i = 1; i < 255; i++)
        assert_in_range(x.values.samples[i], kept / 256 - 2, kept / 256 + 2);
    assert_int_equal(ask(make_mesh(0), 0, NULL, &x), ST_OK);
    assert_true(x.values.bins == 0 && x.range[0] > x.range[1]);
}

static void sweep(const char *path, fault_kind kind, status expected) {
    static input_facts x;
    for (long k = 1;; k++) {
        fault_arm(kind, k);
        status st = ask(path, 0, NULL, &x);
        bool fired = fault_fired(kind);
        fault_arm(kind, 0);
        if (!fired) {
            assert_int_equal(st, ST_OK);
            assert_true(k > 1);
            return;
        }
        assert_int_equal(st, expected);
    }
}

static void test_faults(void **state) {
    (void)state;
    for (int kind = 0; kind < 2; kind++) {
        const char *path = kind ? make_mesh(50) : make_grid();
        sweep(path, FAULT_ALLOC, ST_NOMEM);
        sweep(path, FAULT_READ, ST_IO);
    }
}

static void test_cut(void **state) {
    (void)state;
    static input_facts x;
    for (int kind = 0; kind < 2; kind++) {
        size_t size;
        char *bytes = scratch_read(kind ? make_mesh(20) : make_grid(), &size);
        for (size_t cut = 0; cut < size; cut += 7) {
            const char *path = scratch_write(kind ? "cut.mesh" : "cut.nrrd", bytes, cut);
            status st = ask(path, 0, NULL, &x);
            assert_true(st == ST_CORRUPT || st == ST_UNSUPPORTED);
        }
        free(bytes);
    }
}

static bool stop(void *ctx) {
    (void)ctx;
    return true;
}

static void test_limits(void **state) {
    (void)state;
    static input_facts x;
    const progress p = {.stop = stop};
    assert_int_equal(ask(make_grid(), 0, &p, &x), ST_STOPPED);
    assert_int_equal(ask(make_grid(), 100 << 10, NULL, &x), ST_OK);
    assert_int_equal(ask(make_grid(), 70 << 10, NULL, &x), ST_NOMEM);
    assert_int_equal(ask(make_mesh(9), 0, &p, &x), ST_STOPPED);
    assert_int_equal(ask(make_mesh(9), 1 << 20, NULL, &x), ST_NOMEM);
}

static void next_is(const char *path, const char *field, const char *expected) {
    static input_facts x;
    char text[200];
    x.path = path;
    const input_question q = {.path = path, .hints.mesh = {.field = field}};
    assert_true(input_facts_next(&x, &q, text, sizeof text));
    assert_string_equal(text, expected);
}

static void test_next(void **state) {
    (void)state;
    next_is("a.nrrd", NULL, "leafcast convert a.nrrd -o a.leaf");
    next_is("/x/a.b.vtu", "v", "leafcast convert /x/a.b.vtu --field v -o a.b.leaf");
    next_is("it's here.nrrd", "a b",
            "leafcast convert 'it'\\''s here.nrrd' --field 'a b' -o 'it'\\''s here.leaf'");
    next_is("$(x).raw", NULL, "leafcast convert '$(x).raw' -o '$(x).leaf'");
    next_is("-", NULL, "leafcast convert - -o F.leaf");
    next_is("d/.x", NULL, "leafcast convert d/.x -o .x.leaf");
    char name[5000], text[8192];
    memset(name, 'n', sizeof name);
    input_facts x = {.path = name};
    const input_question q = {.path = name};
    for (size_t length = 1; length < sizeof name; length += 200) {
        name[length] = 0;
        assert_int_equal(input_facts_next(&x, &q, text, sizeof text), length + 5 < PATH_MAX);
        assert_int_equal(input_facts_next(&x, &q, text, 50), length < 10);
        name[length] = 'n';
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_grid),   cmocka_unit_test(test_mesh),
                                       cmocka_unit_test(test_faults), cmocka_unit_test(test_cut),
                                       cmocka_unit_test(test_limits), cmocka_unit_test(test_next)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
