/* test_mesh_tetgen.c - .node and .ele: counting from 0 and 1, attributes, markers, comments;
 * refusals that name the line, cut and damaged files, a real mesh.
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

static const float xyz[5][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0.1f}};
static const uint32_t tets[2][4] = {{0, 1, 2, 3}, {4, 3, 2, 1}};

#define NODE                                                  \
    "# five points\n5  3  2  1\n"                             \
    "1 0 0 0  0.5 10 -1\n2\t1.0 0 0  1.5 20 0 # the second\n" \
    "\n3 0 1 0  2.5 30 1\r\n4 0, 0, 1  3.5 nan 2\n5 1e0 1 0.1  4.5 50 3\n# the end\n"
#define ELE  "2 4 2\n1 1 2 3 4  7 -1\n2  5 4 3 2  8 -3\n# the end"
#define BARE "1 4 0\n1 1 2 3 4\n" /* no attributes */

static const char *write_pair(const char *node, const char *ele) {
    scratch_text("a.ele", ele);
    return scratch_text("a.node", node);
}

static void check_shape(const mesh_copy *a) {
    assert_int_equal(a->report.points, 5);
    assert_int_equal(a->report.tets, 2);
    assert_int_equal(a->report.bad_indices + a->report.repeated + a->report.skipped, 0);
    assert_string_equal(a->name, "");
    assert_memory_equal(a->xyz, xyz, sizeof xyz);
    assert_memory_equal(a->tets, tets, sizeof tets);
}

static void check_field(const char *path, const mesh_hints *hints, const char *field,
                        const float want[5]) {
    const mesh_copy *a = mesh_files_good(path, hints);
    check_shape(a);
    assert_string_equal(a->report.field, field);
    for (int i = 0; i < 5; i++)
        if (!(a->values[i] == want[i]) && !(isnan(a->values[i]) && isnan(want[i])))
            fail_msg("%s: value %d is %g, not %g", field, i, (double)a->values[i], (double)want[i]);
}

static void test_fields(void **state) {
    (void)state;
    const float first[5] = {0.5f, 1.5f, 2.5f, 3.5f, 4.5f}, second[5] = {10, 20, 30, NAN, 50};
    const float marker[5] = {-1, 0, 1, 2, 3}, region[5] = {7, 7.5f, 7.5f, 7.5f, 8};
    const float region2[5] = {-1, -2, -2, -2, -3};
    const char *node = write_pair(NODE, ELE), *ele = scratch_path("a.ele");
    assert_true(mesh_files_recognised(node) && mesh_files_recognised(ele));
    check_field(node, NULL, "attr1", first);
    check_field(ele, NULL, "attr1", first);
    check_field(node, &(mesh_hints){.field = "attr2"}, "attr2", second);
    check_field(node, &(mesh_hints){.field = "2", .component = 1}, "attr2", second);
    check_field(ele, &(mesh_hints){.field = "marker"}, "marker", marker);
    check_field(node, &(mesh_hints){.cells_to_points = true}, "region1", region);
    check_field(node, &(mesh_hints){.field = "region", .cells_to_points = true}, "region1", region);
    check_field(ele, &(mesh_hints){.field = "region2", .cells_to_points = true}, "region2",
                region2);
}

static void test_counting_from_0(void **state) {
    (void)state;
    const float zeros[5] = {0};
    /* Headers may say less; ids of tets count on their own. */
    const char *path = write_pair("5\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n4 1 1 .1\n",
                                  "2\n1 0 1 2 3\n2 4 3 2 1\n");
    check_field(path, NULL, "", zeros);
    assert_string_equal(scratch_path("a.node"), path);
}

static void test_left_out(void **state) {
    (void)state;
    const char *path = write_pair(NODE, "6 4 0\n0 1 2 3 0\n1 1 2 3 6\n2 5 4 3 2\n3 1 1 2 3\n"
                                        "4 -9223372036854775808 1 2 3\n5 1 2 3 4294967297\n");
    const mesh_copy *a = mesh_files_good(path, NULL);
    assert_int_equal(a->report.tets, 1);
    assert_int_equal(a->report.bad_indices, 4);
    assert_int_equal(a->report.repeated, 1);
}

static void test_lonely_point(void **state) {
    (void)state;
    const char *path = write_pair(NODE, "1 4 1\n1 1 2 3 4 7\n");
    const mesh_copy *a = mesh_files_good(path, &(mesh_hints){.cells_to_points = true});
    assert_true(a->values[3] == 7 && isnan(a->values[4]));
}

static void test_refused(void **state) {
    (void)state;
    static const struct {
        const char *node, *ele;
        status st;
        const char *said;
    } cases[] = {
        {"", BARE, ST_CORRUPT, "a.node: line 1: nothing more here, expected the number of points"},
        {"x", BARE, ST_CORRUPT, "a.node: line 1: \"x\", expected the number of points"},
        {"-1", BARE, ST_CORRUPT, "a.node: line 1: \"-1\""},
        {"4294967295 3", BARE, ST_CORRUPT, "expected the number of points"},
        {"5 2 0 0\n", BARE, ST_UNSUPPORTED, "a.node: points of 2 dimensions"},
        {"5 3 -1 0\n", BARE, ST_CORRUPT, "expected the number of attributes"},
        {"5 3 0 2\n", BARE, ST_CORRUPT, "expected the number of markers"},
        {"5 3 0 0 0\n", BARE, ST_CORRUPT, "expected the end of the line"},
        {"1 3 0 0\n2 0 0 0\n", BARE, ST_CORRUPT, "line 2: \"2\", expected 0 or 1"},
        {"2 3 0 0\n1 0 0 0\n3 0 0 0\n", BARE, ST_CORRUPT, "line 3: \"3\", expected id 2"},
        {"2 3 0 0\n1 0 0 0\n", BARE, ST_CORRUPT, "line 3: nothing more here, expected an id"},
        {"1 3 0 0\n1 0 0\n2", BARE, ST_CORRUPT, "line 2: nothing more here, expected a coordinate"},
        {"1 3 0 0\n1 0 zero 0\n", BARE, ST_CORRUPT, "line 2: \"zero\", expected a coordinate"},
        {"1 3 0 0\n1 0 nan 0\n", BARE, ST_CORRUPT, "point 0 (counted from 0) lies at (0, nan, 0)"},
        {"1 3 0 0\n1 0 1e39 0\n", BARE, ST_CORRUPT, "point 0 (counted from 0) lies at (0, inf, 0)"},
        {"1 3 0 0\n1 0 0 0 0\n", BARE, ST_CORRUPT, "line 2: \"0\", expected the end of the line"},
        {"1 3 1 0\n1 0 0 0\n", BARE, ST_CORRUPT,
         "line 2: nothing more here, expected an attribute"},
        {"1 3 0 0\n1 0 0 0\n2 0 0 0\n", BARE, ST_CORRUPT, "line 3: \"2\", expected the end: "},
        {NODE, "", ST_CORRUPT, "a.ele: line 1: nothing more here, expected the number of tets"},
        {NODE, "1 10 0\n", ST_UNSUPPORTED, "a.ele: tets of 10 nodes, expected 4"},
        {NODE, "1 4 0\n1 1 2 3", ST_CORRUPT, "a.ele: line 2: nothing more here, expected the id"},
        {NODE, "1 4 0\n1 1 2 3 4.5", ST_CORRUPT, "a.ele: line 2: \"4.5\", expected the id"},
        {NODE, "1 4 0\n1 1 2 3 4 5", ST_CORRUPT, "a.ele: line 2: \"5\", expected the end"},
        {NODE, "1 4 0\n5 1 2 3 4", ST_CORRUPT, "a.ele: line 2: \"5\", expected 0 or 1"},
        {NODE, "1 4 0\n1 1 2 3 4\n2 1 2 3 5\n", ST_CORRUPT,
         "a.ele: line 3: \"2\", expected the end"},
        {NODE, "9223372036854775808 4 0\n", ST_CORRUPT, "a.ele: line 1"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        mesh_files_refused(write_pair(cases[i].node, cases[i].ele), NULL, cases[i].st,
                           cases[i].said);
}

static void test_refused_hints(void **state) {
    (void)state;
    const char *path = write_pair(NODE, ELE);
    mesh_files_refused(path, &(mesh_hints){.field = "attr3"}, ST_USAGE,
                       "a.node: no array \"attr3\" of the points, which have \"attr1\", \"attr2\", "
                       "\"marker\"; the cells have \"region1\", \"region2\" (--cells-to-points");
    mesh_files_refused(path, &(mesh_hints){.field = "speed"}, ST_USAGE, "no array \"speed\"");
    mesh_files_refused(path, &(mesh_hints){.component = 2}, ST_USAGE,
                       "\"attr1\" has no component 2 but 1 to 1");
    mesh_files_refused(path, &(mesh_hints){.field = "marker", .component = 2}, ST_USAGE,
                       "\"marker\" has no component 2");
    mesh_files_refused(path, &(mesh_hints){.field = "attr1", .cells_to_points = true}, ST_USAGE,
                       "a.ele: no array \"attr1\" of the cells");
    (void)remove(scratch_path("a.ele"));
    mesh_files_refused(path, NULL, ST_IO, "a.ele");
    static const char nul[] = "1 3 0 0\n1 0 0\0 0\n";
    scratch_text("a.ele", BARE);
    mesh_files_refused(scratch_write("a.node", nul, sizeof nul - 1), NULL, ST_CORRUPT,
                       "a.node: line 2: no text at byte");
}

static void test_sweeps(void **state) {
    (void)state;
    const char *node = write_pair(NODE, ELE), *ele = scratch_path("a.ele");
    const mesh_hints cells = {.cells_to_points = true};
    mesh_files_faults(node, NULL);
    mesh_files_faults(ele, &cells);
    assert_true(mesh_files_damage(node, NULL) > 0);
    assert_true(mesh_files_damage(ele, &cells) > 0);
    mesh_files_truncate(node, NULL,
                        sizeof "3\n# the end\n"); /* a shorter last marker is one, too */
    mesh_files_truncate(ele, NULL, sizeof "3\n# the end");
}

/* A long file: the words cross the buffer's end at all places. */
static void test_long(void **state) {
    (void)state;
    enum { POINTS = 20000 };
    char *text = malloc((size_t)POINTS * 60);
    int n = sprintf(text, "%d 3 1 0\n", POINTS);
    for (int i = 0; i < POINTS; i++)
        n += sprintf(text + n, "%d %.*f %d.25 -%d %d\n", i, i % 17, i / 8.0, i, i, 3 * i);
    scratch_text("l.node", text);
    n = sprintf(text, "%d 4\n", POINTS - 3);
    for (int i = 0; i < POINTS - 3; i++)
        n += sprintf(text + n, "%d %d %d %d %d\n", i, i, i + 1, i + 2, i + 3);
    const mesh_copy *a = mesh_files_good(scratch_text("l.ele", text), NULL);
    free(text);
    assert_int_equal(a->report.points, POINTS);
    assert_int_equal(a->report.tets, POINTS - 3);
    for (uint32_t i = 0; i < POINTS; i++) {
        assert_true(a->xyz[i][1] == (float)i + 0.25f && a->xyz[i][2] == -(float)i);
        assert_true(a->values[i] == 3 * (float)i);
        if (i < POINTS - 3)
            assert_int_equal(a->tets[i][3], i + 3);
    }
}

static void test_real(void **state) {
    (void)state;
    const char *node = mesh_files_stage("tetgen_node_ele", "input.1.node");
    if (!node || !mesh_files_stage("tetgen_node_ele", "input.1.ele")) {
        print_message("# no tetgen_node_ele in the data folder\n");
        skip();
    }
    const mesh_copy *a = mesh_files_good(node, NULL);
    assert_int_equal(a->report.points, 12965);
    assert_int_equal(a->report.tets, 57862);
    assert_int_equal(a->report.bad_indices + a->report.repeated, 0);
    assert_string_equal(a->name, "");
    assert_true(a->xyz[0][0] == 28.8506055f && a->xyz[12964][2] == 63.391967246361396f);
    const uint32_t last[4] = {2287, 2323, 5577, 12964};
    assert_memory_equal(a->tets[57861], last, sizeof last);
    assert_true(mesh_files_closed(a));
    double all, sum = mesh_files_volume(a, &all);
    assert_true(fabs(fabs(sum) - all) < 1e-9 * all); /* TetGen orients its tets alike */
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_fields),   cmocka_unit_test(test_counting_from_0),
        cmocka_unit_test(test_left_out), cmocka_unit_test(test_lonely_point),
        cmocka_unit_test(test_refused),  cmocka_unit_test(test_refused_hints),
        cmocka_unit_test(test_sweeps),   cmocka_unit_test(test_long),
        cmocka_unit_test(test_real),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
