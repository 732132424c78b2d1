/* test_mesh_stream_polyhedra.c - polyhedra of mesh streams: what comes of VTK's; what the writer
 * writes; headers that do not tell what is there; ids that are no point's; cut and damaged files;
 * faults.
 */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/mesh/mesh_stream.h"
#include "tests/support/mesh_files.h"
#include "tests/support/scratch.h"

/* A cube that is cut above, with two sides of five corners; a pyramid on it; a tet. */
enum { POINTS = 11, POLYHEDRA = 2, NUMBERS = 39 + 23, MIDDLES = 3 + 1 };

static const float places[POINTS][3] = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0},
                                        {0, 0, 4}, {4, 0, 4}, {4, 4, 4}, {0, 4, 4},
                                        {1, 0, 4}, {1, 4, 4}, {2, 2, 9}};
static const uint32_t tet[1][4] = {{4, 8, 9, 10}};
static const uint32_t numbers[NUMBERS] = {38, 7,  4, 0, 1, 2,  3, 5,  0, 1,  5, 8, 4, 4, 1, 2,
                                          6,  5,  5, 2, 3, 7,  9, 6,  4, 3,  0, 4, 7, 4, 4, 8,
                                          9,  7,  4, 8, 5, 6,  9, 22, 5, 4,  8, 5, 6, 9, 3, 8,
                                          5,  10, 3, 5, 6, 10, 3, 6,  9, 10, 3, 9, 8, 10};

static float value_of(int field, int point) {
    return (float)(field ? point * point : 10 - point);
}

static const char vtk_numbers[] =
    "38 7 4 0 1 2 3 5 0 1 5 8 4 4 1 2 6 5 5 2 3 7 9 6 4 3 0 4 7 4 4 8 "
    "9 7 4 8 5 6 9\n22 5 4 8 5 6 9 3 8 5 10 3 5 6 10 3 6 9 10 3 9 8 "
    "10\n";

/* The same as a file of VTK, with one of the fields. */
static const char *vtk_file(int field) {
    const char *path = scratch_path("same.vtk");
    FILE *out = fopen(path, "w");
    assert_non_null(out);
    fprintf(out,
            "# vtk DataFile Version 3.0\nsame\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS %d float\n",
            POINTS);
    for (int i = 0; i < POINTS; i++)
        fprintf(out, "%g %g %g\n", (double)places[i][0], (double)places[i][1],
                (double)places[i][2]);
    fprintf(out, "CELLS 3 %d\n4 4 8 9 10\n%sCELL_TYPES 3\n10 42 42\n", 5 + NUMBERS, vtk_numbers);
    fprintf(out, "POINT_DATA %d\nSCALARS f float 1\nLOOKUP_TABLE default\n", POINTS);
    for (int i = 0; i < POINTS; i++)
        fprintf(out, "%g\n", (double)value_of(field, i));
    assert_int_equal(fclose(out), 0);
    return path;
}

/* ---- a stream by hand ---- */

typedef struct told {
    uint64_t polyhedra, numbers, middles; /* in the header */
    uint32_t tet[4], of[NUMBERS];
    int fields;
} told;

static told right(void) {
    told t = {.polyhedra = POLYHEDRA, .numbers = NUMBERS, .middles = MIDDLES, .fields = 2};
    memcpy(t.tet, tet[0], sizeof t.tet);
    memcpy(t.of, numbers, sizeof t.of);
    return t;
}

static char *put(char *to, const void *data, size_t size) {
    memcpy(to, data, size);
    return to + size;
}

static const char *by_hand(const told *t) {
    static char bytes[4096];
    char *at = bytes + snprintf(bytes, sizeof bytes,
                                "LEAFCAST MESH 2\n%spoints: %d\ntets: "
                                "1\npolyhedra: %llu\nnumbers of polyhedra: %llu\nmiddles of "
                                "polyhedra: %llu\n\n",
                                t->fields ? "field: f\nfield: g\n" : "", POINTS,
                                (unsigned long long)t->polyhedra, (unsigned long long)t->numbers,
                                (unsigned long long)t->middles);
    at = put(at, places, sizeof places);
    for (int field = 0; field < t->fields; field++)
        for (int i = 0; i < POINTS; i++) {
            const float value = value_of(field, i);
            at = put(at, &value, sizeof value);
        }
    at = put(at, t->tet, sizeof t->tet);
    const uint64_t count = t->numbers < NUMBERS ? t->numbers : NUMBERS;
    at = put(at, t->of, (size_t)count * 4);
    for (uint64_t i = count; i < t->numbers; i++)
        at = put(at, &(uint32_t){0}, 4);
    return scratch_write("hand.mesh", bytes, (size_t)(at - bytes));
}

/* ---- what comes of it ---- */

static void test_as_vtk(void **state) {
    (void)state;
    static const char *const names[] = {"f", "g"};
    const told t = right();
    for (int field = 0; field < 2; field++) {
        mesh_copy *want = mesh_files_keep(mesh_files_good(vtk_file(field), NULL));
        const mesh_copy *a = mesh_files_good(by_hand(&t), &(mesh_hints){.field = names[field]});
        mesh_files_same(want, a);
        assert_int_equal(a->report.polyhedra, POLYHEDRA);
        assert_int_equal(a->report.points, POINTS + MIDDLES);
        assert_int_equal(a->report.tets, want->report.tets);
        free(want);
    }
}

/* Without a field all values are 0. More of them than there are points to be are not begun. */
static void test_no_field(void **state) {
    (void)state;
    told t = right();
    const mesh_copy *a = mesh_files_good(by_hand(&t), NULL);
    const uint64_t tets = a->report.tets;
    t.fields = 0;
    a = mesh_files_good(by_hand(&t), NULL);
    assert_true(a->report.tets == tets && a->report.points == POINTS + MIDDLES);
    for (int i = 0; i < POINTS + MIDDLES; i++)
        assert_true(a->values[i] == 0.0f);
    t.middles = 16 * MESH_FILES_ROOM; /* more than can be taken */
    mesh_files_refused(by_hand(&t), NULL, ST_CORRUPT, "add 4 points, expected 62 and 4194304");
}

static status write_all(mesh_stream_writer *w, int fields) {
    status st = mesh_stream_points(w, POINTS, places);
    for (int field = 0; field < fields; field++)
        for (int i = 0; i < POINTS && st == ST_OK; i++) {
            const float value = value_of(field, i);
            st = mesh_stream_values(w, 1, &value);
        }
    if (st == ST_OK)
        st = mesh_stream_tets(w, 1, tet);
    if (st == ST_OK)
        st = mesh_stream_numbers(w, 20, numbers);
    return st == ST_OK ? mesh_stream_numbers(w, NUMBERS - 20, numbers + 20) : st;
}

static const char *by_writer(int fields) {
    static const char *const further[] = {"g"};
    mesh_stream_header h = {.points = POINTS,
                            .tets = 1,
                            .bare = fields == 0,
                            .polyhedra = POLYHEDRA,
                            .numbers = NUMBERS,
                            .middles = MIDDLES,
                            .fields = further,
                            .field_count = fields > 1};
    mesh_stream_writer *w;
    mem m;
    strcpy(h.field, fields > 0 ? "f" : "");
    mem_init(&m, 0);
    assert_int_equal(mesh_stream_create(&m, scratch_path("w.mesh"), true, &h, &w), ST_OK);
    assert_int_equal(write_all(w, fields), ST_OK);
    assert_int_equal(mesh_stream_commit(w), ST_OK);
    assert_int_equal(mem_used(&m), 0);
    return scratch_path("w.mesh");
}

static void test_writer(void **state) {
    (void)state;
    size_t size, written;
    const told t = right();
    char *want = scratch_read(by_hand(&t), &size), *got = scratch_read(by_writer(2), &written);
    assert_int_equal(size, written);
    assert_memory_equal(want, got, size);
    free(want);
    free(got);
    const mesh_copy *a = mesh_files_good(by_writer(0), NULL);
    assert_int_equal(a->report.points, POINTS + MIDDLES);
    for (int i = 0; i < POINTS + MIDDLES; i++)
        assert_true(a->values[i] == 0);
}

/* ---- ids that are no point's ---- */

static void test_bad_ids(void **state) {
    (void)state;
    told t = right();
    t.of[NUMBERS - 1] = POINTS;
    t.middles -= 1;
    const mesh_copy *a = mesh_files_good(by_hand(&t), NULL);
    assert_int_equal(a->report.polyhedra, POLYHEDRA - 1);
    assert_int_equal(a->report.bad_indices, 1);
    assert_int_equal(a->report.points, POINTS + MIDDLES - 1);
    t = right();
    t.tet[2] = POINTS; /* which is the id of a middle */
    a = mesh_files_good(by_hand(&t), NULL);
    assert_int_equal(a->report.polyhedra, POLYHEDRA);
    assert_int_equal(a->report.bad_indices, 1);
}

/* ---- what is refused ---- */

static void refused(const told *t, const char *said) {
    mesh_files_refused(by_hand(t), NULL, ST_CORRUPT, said);
}

static void test_refused(void **state) {
    (void)state;
    told t = right();
    t.middles++;
    refused(&t, "have 62 numbers and add 4 points, expected 62 and 5");
    t.middles -= 2;
    refused(&t, "polyhedron 1 (counted from 0) adds more points than the header tells of");
    t = right();
    t.numbers++;
    refused(&t, "have 62 numbers and add 4 points, expected 63 and 4");
    t.numbers -= 2;
    refused(&t, "polyhedron 1 (counted from 0) ends behind the numbers");
    t = right();
    t.polyhedra++;
    refused(&t, "polyhedron 2 (counted from 0) begins behind the numbers");
    t.polyhedra -= 2;
    refused(&t, "have 39 numbers and add 3 points, expected 62 and 4");
    t.polyhedra = 0;
    refused(&t, "have 0 numbers and add 0 points");
    for (int i = 0; i < 2; i++) {
        t = right();
        t.of[39] = i ? MESH_STREAM_POLYHEDRON_MAX : 0;
        refused(&t, "polyhedron 1 (counted from 0) has no numbers, or more than 65535");
    }
    t = right();
    t.of[1] = 6;
    refused(&t, "polyhedron 0 (counted from 0) has more numbers than its faces");
    t = right();
    t.of[40] = 3;
    refused(&t, "polyhedron 1 (counted from 0) has less than four faces");
    mesh_files_refused(
        scratch_text("b.mesh", "LEAFCAST MESH 2\npoints: 0\npolyhedra: 1\npolyhedra: 1\n\n"), NULL,
        ST_CORRUPT, "line 4: \"polyhedra: 1\", expected each line once");
    mesh_files_refused(scratch_text("b.mesh", "LEAFCAST MESH 1\npoints: 0\npolyhedra: 1\n\n"), NULL,
                       ST_CORRUPT, "line 3: \"polyhedra: 1\", expected name");
    mesh_files_refused(
        scratch_text("b.mesh", "LEAFCAST MESH 2\npoints: 1\nmiddles of polyhedra: 4294967294\n\n"
                               "123456789012"),
        NULL, ST_UNSUPPORTED, "4294967295 points, expected at most 4294967294");
}

static void test_damage(void **state) {
    (void)state;
    const told t = right();
    const char *path = by_hand(&t);
    mesh_files_truncate(path, NULL, 0);
    mesh_files_faults(path, NULL);
    assert_true(mesh_files_damage(path, NULL) > 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_as_vtk),  cmocka_unit_test(test_no_field),
        cmocka_unit_test(test_writer),  cmocka_unit_test(test_bad_ids),
        cmocka_unit_test(test_refused), cmocka_unit_test(test_damage),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
