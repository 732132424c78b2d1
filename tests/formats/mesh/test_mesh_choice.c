/* test_mesh_choice.c - which array is taken, the same in all formats: of the points; else none,
 * when there is none at all; those of the cells only when asked. And how much of a mesh has come.
 */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "formats/mesh/mesh_choice.h"
#include "formats/mesh/mesh_feed.h"
#include "tests/support/mesh_files.h"
#include "tests/support/scratch.h"

/* The arrays a file has. */
enum { OF_POINTS = 1, OF_CELLS = 2 };

/* One tet, with an array 1 2 3 4 of its points and/or 7 of the cell. */
static const char *write_vtk(int has) {
    static char text[1000];
    snprintf(text, sizeof text,
             "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n"
             "0 0 0 1 0 0 0 1 0 0 0 1\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n%s%s",
             has & OF_POINTS ? "POINT_DATA 4\nSCALARS p float\nLOOKUP_TABLE default\n1 2 3 4\n"
                             : "",
             has & OF_CELLS ? "CELL_DATA 1\nSCALARS c float\nLOOKUP_TABLE default\n7\n" : "");
    return scratch_text("t.vtk", text);
}

static const char *write_vtu(int has) {
    static char text[2000];
    snprintf(text, sizeof text,
             "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\">"
             "<UnstructuredGrid><Piece NumberOfPoints=\"4\" NumberOfCells=\"1\"><Points><DataArray "
             "type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 0 0 0 1"
             "</DataArray></Points><Cells><DataArray type=\"Int32\" Name=\"connectivity\" "
             "format=\"ascii\">0 1 2 3</DataArray><DataArray type=\"Int32\" Name=\"offsets\" "
             "format=\"ascii\">4</DataArray><DataArray type=\"UInt8\" Name=\"types\" "
             "format=\"ascii\">10</DataArray></Cells>%s%s</Piece></UnstructuredGrid></VTKFile>",
             has & OF_POINTS ? "<PointData><DataArray type=\"Float32\" Name=\"p\" format=\"ascii\">"
                               "1 2 3 4</DataArray></PointData>"
                             : "",
             has & OF_CELLS ? "<CellData><DataArray type=\"Float32\" Name=\"c\" format=\"ascii\">7"
                              "</DataArray></CellData>"
                            : "");
    return scratch_text("t.vtu", text);
}

static const char *write_gmsh(int has) {
    static char text[1000];
    snprintf(text, sizeof text,
             "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n"
             "4 0 0 1\n$EndNodes\n$Elements\n1\n1 4 0 1 2 3 4\n$EndElements\n%s%s",
             has & OF_POINTS
                 ? "$NodeData\n1\n\"p\"\n1\n0\n3\n0\n1\n4\n1 1\n2 2\n3 3\n4 4\n$EndNodeData\n"
                 : "",
             has & OF_CELLS ? "$ElementData\n1\n\"c\"\n1\n0\n3\n0\n1\n1\n1 7\n$EndElementData\n"
                            : "");
    return scratch_text("t.msh", text);
}

static const char *write_tetgen(int has) {
    char node[200], ele[100];
    bool p = has & OF_POINTS, c = has & OF_CELLS;
    snprintf(node, sizeof node, "4 3 %d 0\n1 0 0 0%s\n2 1 0 0%s\n3 0 1 0%s\n4 0 0 1%s\n", p,
             p ? " 1" : "", p ? " 2" : "", p ? " 3" : "", p ? " 4" : "");
    snprintf(ele, sizeof ele, "1 4 %d\n1 1 2 3 4%s\n", c, c ? " 7" : "");
    scratch_text("t.ele", ele);
    return scratch_text("t.node", node);
}

static const struct {
    const char *name;
    const char *(*write)(int has);
    const char *of_points, *of_cells;
} formats[] = {{"VTK", write_vtk, "p", "c"},
               {"VTU", write_vtu, "p", "c"},
               {"Gmsh", write_gmsh, "p", "c"},
               {"TetGen", write_tetgen, "attr1", "region1"}};
enum { FORMATS = sizeof formats / sizeof *formats };

static void check(const char *path, const mesh_hints *hints, const char *field, float first,
                  float last) {
    const mesh_copy *a = mesh_files_good(path, hints);
    assert_string_equal(a->report.field, field);
    assert_true(a->values[0] == first && a->values[3] == last);
}

static void test_taken(void **state) {
    (void)state;
    const mesh_hints cells = {.cells_to_points = true};
    for (int i = 0; i < FORMATS; i++) {
        print_message("%s\n", formats[i].name);
        check(formats[i].write(0), NULL, "", 0, 0);
        check(formats[i].write(OF_POINTS), NULL, formats[i].of_points, 1, 4);
        check(formats[i].write(OF_POINTS | OF_CELLS), NULL, formats[i].of_points, 1, 4);
        check(formats[i].write(OF_POINTS | OF_CELLS), &cells, formats[i].of_cells, 7, 7);
        check(formats[i].write(OF_CELLS), &cells, formats[i].of_cells, 7, 7);
    }
}

static void test_cells_alone(void **state) {
    (void)state;
    for (int i = 0; i < FORMATS; i++) {
        print_message("%s\n", formats[i].name);
        char said[200];
        snprintf(said, sizeof said,
                 "no array of numbers of the points, which have none; the cells have \"%s\" "
                 "(--cells-to-points takes them, averaged to the points)",
                 formats[i].of_cells);
        const char *path = formats[i].write(OF_CELLS);
        mesh_files_refused(path, NULL, ST_USAGE, said);
        mesh_files_refused(path, &(mesh_hints){.field = formats[i].of_cells}, ST_USAGE,
                           "(--cells-to-points takes them");
    }
}

static void test_refused(void **state) {
    (void)state;
    const mesh_hints cells = {.cells_to_points = true};
    for (int i = 0; i < FORMATS; i++) {
        print_message("%s\n", formats[i].name);
        char said[200];
        mesh_files_refused(
            formats[i].write(0), &cells, ST_USAGE,
            "no array of numbers of the cells, which have none; the points have none");
        mesh_files_refused(formats[i].write(0), &(mesh_hints){.field = "x"}, ST_USAGE,
                           "no array \"x\" of the points, which have none; the cells have none");
        mesh_files_refused(formats[i].write(0), &(mesh_hints){.component = 2}, ST_USAGE,
                           "no array of numbers of the points");
        snprintf(said, sizeof said, "of the cells, which have none; the points have \"%s\"",
                 formats[i].of_points);
        mesh_files_refused(formats[i].write(OF_POINTS), &cells, ST_USAGE, said);
        snprintf(said, sizeof said, "\"%s\" has no component 2 but 1 to 1", formats[i].of_points);
        const mesh_hints second = {.component = 2};
        mesh_files_refused(formats[i].write(OF_POINTS | OF_CELLS), &second, ST_USAGE, said);
    }
}

/* ---- how much has come ---- */

static mesh_feed feed;
static double told[100];
static int tellings;

static status tell(void) {
    assert_in_range(tellings, 0, 99);
    told[tellings++] = mesh_feed_share(&feed);
    return ST_OK;
}

static status tell_points(void *ctx, uint64_t first, size_t count, const float (*xyz)[3]) {
    (void)ctx, (void)first, (void)count, (void)xyz;
    return tell();
}

static status tell_values(void *ctx, uint64_t first, size_t count, const float *v) {
    (void)ctx, (void)first, (void)count, (void)v;
    return tell();
}

static status tell_tets(void *ctx, size_t count, const uint32_t (*ids)[4]) {
    (void)ctx, (void)count, (void)ids;
    return tell();
}

/* Four chunks of points, of values and of cells: 12, 4 and 16 bytes each. */
static void test_share(void **state) {
    (void)state;
    enum { COUNT = 4 * MESH_FEED_CHUNK };
    static const uint32_t id[1][4] = {{0, 1, 2, 3}};
    for (int known = 0; known < 2; known++) {
        mem m;
        mesh_report report;
        const mesh_sink sink = {NULL, tell_points, tell_values, tell_tets, NULL, NULL, NULL, false};
        mem_init(&m, 0);
        tellings = 0;
        assert_int_equal(mesh_feed_begin(&feed, &m, "a", 1, &sink, &report), ST_OK);
        assert_int_equal(mesh_feed_expect(&feed, COUNT), ST_OK);
        if (known)
            mesh_feed_expect_cells(&feed, COUNT);
        for (int i = 0; i < COUNT; i++)
            assert_int_equal(mesh_feed_point(&feed, (double[3]){0}), ST_OK);
        assert_int_equal(mesh_feed_zeros(&feed), ST_OK);
        for (int i = 0; i < COUNT; i++)
            assert_int_equal(mesh_feed_tets(&feed, id, 1), ST_OK);
        assert_int_equal(mesh_feed_end(&feed), ST_OK);
        assert_int_equal(tellings, 12);
        for (int i = 0; i < 12; i++) {
            double bytes = i < 4 ? 12 * (i + 1) : i < 8 ? 48 + 4 * (i - 3) : 64 + 16 * (i - 7);
            assert_true(fabs(told[i] - bytes / (known ? 128 : 64 + 5 * 64)) < 1e-12);
        }
        mesh_feed_release(&feed);
    }
}

/* Each name once, and a long list is cut behind a whole name. */
static void test_names(void **state) {
    (void)state;
    name_list names = {0};
    name_list_add(&names, "b");
    name_list_add(&names, "b");
    name_list_add(&names, "a b");
    assert_string_equal(names.text, "\"b\", \"a b\"");
    char last[20];
    for (int i = 100; i < 200; i++) {
        snprintf(last, sizeof last, "name%d", i);
        name_list_add(&names, last);
    }
    assert_true(strlen(names.text) < sizeof names.text);
    assert_true(strlen(names.text) > sizeof names.text - 20);
    assert_string_equal(names.text + strlen(names.text) - 5, "\", ..");
    names = (name_list){0};
    char huge[2 * NAME_LIST_TEXT];
    memset(huge, 'x', sizeof huge);
    huge[sizeof huge - 1] = 0;
    name_list_add(&names, huge);
    assert_string_equal(names.text, ", ..");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_taken),   cmocka_unit_test(test_cells_alone),
        cmocka_unit_test(test_refused), cmocka_unit_test(test_names),
        cmocka_unit_test(test_share),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
