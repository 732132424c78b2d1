/* test_mesh_stream.c - the mesh stream: what is written is read, by file and by pipe; refusals that
 * name the place; cut and damaged files; faults.
 */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "formats/base/fault.h"
#include "formats/mesh/mesh_stream.h"
#include "tests/support/mesh_files.h"
#include "tests/support/scratch.h"

static const float xyz[5][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1.5f}};
static const float values[5] = {1, -2, 3.25f, 1e30f, INFINITY};
static const uint32_t tets[3][4] = {{0, 1, 2, 3}, {4, 3, 2, 1}, {1, 0, 2, 4}};

static status write_mesh(mem *m, const char *path, const mesh_stream_header *h,
                         const uint32_t (*ids)[4]) {
    mesh_stream_writer *w;
    status st = mesh_stream_create(m, path, true, h, &w);
    if (st != ST_OK)
        return st;
    st = mesh_stream_points(w, 2, xyz);
    if (st == ST_OK)
        st = mesh_stream_points(w, 3, xyz + 2);
    if (st == ST_OK)
        st = mesh_stream_values(w, 5, values);
    if (st == ST_OK)
        st = mesh_stream_tets(w, h->tets, ids);
    if (st == ST_OK)
        return mesh_stream_commit(w);
    mesh_stream_discard(w);
    return st;
}

static const char *write_file(const char *name, const mesh_stream_header *h,
                              const uint32_t (*ids)[4]) {
    mem m;
    mem_init(&m, 0);
    const char *path = scratch_path(name);
    assert_int_equal(write_mesh(&m, path, h, ids), ST_OK);
    assert_int_equal(mem_used(&m), 0);
    return path;
}

static const mesh_stream_header plain = {
    .name = "five points", .field = "f", .points = 5, .tets = 3};

static void check_plain(const mesh_copy *a) {
    assert_int_equal(a->report.points, 5);
    assert_int_equal(a->report.tets, 3);
    assert_int_equal(a->report.bad_indices + a->report.repeated + a->report.skipped, 0);
    assert_string_equal(a->report.field, "f");
    assert_string_equal(a->name, "five points");
    assert_memory_equal(a->xyz, xyz, sizeof xyz);
    assert_memory_equal(a->values, values, sizeof values);
    assert_memory_equal(a->tets, tets, sizeof tets);
}

static void test_round_trip(void **state) {
    (void)state;
    const char *path = write_file("a.mesh", &plain, tets);
    assert_true(mesh_files_recognised(path));
    check_plain(mesh_files_good(path, NULL));
    const mesh_hints hints = {.field = "f", .component = 1};
    check_plain(mesh_files_good(path, &hints));
    mesh_files_truncate(path, NULL, 0);
    mesh_files_faults(path, NULL);
    assert_true(mesh_files_damage(path, NULL) > 0);
}

static void test_bytes(void **state) {
    (void)state;
    size_t size;
    char *bytes = scratch_read(write_file("a.mesh", &plain, tets), &size);
    static const char header[] =
        "LEAFCAST MESH 1\nname: five points\nfield: f\npoints: 5\ntets: 3\n\n";
    assert_int_equal(size, sizeof header - 1 + 5 * 16 + 3 * 16);
    assert_memory_equal(bytes, header, sizeof header - 1);
    static const unsigned char last[16] = {1, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0, 4, 0, 0, 0};
    assert_memory_equal(bytes + size - 16, last, 16);
    free(bytes);
}

static void test_left_out(void **state) {
    (void)state;
    static const uint32_t ids[6][4] = {{0, 1, 2, 5},          {0, 1, 2, 3}, {3, 3, 1, 2},
                                       {UINT32_MAX, 1, 2, 3}, {1, 2, 4, 1}, {4, 1, 2, 0}};
    mesh_stream_header h = {.points = 5, .tets = 6};
    const mesh_copy *a = mesh_files_good(write_file("a.mesh", &h, ids), NULL);
    assert_int_equal(a->report.tets, 2);
    assert_int_equal(a->report.bad_indices, 2);
    assert_int_equal(a->report.repeated, 2);
    assert_memory_equal(a->tets[0], ids[1], sizeof ids[1]);
    assert_memory_equal(a->tets[1], ids[5], sizeof ids[5]);
    assert_string_equal(a->name, "");
    assert_string_equal(a->report.field, "");
}

/* Standard input, put in place of the tests' own for a while. */
static void from_pipe(const char *path, size_t cut, status want) {
    size_t size;
    char *bytes = scratch_read(path, &size);
    int ends[2], kept = dup(STDIN_FILENO);
    assert_int_equal(pipe(ends), 0);
    assert_int_equal(write(ends[1], bytes, size - cut), size - cut);
    close(ends[1]);
    dup2(ends[0], STDIN_FILENO);
    const mesh_copy *a;
    assert_int_equal(mesh_files_read("-", NULL, &a), want);
    if (want == ST_OK)
        check_plain(a);
    dup2(kept, STDIN_FILENO);
    close(kept);
    close(ends[0]);
    free(bytes);
}

static void test_pipe(void **state) {
    (void)state;
    const char *path = write_file("a.mesh", &plain, tets);
    from_pipe(path, 0, ST_OK);
    from_pipe(path, 1, ST_CORRUPT);
    from_pipe(path, 16 * 8 + 1, ST_CORRUPT);
}

/* ---- version 2 ---- */

enum { FIELDS_2 = 3, POINTS_2 = 12 };

static const uint32_t tets_2[2][4] = {{0, 1, 2, 11}, {4, 3, 2, 1}},
                      pyramids_2[1][5] = {{0, 1, 2, 3, 8}},
                      wedges_2[2][6] = {{0, 1, 2, 3, 4, 5}, {6, 7, 8, 9, 10, 11}},
                      hexahedra_2[2][8] = {{0, 1, 2, 3, 4, 5, 6, 7}, {4, 5, 6, 7, 8, 9, 10, 11}},
                      quadratic_2[2][10] = {{11, 1, 2, 4, 3, 5, 6, 7, 8, 9},
                                            {3, 9, 1, 8, 0, 2, 4, 5, 6, 7}};
static const char *const further[FIELDS_2 - 1] = {"second", "third"};
static const mesh_stream_header mixed = {
    .name = "mixed",
    .field = "first",
    .points = POINTS_2,
    .tets = 2,
    .cells = {[CELL_PYRAMID] = 1, [CELL_WEDGE] = 2, [CELL_HEXAHEDRON] = 2},
    .fields = further,
    .field_count = FIELDS_2 - 1};

static float value_2(uint32_t field, uint32_t point) {
    return (float)(100 * field + point);
}

static const char *write_mixed(const mesh_stream_header *h) {
    mem m;
    mesh_stream_writer *w;
    float at[POINTS_2][3], of[FIELDS_2 * POINTS_2];
    const uint32_t arrays = h->field_count + (h->field[0] != 0);
    mem_init(&m, 0);
    for (uint32_t i = 0; i < POINTS_2; i++)
        for (uint32_t a = 0; a < 3; a++)
            at[i][a] = (float)(i >> a & 1) + 0.01f * (float)i;
    for (uint32_t k = 0; k < FIELDS_2; k++)
        for (uint32_t i = 0; i < POINTS_2; i++)
            of[k * POINTS_2 + i] = value_2(k, i);
    assert_int_equal(mesh_stream_create(&m, scratch_path("m.mesh"), true, h, &w), ST_OK);
    assert_int_equal(mesh_stream_points(w, POINTS_2, (const float(*)[3])at), ST_OK);
    assert_int_equal(mesh_stream_values(w, 1 * (arrays > 0), of), ST_OK);
    assert_int_equal(mesh_stream_values(w, arrays > 0 ? arrays * POINTS_2 - 1 : 0, of + 1), ST_OK);
    assert_int_equal(mesh_stream_tets(w, 2, tets_2), ST_OK);
    assert_int_equal(mesh_stream_cells(w, CELL_PYRAMID, 1, pyramids_2[0]), ST_OK);
    assert_int_equal(mesh_stream_cells(w, CELL_WEDGE, 1, wedges_2[0]), ST_OK);
    assert_int_equal(mesh_stream_cells(w, CELL_WEDGE, 1, wedges_2[1]), ST_OK);
    assert_int_equal(mesh_stream_cells(w, CELL_HEXAHEDRON, 2, hexahedra_2[0]), ST_OK);
    assert_int_equal(
        mesh_stream_cells(w, CELL_QUADRATIC_TET, h->cells[CELL_QUADRATIC_TET], quadratic_2[0]),
        ST_OK);
    assert_int_equal(mesh_stream_commit(w), ST_OK);
    assert_int_equal(mem_used(&m), 0);
    return scratch_path("m.mesh");
}

/* What comes of it, none of it split. */
typedef struct whole {
    uint32_t points, values, cells;
    float of[FIELDS_2 * POINTS_2];
    uint32_t ids[9][CELL_ROW];
} whole;

static status take_points(void *ctx, uint64_t first, size_t count, const float (*at)[3]) {
    whole *x = ctx;
    (void)at;
    assert_int_equal(first, x->points);
    x->points += (uint32_t)count;
    return ST_OK;
}

static status take_values(void *ctx, uint64_t first, size_t count, const float *from) {
    whole *x = ctx;
    assert_true(first + count <= FIELDS_2 * POINTS_2);
    memcpy(x->of + first, from, count * sizeof *from);
    x->values += (uint32_t)count;
    return ST_OK;
}

static status take_cells(void *ctx, size_t count, const uint32_t (*ids)[CELL_ROW]) {
    whole *x = ctx;
    assert_true(x->cells + count <= 9);
    memcpy(x->ids[x->cells], ids, count * sizeof *ids);
    x->cells += (uint32_t)count;
    return ST_OK;
}

static void read_whole(const char *const *names, uint32_t count, whole *x, mesh_report *report) {
    const mesh_sink sink = {
        .ctx = x, .points = take_points, .values = take_values, .tets = NULL, .cells = take_cells};
    mem m;
    mesh_input *in = NULL;
    *x = (whole){0};
    mem_init(&m, 0);
    assert_int_equal(mesh_input_open(&m, scratch_path("m.mesh"), NULL, &in), ST_OK);
    if (count)
        assert_int_equal(mesh_input_take(in, names, count), ST_OK);
    if (mesh_input_read(in, &sink, report) != ST_OK)
        fail_msg("%s", status_text());
    mesh_input_close(in);
    assert_int_equal(mem_used(&m), 0);
    assert_int_equal(x->points, POINTS_2);
}

static void check_cell(const whole *x, uint32_t cell, cell_shape shape, const uint32_t *ids) {
    for (int c = 0; c < CELL_ROW; c++)
        assert_int_equal(x->ids[cell][c], ids[cell_shape_row(shape)[c]]);
}

static void test_whole_cells(void **state) {
    (void)state;
    static const char *const asked[] = {"third", "first", "third"};
    whole x;
    mesh_report report;
    write_mixed(&mixed);
    read_whole(asked, 3, &x, &report);
    assert_int_equal(x.values, 3 * POINTS_2);
    for (uint32_t i = 0; i < POINTS_2; i++) {
        assert_true(x.of[i] == value_2(2, i) && x.of[2 * POINTS_2 + i] == value_2(2, i));
        assert_true(x.of[POINTS_2 + i] == value_2(0, i));
    }
    assert_string_equal(report.field, "third");
    assert_int_equal(x.cells, 7);
    check_cell(&x, 0, CELL_TET, tets_2[0]);
    check_cell(&x, 1, CELL_TET, tets_2[1]);
    check_cell(&x, 2, CELL_PYRAMID, pyramids_2[0]);
    check_cell(&x, 3, CELL_WEDGE, wedges_2[0]);
    check_cell(&x, 4, CELL_WEDGE, wedges_2[1]);
    check_cell(&x, 5, CELL_HEXAHEDRON, hexahedra_2[0]);
    check_cell(&x, 6, CELL_HEXAHEDRON, hexahedra_2[1]);
    read_whole(NULL, 0, &x, &report);
    assert_int_equal(x.values, POINTS_2);
    assert_true(x.of[5] == value_2(0, 5));
    assert_string_equal(report.field, "first");
    assert_int_equal(report.whole[CELL_WEDGE], 2);
}

static void note_name(void *ctx, const char *name, int components) {
    assert_int_equal(components, 1);
    strcat(strcat(ctx, name), " ");
}

static void test_version_2(void **state) {
    (void)state;
    static const char header[] =
        "LEAFCAST MESH 2\nname: mixed\nfield: first\nfield: second\nfield: "
        "third\npoints: 12\ntets: 2\npyramids: 1\nwedges: 2\nhexahedra: 2\n\n";
    size_t size;
    const char *path = write_mixed(&mixed);
    char *bytes = scratch_read(path, &size), names[64] = "";
    assert_int_equal(size, sizeof header - 1 + POINTS_2 * (12 + 12) + 4 * (8 + 5 + 12 + 16));
    assert_memory_equal(bytes, header, sizeof header - 1);
    free(bytes);
    mem m;
    mesh_input *in = NULL;
    mem_init(&m, 0);
    assert_int_equal(mesh_input_open(&m, path, NULL, &in), ST_OK);
    mesh_input_fields(in, note_name, names);
    mesh_input_close(in);
    assert_string_equal(names, "first second third ");
    const mesh_hints hints = {.field = "second"};
    const mesh_copy *a = mesh_files_good(path, &hints);
    assert_true(a->values[3] == value_2(1, 3));
    assert_int_equal(a->report.split[CELL_HEXAHEDRON], 2);
    mesh_files_refused(
        path, &(mesh_hints){.field = "fourth"}, ST_USAGE,
        "no array \"fourth\" of the points, which have \"first\", \"second\", \"third\"");
    mesh_files_truncate(path, &hints, 0);
    mesh_files_faults(path, &hints);
    assert_true(mesh_files_damage(path, &hints) > 0);
    mesh_stream_header bare = mixed;
    bare.field[0] = 0;
    bare.field_count = 0;
    a = mesh_files_good(write_mixed(&bare), NULL);
    assert_true(a->values[3] == 0 && a->report.points == POINTS_2);
    assert_string_equal(a->report.field, "");
    mesh_stream_header left = mixed;
    left.by_corners = 3;
    left.skipped = 5;
    a = mesh_files_good(write_mixed(&left), NULL);
    assert_int_equal(a->report.by_corners, 3);
    assert_int_equal(a->report.skipped, 5);
}

/* Quadratic tets stay what they are, or are taken by their corners; split they are not. */
static void test_quadratic(void **state) {
    (void)state;
    whole x;
    mesh_report report;
    mesh_stream_header h = mixed;
    h.cells[CELL_QUADRATIC_TET] = 2;
    h.by_corners = 3;
    const char *path = write_mixed(&h);
    read_whole(NULL, 0, &x, &report);
    assert_int_equal(x.cells, 9);
    check_cell(&x, 7, CELL_QUADRATIC_TET, quadratic_2[0]);
    check_cell(&x, 8, CELL_QUADRATIC_TET, quadratic_2[1]);
    assert_int_equal(report.by_corners, 3);
    mesh_files_refused(path, NULL, ST_UNSUPPORTED,
                       "m.mesh: 2 cells are quadratic tets (--whole-cells takes them as they are, "
                       "--by-corners as linear ones)");
    const mesh_copy *a = mesh_files_good(path, &(mesh_hints){.by_corners = true});
    for (int i = 0; i < 2; i++)
        assert_memory_equal(a->tets[a->report.tets - 2 + (uint64_t)i], quadratic_2[i], 16);
    assert_int_equal(a->report.by_corners, 3 + 2);
    a = mesh_files_good(write_mixed(&mixed), &(mesh_hints){.by_corners = true});
    assert_int_equal(a->report.by_corners, 0);
}

#define START   "LEAFCAST MESH 1\n"
#define START_2 "LEAFCAST MESH 2\n"

static void test_refused(void **state) {
    (void)state;
    static const struct {
        const char *text;
        status st;
        const char *said;
    } cases[] = {
        {"LEAFCAST MESH 3\npoints: 0\ntets: 0\n\n", ST_UNSUPPORTED,
         "expected \"LEAFCAST MESH 1\" or 2"},
        {"LEAFCAST MESH \npoints: 0\ntets: 0\n\n", ST_UNSUPPORTED, "expected \"LEAFCAST MESH 1\""},
        {"LEAFCAST MESH", ST_UNSUPPORTED,
         "no known format (it begins with 4c 45 41 46 43 41 53 54"},
        {START "points: 0\n\n", ST_CORRUPT, "line 3: \"\", expected lines"},
        {START "points: 0\ntets: 0\n", ST_CORRUPT, "line 4: \"\", expected a line"},
        {START "points: -1\ntets: 0\n\n", ST_CORRUPT, "line 2: \"points: -1\", expected a number"},
        {START "points: 4294967295\ntets: 0\n\n", ST_CORRUPT, "line 2"},
        {START "points: 1\npoints: 1\ntets: 0\n\n", ST_CORRUPT,
         "line 3: \"points: 1\", expected each"},
        {START "field: a\nfield: b\npoints: 0\ntets: 0\n\n", ST_CORRUPT, "line 3"},
        {START "name: \npoints: 0\ntets: 0\n\n", ST_CORRUPT, "line 2: \"name:\""},
        {START "colour: red\npoints: 0\ntets: 0\n\n", ST_CORRUPT, "expected name, field"},
        {START "tets: 1\npoints: 1\n\n", ST_CORRUPT, "0 bytes behind the header, expected 32"},
        {START "tets: 0\npoints: 0\n\nx", ST_CORRUPT, "1 bytes behind the header, expected 0"},
        {START "tets: 0\npoints: 1\n\n\0\0\xc0\x7f", ST_CORRUPT, "behind the header"},
        {START "points: 0\ntets: 0\nwedges: 0\n\n", ST_CORRUPT,
         "line 4: \"wedges: 0\", expected name"},
        {START "points: 0\ntets: 0\nskipped: 0\n\n", ST_CORRUPT, "line 4: \"skipped: 0\""},
        {START "points: 0\ntets: 0\nby-corners: 0\n\n", ST_CORRUPT, "line 4: \"by-corners: 0\""},
        {START_2 "points: 0\nskipped: 1\nskipped: 1\n\n", ST_CORRUPT, "line 4: \"skipped: 1\""},
        {START_2 "points: 0\nby-corners: 0\nby-corners: 1\n\n", ST_CORRUPT, "each line once"},
        {START_2 "tets: 0\n\n", ST_CORRUPT, "line 3: \"\", expected a line \"points: N\""},
        {START_2 "points: 0\nvoxels: 0\n\n", ST_CORRUPT,
         "quadratic tets, polyhedra, their numbers and middles, by-corners, skipped or an "},
        {START_2 "points: 0\nwedges: 1\nwedges: 1\n\n", ST_CORRUPT, "line 4: \"wedges: 1\""},
        {START_2 "field: a\nfield: b\nfield: a\npoints: 0\n\n", ST_CORRUPT, "each field once"},
        {START_2 "field: 1234567890123456789012345678901234567890123456789012345678901234\n",
         ST_CORRUPT, "a name of 1 to 63 bytes"},
        {START_2 "field: a\nfield: b\npoints: 1\nhexahedra: 2\n\n", ST_CORRUPT,
         "expected 84 for 1 points and 2 cells"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        mesh_files_refused(scratch_text("b.mesh", cases[i].text), NULL, cases[i].st, cases[i].said);
    const char *path = write_file("a.mesh", &plain, tets);
    mesh_files_refused(path, &(mesh_hints){.field = "g"}, ST_USAGE, "no array \"g\" of the points");
    mesh_files_refused(path, &(mesh_hints){.component = 2}, ST_USAGE, "no component 2 but 1 to 1");
    mesh_files_refused(path, &(mesh_hints){.cells_to_points = true}, ST_USAGE,
                       "no array of numbers of the cells, which have none");
}

static void test_not_finite(void **state) {
    (void)state;
    size_t size;
    const char *path = write_file("a.mesh", &plain, tets);
    char *bytes = scratch_read(path, &size);
    const float nan = NAN;
    memcpy(bytes + size - 3 * 16 - 5 * 16 + 3 * 12 + 4, &nan, 4);
    mesh_files_refused(scratch_write("a.mesh", bytes, size), NULL, ST_CORRUPT,
                       "a.mesh: point 3 (counted from 0) lies at (0, nan, 1)");
    free(bytes);
}

static void test_empty(void **state) {
    (void)state;
    const mesh_copy *a =
        mesh_files_good(scratch_text("b.mesh", START "tets: 0\npoints: 0\n\n"), NULL);
    assert_int_equal(a->report.points + a->report.tets, 0);
}

/* A failed write leaves no file behind, and none replaced. */
static void test_write_faults(void **state) {
    (void)state;
    static const fault_kind kinds[] = {FAULT_ALLOC, FAULT_WRITE};
    for (int i = 0; i < 2; i++) {
        const char *path = scratch_path("c.mesh");
        bool fired = true;
        for (long k = 1; fired; k++) {
            mem m;
            mem_init(&m, 0);
            (void)remove(path);
            size_t files = scratch_count();
            fault_arm(kinds[i], k);
            status st = write_mesh(&m, path, &plain, tets);
            fired = fault_fired(kinds[i]);
            fault_arm(kinds[i], 0);
            /* The folder's path, wanted for its fsync, may lack memory: no fault of the file. */
            bool done = !fired || (kinds[i] == FAULT_ALLOC && st == ST_OK);
            assert_int_equal(st == ST_OK, done);
            assert_int_equal(scratch_count(), files + done);
            assert_int_equal(mem_used(&m), 0);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_round_trip), cmocka_unit_test(test_bytes),
        cmocka_unit_test(test_left_out),   cmocka_unit_test(test_pipe),
        cmocka_unit_test(test_refused),    cmocka_unit_test(test_not_finite),
        cmocka_unit_test(test_empty),      cmocka_unit_test(test_write_faults),
        cmocka_unit_test(test_version_2),  cmocka_unit_test(test_whole_cells),
        cmocka_unit_test(test_quadratic),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
