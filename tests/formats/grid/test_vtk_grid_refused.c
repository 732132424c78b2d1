/* test_vtk_grid_refused.c - VTK files of grids that are refused, by line or byte: structure,
 * pieces, arrays that are not there, claims that no file of that size can keep. */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/support/scratch.h"
#include "tests/support/volumes.h"
#include "tests/support/vtk_files.h"
#include "tests/support/vtk_grid_files.h"

#define IN_TEXT ((vtk_xml_style){.text = true})

static void refused(const char *path, const char *from, const char *to, status st,
                    const char *said) {
    volumes_refused(vtk_files_patch(path, from, to), NULL, st, said);
}

static void test_structure(void **state) {
    (void)state;
    vtk_grid_style g = {.xml = IN_TEXT};
    const char *a = vtk_grid_files_xml("a.vti", &g);
    refused(a, "<VTKFile type", "<File type", ST_CORRUPT, "line 2: <File>, expected <VTKFile>");
    refused(a, "type=\"ImageData\" ", "", ST_CORRUPT, "ImageData is supported");
    refused(a, "\"ImageData\"", "\"PolyData\"", ST_UNSUPPORTED,
            "this is VTK surface data, which is not read here");
    refused(a, "\"ImageData\"", "\"StructuredGrid\"", ST_CORRUPT, "expected the points of a piece");
    refused(a, "\"ImageData\"", "\"RectilinearGrid\"", ST_CORRUPT, "expected the x coordinates");
    refused(a, "<ImageData WholeExtent", "<ImageDatum WholeExtent", ST_CORRUPT, "mismatched tag");
    refused(a, "WholeExtent", "Extent", ST_CORRUPT, "line 3: expected the attribute WholeExtent");
    refused(a, "0 3 0 2 0 1\" >", "0 3 0 2 0\" >", ST_CORRUPT, "expected 6 numbers");
    refused(a, "0 3 0 2 0 1\" >", "0 3 0 2 0 1.5\" >", ST_CORRUPT, "expected 6 whole numbers");
    refused(a, "0 3 0 2 0 1\" >", "0 3 0 2 0 1e10\" >", ST_CORRUPT, "expected 6 whole numbers");
    refused(a, "0 3 0 2 0 1\" >", "0 3 0 2 1 0\" >", ST_CORRUPT, "whole extent is empty");
    refused(a, "0 3 0 2 0 1\" >", "0 3 0 2 0 1\" Spacing=\"1 2\" >", ST_CORRUPT,
            "Spacing=\"1 2\", expected 3 numbers");
    refused(a, "0 3 0 2 0 1\" >", "0 3 0 2 0 1\" Spacing=\"1 0 1\" >", ST_CORRUPT, "a.vti");
    refused(a, "0 3 0 2 0 1\" >", "0 3 0 2 0 1\" Direction=\"1 2 3\" >", ST_CORRUPT,
            "expected 9 numbers");
    refused(a, "<Piece", "<Part", ST_CORRUPT, "mismatched tag");
    refused(a, "<Piece Extent", "<Piece Extend", ST_CORRUPT, "expected the attribute Extent");
    refused(a, "</ImageData>", "</ImageData><ImageData/>", ST_CORRUPT, "the grid comes twice");
    refused(a, "-50 ", "", ST_CORRUPT, "has 23 numbers, expected 24");
    refused(a, "-50 ", "-50 -50 ", ST_CORRUPT, "behind its last number, expected 24");
    refused(a, "\"Float32\" Name=\"s\"", "\"Half\" Name=\"s\"", ST_CORRUPT, "type=\"Half\"");
    refused(a, "?>", "?><!DOCTYPE a [<!ENTITY b \"c\">]>", ST_UNSUPPORTED, "document type");
    volumes_refused(scratch_text("b.vti", ""), NULL, ST_CORRUPT, "");
    volumes_refused(scratch_text("b.vti", "<VTKFile type='ImageData'/>"), NULL, ST_CORRUPT,
                    "expected an element ImageData");
    volumes_refused(scratch_text("b.vti", "nonsense"), NULL, ST_CORRUPT, "line 1");
    /* A slice alone is no volume. */
    char flat[400];
    snprintf(
        flat, sizeof flat,
        "<VTKFile type='ImageData'><ImageData WholeExtent='0 1 0 1 0 0'><Piece Extent='0 1 0 1 "
        "0 0'><PointData><DataArray type='Int8' Name='a'>1 2 3 4</DataArray></PointData>"
        "</Piece></ImageData></VTKFile>");
    volumes_refused(scratch_text("b.vti", flat), NULL, ST_UNSUPPORTED, "b.vti");
    /* Nor is a layer of cells, or none. */
    g.of_cells = true;
    a = vtk_grid_files_xml("a.vti", &g);
    a = vtk_files_patch(a, "WholeExtent=\"0 4 0 3 0 2\"", "WholeExtent=\"0 4 0 3 1 1\"");
    refused(a, "Extent=\"0 4 0 3 0 2\"", "Extent=\"0 4 0 3 1 1\"", ST_UNSUPPORTED, "a.vti");
}

static void test_choice(void **state) {
    (void)state;
    vtk_grid_style g = {.xml = IN_TEXT, .of_cells = true, .both = true};
    const char *a = vtk_grid_files_xml("a.vti", &g);
    volumes_refused(a, &(volume_hints){.field = "t"}, ST_USAGE,
                    "no array \"t\"; the points have \"p\", the cells \"s\", \"v\", \"rgb\"");
    volumes_refused(a, &(volume_hints){.field = "v", .component = 4}, ST_USAGE, "no component 4");
    volumes_refused(a, &(volume_hints){.field = "s", .step = 1}, ST_USAGE, "no step 1");
    g = (vtk_grid_style){.xml = IN_TEXT};
    a = vtk_grid_files_xml("a.vti", &g);
    const char *b = vtk_files_patch(a, "\"Float32\" Name=\"s\"", "\"String\" Name=\"s\"");
    volumes_refused(b, &(volume_hints){.field = "s"}, ST_UNSUPPORTED, "strings and packed bits");
    b = vtk_files_patch(a, "<PointData Scalars=\"s\">", "<Other>");
    b = vtk_files_patch(b, "</PointData>", "</Other>");
    volumes_refused(b, NULL, ST_UNSUPPORTED, "no array of numbers; the points have none");
    /* As for meshes: names are the same that agree so far as a file keeps them. */
    volumes_check(a, &(volume_hints){.field = "s"}, SAMPLE_F32, NULL);
}

static void test_rectilinear_refused(void **state) {
    (void)state;
    const vtk_grid_style g = {.xml = IN_TEXT, .rectilinear = true};
    const char *a = vtk_grid_files_xml("a.vtr", &g);
    refused(a, "<Coordinates>", "<Coordinate>", ST_CORRUPT, "mismatched tag");
    refused(a, "\n0 0.75 2 3.75", "\n0 0.75 2", ST_CORRUPT, "x coordinates: has 3 numbers");
    refused(a, "\n0 0.75 2 3.75", "\n0 0.75 0.75 3.75", ST_CORRUPT,
            "coordinate 2 along x is 0.75, which does not go on upwards");
    refused(a, "\n0 0.75 2 3.75", "\n0 nan 2 3.75", ST_CORRUPT, "not finite");
    refused(a, "</Coordinates>", "<DataArray type=\"Int8\">1</DataArray></Coordinates>", ST_CORRUPT,
            "coordinates of more than three axes");
    refused(a, "\"Float64\" Name=\"\" NumberOfComponents=\"1\"",
            "\"Float64\" Name=\"\" NumberOfComponents=\"2\"", ST_CORRUPT,
            "2 components, expected 1");
    volumes_check(vtk_files_patch(a, "\n0 0.75 2 3.75", "\n9 7 5 3"), NULL, SAMPLE_F32,
                  (const double[3][4]){{-1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}});
}

static void test_legacy_refused(void **state) {
    (void)state;
    vtk_grid_style g = {.xml = {.text = true}};
    const char *a = vtk_grid_files_legacy("a.vtk", &g, 3, 0);
    refused(a, "3.0", "6.0", ST_UNSUPPORTED, "version 6; 1.0 to 5.1 are supported");
    refused(a, "ASCII", "TEXT", ST_CORRUPT, "byte 34: expected ASCII or BINARY");
    refused(a, "STRUCTURED_POINTS", "POLYDATA", ST_UNSUPPORTED, "this is legacy VTK surface data");
    refused(a, "STRUCTURED_POINTS", "STRUCTURED_GRID", ST_CORRUPT,
            "expected the points of a piece");
    refused(a, "DIMENSIONS 4 3 2\n", "", ST_CORRUPT, "POINT_DATA of 24, expected 0");
    refused(a, "DIMENSIONS 4 3 2", "DIMENSIONS 4 3", ST_CORRUPT,
            "expected \"DIMENSIONS nx ny nz\"");
    refused(a, "DIMENSIONS 4 3 2", "DIMENSIONS 4 3 2000000", ST_CORRUPT, "expected the nodes");
    refused(a, "DIMENSIONS 4 3 2", "DIMENSIONS 4 3 0", ST_CORRUPT, "\"0\", expected the nodes");
    refused(a, "DIMENSIONS 4 3 2", "DIMENSIONS 4 3 2\nEXTENT 0 3 0 2 0 1", ST_CORRUPT,
            "EXTENT comes twice");
    refused(a, "DIMENSIONS 4 3 2", "EXTENT 0 3 0 2 1 0", ST_CORRUPT, "\"0\", expected the index");
    refused(a, "DIMENSIONS 4 3 2", "DIMENSIONS 4 3 2\nSPACING 1 2 x", ST_CORRUPT,
            "SPACING: \"x\", expected a number");
    refused(a, "DIMENSIONS 4 3 2", "DIMENSIONS 4 3 2\nSPACING 1 2 0", ST_CORRUPT, "a.vtk");
    refused(a, "DIMENSIONS 4 3 2", "DIMENSIONS 4 3 2\nPOINTS 1 float\n0 0 0", ST_CORRUPT,
            "\"POINTS\", expected a keyword of the format, as DIMENSIONS");
    refused(a, "POINT_DATA 24", "POINT_DATA 23", ST_CORRUPT, "POINT_DATA of 23, expected 24");
    refused(a, "POINT_DATA 24", "CELL_DATA 24", ST_CORRUPT, "CELL_DATA of 24, expected 6");
    refused(a, "\n-50 ", "\n-50x ", ST_CORRUPT, "\"-50x\", expected a number of its type");
    char *data = scratch_read(a, NULL);
    *strstr(data, "DIMENSIONS") = 0;
    volumes_refused(scratch_text("b.vtk", data), NULL, ST_CORRUPT, "without DIMENSIONS");
    free(data);
    g.rectilinear = true;
    a = vtk_grid_files_legacy("a.vtk", &g, 3, 0);
    refused(a, "X_COORDINATES 4", "X_COORDINATES 5", ST_CORRUPT,
            "expected as many as there are nodes");
    refused(a, "X_COORDINATES 4", "Y_COORDINATES 4", ST_CORRUPT,
            "expected as many as there are nodes");
    refused(a, "Z_COORDINATES", "X_COORDINATES", ST_CORRUPT, "X_COORDINATES comes twice");
    refused(a, "X_COORDINATES 4 double", "X_COORDINATES 4 string", ST_CORRUPT, "byte");
}

/* What a head claims is held against the file before anybody makes room for it. */
static void test_claims(void **state) {
    (void)state;
    static const struct {
        const char *coding, *said;
    } cases[] = {
        {"format=\"appended\" offset=\"0\"", "too early for the"},
        {"format=\"ascii\"", "numbers, expected 1073741824"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[700];
        int length = snprintf(
            text, sizeof text,
            "<VTKFile type='ImageData' header_type='UInt64'><ImageData WholeExtent='0 1023 "
            "0 1023 0 1023'><Piece Extent='0 1023 0 1023 0 1023'><PointData><DataArray "
            "type='UInt8' Name='a' %s>1</DataArray></PointData></Piece></ImageData>"
            "<AppendedData encoding='raw'>_",
            cases[i].coding);
        const uint64_t claim = (uint64_t)1 << 30;
        memcpy(text + length, &claim, sizeof claim);
        volumes_refused(scratch_write("b.vti", text, (size_t)length + sizeof claim), NULL,
                        ST_CORRUPT, cases[i].said);
    }
}

static void test_pipe(void **state) {
    (void)state;
    const vtk_grid_style g = {.xml = IN_TEXT};
    const char *a = vtk_grid_files_xml("a.vti", &g);
    int kept = dup(STDIN_FILENO);
    assert_non_null(freopen(a, "rb", stdin));
    volumes_refused("-", NULL, ST_UNSUPPORTED, "standard input: VTK files are read at several");
    dup2(kept, STDIN_FILENO);
    close(kept);
}

static void test_pieces_refused(void **state) {
    (void)state;
    vtk_grid_style g = {.xml = IN_TEXT, .cuts = 1};
    const char *a = vtk_grid_files_xml("a.vti", &g);
    static const struct {
        const char *from, *to, *said;
    } cases[] = {
        /* The second piece goes from 2 to 3. */
        {"Extent=\"2 3 0 2 0 1\"", "Extent=\"2 4 0 2 0 1\"", "reaches out of the whole extent"},
        {"Extent=\"2 3 0 2 0 1\"", "Extent=\"3 3 0 2 0 1\"", "behind its last number, expected 6"},
        {"WholeExtent=\"0 3", "WholeExtent=\"0 5", "do not fill the whole extent"},
        {"Name=\"s\" NumberOfComponents=\"1\"", "Name=\"t\" NumberOfComponents=\"1\"",
         "a piece has no array \"t\", unlike others"},
        {"\"Float32\" Name=\"s\"", "\"Float64\" Name=\"s\"", "another type"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        volumes_refused(vtk_files_patch(a, cases[i].from, cases[i].to), NULL, ST_CORRUPT,
                        cases[i].said);
    const char *p = vtk_grid_files_parallel("a.pvti", &g);
    volumes_refused(vtk_files_patch(p, "Extent=\"2 3 0 2 0 1\"", "Extent=\"2 2 0 2 0 1\""), NULL,
                    ST_CORRUPT, "piece 1.vti: its extent is not the one that");
    volumes_refused(vtk_files_patch(p, "Source=\"piece 1.vti\"", ""), NULL, ST_CORRUPT,
                    "expected the attribute Source");
    volumes_refused(vtk_files_patch(p, "piece 1.vti", "piece 0.vti"), NULL, ST_CORRUPT,
                    "its extent is not the one");
    volumes_refused(vtk_files_patch(p, "piece 1.vti", "gone.vti"), NULL, ST_IO, "gone.vti");
    volumes_refused(vtk_files_patch(p, "piece 1.vti", "x-a.pvti"), NULL, ST_UNSUPPORTED,
                    "a VTKFile of type \"PImageData\"; ImageData is supported");
    /* A hole, though there are numbers enough. */
    static const char hole[] =
        "<VTKFile type='ImageData'><ImageData WholeExtent='0 1 0 1 0 2'>\n"
        "<Piece Extent='0 1 0 1 0 1'><PointData><DataArray type='Int8' Name='a'>1 2 3 4 5 6 7 8"
        "</DataArray></PointData></Piece>\n"
        "<Piece Extent='0 0 0 1 1 2'><PointData><DataArray type='Int8' Name='a'>5 7 9 9"
        "</DataArray></PointData></Piece></ImageData></VTKFile>";
    volumes_refused(scratch_text("b.vti", hole), NULL, ST_CORRUPT,
                    "no piece has the sample at 1 0 2");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pieces_refused), cmocka_unit_test(test_structure),
        cmocka_unit_test(test_choice),         cmocka_unit_test(test_rectilinear_refused),
        cmocka_unit_test(test_legacy_refused), cmocka_unit_test(test_claims),
        cmocka_unit_test(test_pipe),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
