/* test_mesh_vtk.c - legacy VTK grids: versions, text and bytes, every kind of data; refusals that
 * name the byte; cut and damaged files; faults; averages in rounds; memory that does not grow.
 */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/mesh_files.h"
#include "tests/support/scratch.h"
#include "tests/support/vtk_files.h"

static const struct { int major, minor; } versions[] = {{2, 0}, {3, 0}, {4, 2}, {5, 1}};

enum { VERSIONS = sizeof versions / sizeof *versions };

static const char *file_of(int i) {
    return vtk_files_legacy("a.vtk", versions[i / 2].major, versions[i / 2].minor, i % 2);
}

/* ---- what is read ---- */

static void test_versions(void **state) {
    (void)state;
    for (int i = 0; i < 2 * VERSIONS; i++) {
        const mesh_copy *a = mesh_files_good(file_of(i), NULL);
        vtk_files_check(a, 1, "alpha", 0);
        assert_string_equal(a->name, "");
    }
    assert_true(mesh_files_recognised(scratch_text("a.dat", "# vtk DataFile Version 2.0\n")));
    assert_true(mesh_files_recognised(scratch_text("bare.VTK", "?")));
    assert_false(mesh_files_recognised(scratch_text("b.dat", "# something else\n")));
}

static void test_fields(void **state) {
    (void)state;
    static const struct {
        const char *field;
        int component;
        bool of_cells;
    } cases[] = {{"v", 0, false}, {"v", 2, false}, {"n", 0, false},
                 {"q", 0, true},  {"w", 0, true},  {"w", 1, true}};
    for (int i = 0; i < 2 * VERSIONS; i++)
        for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
            const mesh_hints hints = {.field = cases[k].field,
                                      .component = cases[k].component,
                                      .cells_to_points = cases[k].of_cells};
            const mesh_copy *a = mesh_files_good(file_of(i), &hints);
            vtk_files_check(a, 1, cases[k].field, cases[k].component);
        }
    const mesh_copy *a = mesh_files_good(file_of(0), &(mesh_hints){.field = "other one"});
    assert_string_equal(a->report.field, "other one");
}

/* Two tets, then what a test writes behind them. */
static const char head[] = "# vtk DataFile Version 3.0\n\nASCII\nDATASET UNSTRUCTURED_GRID\n"
                           "POINTS 5 double\n0 0 0  1 0 0  0 1 0  0 0 1\n1 1 1\n"
                           "CELLS 2 10\n4 0 1 2 3\n4 4 3 2 1\nCELL_TYPES 2\n10\n10\n";

static const mesh_copy *good_tail(const char *tail, const char *field) {
    const char *path = vtk_files_append(scratch_text("t.vtk", head), tail);
    const mesh_copy *a = mesh_files_good(path, &(mesh_hints){.field = field});
    assert_int_equal(a->report.points, 5);
    assert_int_equal(a->report.tets, 2);
    return a;
}

static void test_attributes(void **state) {
    (void)state;
    assert_string_equal(good_tail("", NULL)->report.field, "");
    static const char *const fives[] = {
        "point_data 5\nscalars a int\nlookup_table t\n1 2 3 4 5\nLOOKUP_TABLE t 1\n0 0 0 1\n",
        "POINT_DATA 5\nSCALARS a unsigned_char 1\n1 2 3 4 5\n", /* no LOOKUP_TABLE */
        "POINT_DATA 5\nTEXTURE_COORDINATES t 2 float\n1 2 3 4 5 6 7 8 9 0\n"
        "SCALARS a vtkIdType\nLOOKUP_TABLE default\n1 2 3 4 5",
        "POINT_DATA 5\nCOLOR_SCALARS c 2\n0 0 0 0 0 0 0 0 0 .5\nGLOBAL_IDS a long\n1 2 3 4 5\n",
        "POINT_DATA 5\nPEDIGREE_IDS a vtktypeint64\n1 2 3 4 5\nEDGE_FLAGS e bit\n1 0 1 0 1\n",
        "POINT_DATA 5\nFIELD f 3\ns 1 5 string\na\n\nc\nd\ne f\n"
        "METADATA\nINFORMATION 0\n\na 1 5 float\n1 2 3 4 5\nz 1 5 float\n0 0 0 0 0\n",
        "CELL_DATA 2\nSCALARS a float\nLOOKUP_TABLE default\n8 9\n"
        "POINT_DATA 5\nSCALARS a float\nLOOKUP_TABLE default\n1 2 3 4 5\n",
        "FIELD f 1\na 2 2 double\n1 2 3 4\nPOINT_DATA 5\nSCALARS a double\n1 2 3 4 5\n",
    };
    for (size_t i = 0; i < sizeof fives / sizeof *fives; i++) {
        const mesh_copy *a = good_tail(fives[i], "a");
        for (int p = 0; p < 5; p++)
            assert_true(a->values[p] == (float)(p + 1));
    }
    const mesh_copy *a = good_tail("POINT_DATA 5\nTENSORS a double\n"
                                   "1 0 0 0 0 0 0 0 0  1 1 0 0 0 0 0 0 0  1 1 1 0 0 0 0 0 0\n"
                                   "1 1 1 1 0 0 0 0 0  0 0 0 0 0 0 0 0 -2\n",
                                   "a");
    assert_true(a->values[3] == 2 && a->values[4] == 2);
    a = good_tail("POINT_DATA 5\nTENSORS6 a double\n"
                  "1 0 0 0 0 0  1 1 0 0 0 0  1 1 1 0 0 0  1 1 1 1 0 0  0 0 0 0 0 -2\n"
                  "NORMALS n float\n0 0 1 0 0 1 0 0 1 0 0 1 0 0 1\n",
                  "a");
    assert_true(a->values[3] == 2 && a->values[4] == 2);
}

/* Strings among bytes have lengths of lengths: 1, 2, 4 and 8 bytes. */
static void test_binary_strings(void **state) {
    (void)state;
    static const char strings[] = "FIELD f 1\ns 1 4 string\n"
                                  "\xc2"
                                  "ab"
                                  "\x80\x03"
                                  "abc"
                                  "\x40\0\0\1"
                                  "a"
                                  "\0\0\0\0\0\0\0\2"
                                  "xy"
                                  "\nPOINTS";
    const char *path = vtk_files_legacy("a.vtk", 3, 0, false);
    size_t size;
    char *data = scratch_read(path, &size), *all = malloc(size + sizeof strings);
    char *points = memmem(data, size, "POINTS", 6);
    size_t before = (size_t)(points - data);
    memcpy(all, data, before);
    memcpy(all + before, strings, sizeof strings - 1);
    memcpy(all + before + sizeof strings - 1, points + 6, size - before - 6);
    size += sizeof strings - 1 - 6;
    vtk_files_check(mesh_files_good(scratch_write("s.vtk", all, size), NULL), 1, "alpha", 0);
    all[before + 23] = 0; /* 8 bytes of length now, and a huge one */
    mesh_files_refused(scratch_write("s.vtk", all, size), NULL, ST_CORRUPT, "bytes to skip");
    free(all);
    free(data);
}

/* ---- what is refused ---- */

static void refused(const char *from, const char *to, status st, const char *said) {
    const char *path = vtk_files_patch(scratch_text("t.vtk", head), from, to);
    mesh_files_refused(path, NULL, st, said);
}

static void refused_tail(const char *tail, status st, const char *said) {
    mesh_files_refused(vtk_files_append(scratch_text("t.vtk", head), tail), NULL, st, said);
}

static void test_header(void **state) {
    (void)state;
    refused("# vtk", "# vtl", ST_CORRUPT, "byte 0: expected \"# vtk DataFile Version x.y\"");
    refused("3.0", "x.0", ST_CORRUPT, "byte 0: expected");
    refused("3.0", "6.0", ST_UNSUPPORTED, "version 6; 1.0 to 5.1 are supported");
    refused("ASCII", "UTF-8", ST_CORRUPT, "byte 28: expected ASCII or BINARY");
    refused("DATASET ", "DATA ", ST_CORRUPT, "byte 34: expected \"DATASET UNSTRUCTURED_GRID\"");
    refused("UNSTRUCTURED_GRID", "STRUCTURED_POINTS", ST_UNSUPPORTED,
            "this is legacy VTK of structured points, which is not read here");
    mesh_files_refused(scratch_text("t.vtk", ""), NULL, ST_CORRUPT, "byte 0: expected");
    mesh_files_refused(scratch_text("t.vtk", "# vtk DataFile Version 3.0\n"), NULL, ST_CORRUPT,
                       "expected ASCII or BINARY");
}

static void test_geometry(void **state) {
    (void)state;
    refused("POINTS 5", "POINTS 6", ST_CORRUPT, "POINTS: 15 numbers, expected 18");
    refused("POINTS 5 double", "POINTS 5", ST_CORRUPT, "byte 60: expected \"POINTS n type\"");
    refused("POINTS 5", "POINTS -5", ST_CORRUPT, "POINTS: \"-5\", expected a number of them");
    refused("POINTS 5 double", "POINTS 5 complex", ST_UNSUPPORTED, "arrays of \"complex\"");
    refused("1 1 1", "1 1", ST_CORRUPT, "POINTS: 14 numbers, expected 15");
    refused("1 1 1", "1 1 1 1", ST_CORRUPT, "\"1\", expected a keyword of the format");
    refused("1 1 1", "1 1 1one", ST_CORRUPT, "POINTS: before byte");
    refused("1 1 1", "1 1 nan", ST_CORRUPT, "point 4 (counted from 0)");
    refused("CELLS 2 10", "CELLS 2 9", ST_CORRUPT, "\"1\", expected a keyword");
    refused("CELLS 2 10\n4", "CELLS 2 10\n5", ST_CORRUPT, "has 5 points, expected 4");
    refused("CELLS 2 10\n4", "CELLS 2 10\n4.5", ST_CORRUPT, "\"4.5\", expected a whole number");
    refused("CELLS 2 10\n4 0 1 2 3\n4 4 3 2 1", "CELLS 2 9\n4 0 1 2 3\n4 4 3 2", ST_CORRUPT,
            "CELLS: has 9 numbers, expected 10");
    refused("10\n10\n", "10\n71\n", ST_UNSUPPORTED,
            "CELL_TYPES: cell 1 (counted from 0) is a Lagrange tetrahedron");
    refused("CELL_TYPES 2\n10", "CELL_TYPES 1", ST_CORRUPT, "1 cell types, expected those of 2");
    refused("CELL_TYPES 2\n10\n10\n", "", ST_CORRUPT, "without CELL_TYPES");
    refused("POINTS 5 double\n0 0 0  1 0 0  0 1 0  0 0 1\n1 1 1\n", "", ST_CORRUPT,
            "without POINTS");
    refused_tail("POINTS 1 float\n0 0 0\n", ST_CORRUPT, "POINTS comes twice");
    refused_tail("CELL_TYPES 2\n10 10\n", ST_CORRUPT, "CELL_TYPES comes twice");
    refused("3.0", "5.1", ST_CORRUPT, "expected \"OFFSETS type\"");
    const char *path = vtk_files_legacy("a.vtk", 5, 1, true);
    mesh_files_refused(vtk_files_patch(path, "\n0 8 11", "\n1 8 11"), NULL, ST_CORRUPT,
                       "starts with 1, expected 0");
    mesh_files_refused(vtk_files_patch(path, "\n0 8 11", "\n0 8 7"), NULL, ST_CORRUPT,
                       "cell 1 (counted from 0) ends at 7, expected 8 or more");
    mesh_files_refused(vtk_files_patch(path, "OFFSETS vtktypeint64", "OFFSETS float"), NULL,
                       ST_CORRUPT, "OFFSETS: expected whole numbers");
}

static void test_data(void **state) {
    (void)state;
    refused_tail("POINT_DATA 4\n", ST_CORRUPT, "POINT_DATA of 4, expected 5");
    refused_tail("CELL_DATA 3\n", ST_CORRUPT, "CELL_DATA of 3, expected 2");
    refused_tail("SCALARS a float\n", ST_CORRUPT, "SCALARS without POINT_DATA or CELL_DATA");
    refused_tail("POINT_DATA 5\nSCALARS a\n", ST_CORRUPT, "expected \"SCALARS name type\"");
    refused_tail("POINT_DATA 5\nSCALARS a float 0\n", ST_CORRUPT, "array \"a\": 0 components");
    refused_tail("POINT_DATA 5\nSCALARS a float\nLOOKUP_TABLE default\n1 2 3 4\n", ST_CORRUPT,
                 "array \"a\": 4 numbers, expected 5");
    refused_tail("POINT_DATA 5\nSCALARS a float\nLOOKUP_TABLE default\n1 2 3 4 5 6\n", ST_CORRUPT,
                 "\"6\", expected a keyword");
    refused_tail("POINT_DATA 5\nSCALARS a float\nLOOKUP_TABLE default\n1 2 3x 4 5\n", ST_CORRUPT,
                 "\"3x\", expected a number");
    refused_tail("POINT_DATA 5\nFIELD f 1\na 1 4 float\n1 2 3 4\n", ST_CORRUPT,
                 "array \"a\": 4 tuples, expected 5");
    refused_tail("POINT_DATA 5\nFIELD f 2\na 1 5 float\n1 2 3 4 5\n", ST_CORRUPT,
                 "expected \"name components tuples type\"");
    refused_tail("POINT_DATA 5\nFIELD f 1\na 1 5 variant\n", ST_UNSUPPORTED, "\"variant\"");
    refused_tail("FIELD f 1\na 140737488355327 140737488355327 float\n", ST_CORRUPT,
                 "140737488355327 components");
    refused_tail("CELL_DATA 2\nSCALARS a float\n1 2\n", ST_USAGE,
                 "no array of numbers of the points, which have none; the cells have \"a\"");
}

static void test_bad_ids(void **state) {
    (void)state;
    static const char *const bad[] = {"5", "-1", "4294967296", "99999999999999999999"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        char cell[64];
        snprintf(cell, sizeof cell, "4 0 1 2 %s\n", bad[i]);
        const char *path = vtk_files_patch(scratch_text("t.vtk", head), "4 0 1 2 3\n", cell);
        const mesh_copy *a = mesh_files_good(path, NULL);
        assert_int_equal(a->report.tets, 1);
        assert_int_equal(a->report.bad_indices, 1);
    }
}

/* ---- sweeps ---- */

static void test_cut(void **state) {
    (void)state;
    const mesh_hints hints = {.field = "w", .cells_to_points = true}; /* the last array */
    for (int i = 0; i < 2 * VERSIONS; i++) {
        const mesh_copy *a;
        size_t size;
        char *data = scratch_read(file_of(i), &size);
        for (size_t n = 0; n + 5 < size; n += n + 50 < size ? 7 : 1) {
            status st = mesh_files_read(scratch_write("cut.vtk", data, n), &hints, &a);
            if (st != ST_CORRUPT && st != ST_USAGE && st != ST_UNSUPPORTED)
                fail_msg("file %d cut to %zu of %zu bytes: status %d", i, n, size, (int)st);
        }
        free(data);
    }
}

/* Any byte changed gives an error or a mesh that keeps mesh_input.h's promises. */
static void test_damage(void **state) {
    (void)state;
    static const char masks[] = {1, 0x10, (char)0xff};
    for (int i = 0; i < 2 * VERSIONS; i++) {
        const mesh_copy *a;
        size_t size, noticed = 0, all = 0;
        char *data = scratch_read(file_of(i), &size);
        for (size_t n = (size_t)i % 3; n < size; n += 3, all++) {
            char mask = masks[n / 3 % 3];
            data[n] ^= mask;
            noticed += mesh_files_read(scratch_write("bad.vtk", data, size), NULL, &a) != ST_OK;
            data[n] ^= mask;
        }
        /* Fields not asked for, digits, bytes of numbers: much may change unnoticed. */
        if (noticed < all / 20)
            fail_msg("file %d: %zu of %zu changes noticed", i, noticed, all);
        free(data);
    }
}

static void test_faults(void **state) {
    (void)state;
    for (int i = 0; i < 2 * VERSIONS; i++) {
        mesh_hints hints = {.cells_to_points = i % 2};
        mesh_files_faults(file_of(i), &hints);
    }
}

/* ---- a longer one ---- */

enum { LONG_POINTS = 60000 };

/* A chain of tets: i, i + 1, i + 2, i + 3; their data are scattered numbers. */
static const char *long_file(void) {
    char *text;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    const int cells = LONG_POINTS - 3;
    fprintf(
        out,
        "# vtk DataFile Version 3.0\nchain\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS %d float\n",
        LONG_POINTS);
    for (int i = 0; i < LONG_POINTS; i++)
        fprintf(out, "%d %d %d\n", i, i % 7, i % 5);
    fprintf(out, "CELLS %d %d\n", cells, 5 * cells);
    for (int i = 0; i < cells; i++)
        fprintf(out, "4 %d %d %d %d\n", i, i + 1, i + 2, i + 3);
    fprintf(out, "CELL_TYPES %d\n", cells);
    for (int i = 0; i < cells; i++)
        fprintf(out, "10\n");
    fprintf(out, "CELL_DATA %d\nSCALARS a double\nLOOKUP_TABLE default\n", cells);
    for (int i = 0; i < cells; i++)
        fprintf(out, "%.3f\n", (double)(i * 7919LL % 10007) / 3.0);
    fclose(out);
    const char *path = scratch_write("long.vtk", text, size);
    free(text);
    return path;
}

static float averages[LONG_POINTS];

static status no_points(void *ctx, uint64_t first, size_t count, const float (*xyz)[3]) {
    (void)ctx, (void)first, (void)count, (void)xyz;
    return ST_OK;
}

static status keep_values(void *ctx, uint64_t first, size_t count, const float *values) {
    (void)ctx;
    memcpy(averages + first, values, count * sizeof *values);
    return ST_OK;
}

static status no_tets(void *ctx, size_t count, const uint32_t (*ids)[4]) {
    (void)ctx, (void)count, (void)ids;
    return ST_OK;
}

/* Within a limit, averages take several rounds over the cells, and are the same. */
static void test_rounds(void **state) {
    (void)state;
    const mesh_sink sink = {NULL, no_points, keep_values, no_tets, NULL, NULL, NULL, false};
    const mesh_hints hints = {.cells_to_points = true};
    const char *path = long_file();
    const mesh_copy *a = mesh_files_good(path, &hints);
    assert_int_equal(a->report.tets, LONG_POINTS - 3);
    for (size_t limit = 700000; limit < 1000000; limit += 100000) {
        mem m;
        mesh_input *x = NULL;
        mesh_report report;
        mem_init(&m, limit);
        memset(averages, 0, sizeof averages);
        assert_int_equal(mesh_input_open(&m, path, &hints, &x), ST_OK);
        if (mesh_input_read(x, &sink, &report) != ST_OK)
            fail_msg("%s", status_text());
        mesh_input_close(x);
        assert_int_equal(mem_used(&m), 0);
        assert_memory_equal(averages, a->values, sizeof averages);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_versions),   cmocka_unit_test(test_fields),
        cmocka_unit_test(test_attributes), cmocka_unit_test(test_binary_strings),
        cmocka_unit_test(test_header),     cmocka_unit_test(test_geometry),
        cmocka_unit_test(test_data),       cmocka_unit_test(test_bad_ids),
        cmocka_unit_test(test_cut),        cmocka_unit_test(test_damage),
        cmocka_unit_test(test_faults),     cmocka_unit_test(test_rounds),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
