/* test_vtk_grid.c - VTK files of grids, XML and legacy: every coding, type and compressor; pieces
 * in one file and in several; points and cells; refusals that name line or byte; cut and damaged
 * files; faults; memory that does not grow.
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
#include <unistd.h>

#include "tests/support/scratch.h"
#include "tests/support/volumes.h"
#include "tests/support/vtk_files.h"
#include "tests/support/vtk_grid_files.h"

/* ---- what is read ---- */

static const vtk_xml_style codings[] = {
    {.text = true},
    {.block = 0},
    {.split_head = true, .head64 = true},
    {.block = 64},
    {.block = 48, .head64 = true, .big_endian = true},
    {.block = 32, .packing = VTK_WRITER_LZ4},
    {.block = 64, .packing = VTK_WRITER_LZMA, .head64 = true},
    {.appended = true},
    {.appended = true, .block = 4096, .head64 = true},
    {.appended = true, .block = 16, .packing = VTK_WRITER_LZ4, .big_endian = true},
    {.appended = true, .raw = true, .big_endian = true},
    {.appended = true, .raw = true, .head64 = true},
    {.appended = true, .raw = true, .block = 24},
    {.appended = true, .raw = true, .block = 100, .head64 = true, .big_endian = true},
    {.appended = true, .raw = true, .block = 32, .packing = VTK_WRITER_LZ4, .head64 = true},
    {.appended = true, .raw = true, .block = 40, .packing = VTK_WRITER_LZMA},
};

enum { CODINGS = sizeof codings / sizeof *codings };

static const struct {
    const char *name;
    sample_type type; /* as it is read */
} types[] = {
    {"Int8", SAMPLE_I8},     {"UInt8", SAMPLE_U8},    {"Int16", SAMPLE_I16},
    {"UInt16", SAMPLE_U16},  {"Int32", SAMPLE_I32},   {"UInt32", SAMPLE_U32},
    {"Float32", SAMPLE_F32}, {"Float64", SAMPLE_F64}, {"Int64", SAMPLE_F64},
};

enum { TYPES = sizeof types / sizeof *types };

static void test_codings(void **state) {
    (void)state;
    for (int i = 0; i < CODINGS; i++)
        for (int t = 0; t < TYPES; t++) {
            const vtk_grid_style g = {.xml = codings[i], .type = types[t].name};
            volumes_check(vtk_grid_files_xml("a.vti", &g), NULL, types[t].type, NULL);
        }
}

static void test_legacy(void **state) {
    (void)state;
    static const int versions[][2] = {{2, 0}, {3, 0}, {4, 2}, {5, 1}};
    for (int i = 0; i < 8; i++)
        for (int t = 0; t < TYPES; t++) {
            const vtk_grid_style g = {.xml = {.text = i % 2}, .type = types[t].name};
            const char *path =
                vtk_grid_files_legacy("a.vtk", &g, versions[i / 2][0], versions[i / 2][1]);
            volumes_check(path, NULL, types[t].type, NULL);
        }
}

/* The samples of a field as doubles. */
static void read_field(const char *path, const volume_hints *hints, double out[VOLUMES_SAMPLES]) {
    grid g;
    double samples[VOLUMES_SAMPLES];
    if (volumes_read(path, hints, &g, samples) != ST_OK)
        fail_msg("%s", status_text());
    assert_int_equal(sample_to_doubles(g.type, samples, out, VOLUMES_SAMPLES), VOLUMES_SAMPLES);
}

static void check_fields(const char *path) {
    static const struct {
        const char *field;
        uint32_t component;
        double times;
    } cases[] = {{"v", 0, 13},  {"v", 1, 3},   {"v", 2, 4}, {"v", 3, 12},
                 {"rgb", 0, 1}, {"rgb", 3, 1}, {"s", 1, 7}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double got[VOLUMES_SAMPLES];
        const volume_hints hints = {.field = cases[i].field, .component = cases[i].component};
        read_field(path, &hints, got);
        for (int n = 0; n < VOLUMES_SAMPLES; n++)
            if (fabs(got[n] - cases[i].times * n) > 1e-6 * n)
                fail_msg("%s: field %s, component %u, sample %d: %g", path, cases[i].field,
                         cases[i].component, n, got[n]);
    }
}

static void test_fields(void **state) {
    (void)state;
    vtk_grid_style g = {.type = "UInt64", .both = false};
    for (int i = 0; i < CODINGS; i++) {
        g.xml = codings[i];
        g.of_cells = i % 2;
        check_fields(vtk_grid_files_xml("a.vti", &g));
        g.xml.text = i % 2;
        check_fields(vtk_grid_files_legacy("a.vtk", &g, 3, 0));
    }
    /* Points before cells; what parts of a parallel grid say of themselves is no field. */
    g = (vtk_grid_style){.xml = codings[0], .of_cells = true, .both = true};
    const char *path = vtk_grid_files_xml("a.vti", &g);
    grid got;
    double samples[VOLUMES_SAMPLES];
    assert_int_equal(volumes_read(path, NULL, &got, samples), ST_FAILED); /* 5 x 4 x 3 nodes */
    volumes_check(path, &(volume_hints){.field = "s"}, SAMPLE_F32,
                  (const double[3][4]){{1, 0, 0, 0.5}, {0, 1, 0, 0.5}, {0, 0, 1, 0.5}});
    g = (vtk_grid_style){.xml = codings[0]};
    path = vtk_files_patch(vtk_grid_files_xml("a.vti", &g), "<PointData Scalars=\"s\">",
                           "<PointData><DataArray type=\"UInt8\" Name=\"vtkGhostType\">0"
                           "</DataArray>");
    volumes_check(path, NULL, SAMPLE_F32, NULL);
}

static void test_large_numbers(void **state) {
    (void)state;
    vtk_grid_style g = {.xml = codings[0], .type = "Int64"};
    const char *path = vtk_grid_files_xml("a.vti", &g);
    double got[VOLUMES_SAMPLES];
    read_field(vtk_files_patch(path, "-43", "-9007199254740992"), NULL, got);
    assert_true(got[1] == -9007199254740992.0);
    volumes_refused(vtk_files_patch(path, "-43", "-9007199254740993"), NULL, ST_UNSUPPORTED,
                    "beyond 2^53");
    g.type = "UInt64";
    path = vtk_grid_files_xml("a.vti", &g);
    volumes_refused(vtk_files_patch(path, "\n0 7 ", "\n0 18446744073709551615 "), NULL,
                    ST_UNSUPPORTED, "beyond 2^53");
}

/* Text that is no number of its type. */
static void test_text(void **state) {
    (void)state;
    static const struct {
        const char *type, *word;
    } bad[] = {{"Int8", "128"},        {"Int8", "-129"},    {"UInt8", "-1"},   {"UInt8", "256"},
               {"Int16", "1.5"},       {"UInt16", "65536"}, {"Int32", "nan"},  {"UInt32", "x"},
               {"Int64", "1e3"},       {"UInt64", "-1"},    {"Float32", "1,"}, {"Float64", "--1"},
               {"Int32", "2147483648"}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        const vtk_grid_style g = {.xml = codings[0], .type = bad[i].type};
        char to[40], said[60];
        const char *first = *bad[i].type == 'U' ? "\n0 7 " : "\n-50 ";
        snprintf(to, sizeof to, "\n%s ", bad[i].word);
        snprintf(said, sizeof said, "\"%s\", expected a number of its type", bad[i].word);
        volumes_refused(vtk_files_patch(vtk_grid_files_xml("a.vti", &g), first, to), NULL,
                        ST_CORRUPT, said);
    }
    const vtk_grid_style g = {.xml = codings[0]};
    double got[VOLUMES_SAMPLES];
    read_field(vtk_files_patch(vtk_grid_files_xml("a.vti", &g), "\n-50 ", "\nNaN "), NULL, got);
    assert_true(isnan(got[0]) && got[1] == -43);
}

/* ---- where it lies ---- */

static void test_placement(void **state) {
    (void)state;
    static const struct {
        const char *attributes;
        int lo[3];
        bool of_cells;
        double to_world[3][4];
    } cases[] = {
        {"Origin=\"1 -2 3e1\"", {0}, false, {{1, 0, 0, 1}, {0, 1, 0, -2}, {0, 0, 1, 30}}},
        {"Spacing=\"0.5 2 -4\"", {0}, false, {{0.5, 0, 0, 0}, {0, 2, 0, 0}, {0, 0, -4, 0}}},
        /* Nodes count from the origin, not from the extent. */
        {"Origin=\"1 2 3\" Spacing=\"0.5 2 4\"",
         {10, -3, 5},
         false,
         {{0.5, 0, 0, 6}, {0, 2, 0, -4}, {0, 0, 4, 23}}},
        /* The third axis of the samples is the first of the world, and so on. */
        {"Spacing=\"1 2 4\" Direction=\"0 0 1 1 0 0 0 1 0\"",
         {1, 1, 1},
         false,
         {{0, 0, 4, 4}, {1, 0, 0, 1}, {0, 2, 0, 2}}},
        {"Spacing=\"1 2 4\" Origin=\"8 8 8\"",
         {0},
         true,
         {{1, 0, 0, 8.5}, {0, 2, 0, 9}, {0, 0, 4, 10}}},
        {"Direction=\"0 -1 0 1 0 0 0 0 1\" Spacing=\"2 2 2\"",
         {1, 0, 0},
         true,
         {{0, -2, 0, -1}, {2, 0, 0, 3}, {0, 0, 2, 1}}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        vtk_grid_style g = {
            .xml = codings[i], .attributes = cases[i].attributes, .of_cells = cases[i].of_cells};
        memcpy(g.lo, cases[i].lo, sizeof g.lo);
        volumes_check(vtk_grid_files_xml("a.vti", &g), NULL, SAMPLE_F32, cases[i].to_world);
        g.cuts = 3;
        volumes_check(vtk_grid_files_xml("a.vti", &g), NULL, SAMPLE_F32, cases[i].to_world);
        volumes_check(vtk_grid_files_parallel("a.pvti", &g), NULL, SAMPLE_F32, cases[i].to_world);
    }
    vtk_grid_style g = {.attributes = "SPACING 0.5 2 4\nORIGIN 1 2 3\n", .lo = {10, -3, 5}};
    volumes_check(vtk_grid_files_legacy("a.vtk", &g, 5, 1), NULL, SAMPLE_F32, cases[2].to_world);
    g = (vtk_grid_style){.attributes = "ASPECT_RATIO 1 2 4\norigin 8 8 8\n", .of_cells = true};
    volumes_check(vtk_grid_files_legacy("a.vtk", &g, 2, 0), NULL, SAMPLE_F32, cases[4].to_world);
}

static void check_axes(const char *path, bool of_cells) {
    mem m;
    volume *v = NULL;
    mem_init(&m, 0);
    if (volume_open(&m, path, NULL, &v) != ST_OK)
        fail_msg("%s", status_text());
    const grid *g = volume_grid(v);
    for (int a = 0; a < 3; a++)
        for (int i = 0; i < (int)g->dims[a]; i++) {
            const double here = vtk_grid_files_coordinate(a, i);
            const double next = vtk_grid_files_coordinate(a, i + 1);
            assert_true(g->axis[a] && g->axis[a][i] == (of_cells ? (here + next) / 2 : here));
        }
    volume_close(v);
}

static void test_rectilinear(void **state) {
    (void)state;
    for (int i = 0; i < CODINGS; i++)
        for (unsigned cuts = 0; cuts < 8; cuts++) {
            const vtk_grid_style g = {.xml = codings[i],
                                      .rectilinear = true,
                                      .of_cells = i % 3 == 1,
                                      .cuts = cuts,
                                      .lo = {-1, 0, (int)cuts}};
            const char *path = vtk_grid_files_xml("a.vtr", &g);
            volumes_check(path, NULL, SAMPLE_F32, NULL);
            check_axes(path, g.of_cells);
            path = vtk_grid_files_parallel("a.pvtr", &g);
            volumes_check(path, NULL, SAMPLE_F32, NULL);
            check_axes(path, g.of_cells);
        }
    for (int i = 0; i < 4; i++) {
        const vtk_grid_style g = {
            .xml = {.text = i % 2}, .rectilinear = true, .of_cells = i / 2, .lo = {i, 0, 0}};
        const char *path = vtk_grid_files_legacy("a.vtk", &g, 4, 2);
        volumes_check(path, NULL, SAMPLE_F32, NULL);
        check_axes(path, g.of_cells);
    }
}

/* ---- pieces ---- */

static void test_pieces(void **state) {
    (void)state;
    for (int i = 0; i < CODINGS; i++)
        for (unsigned cuts = 0; cuts < 8; cuts++)
            for (int ghosts = 0; ghosts < 2; ghosts++)
                for (int of_cells = 0; of_cells < 2; of_cells++) {
                    const vtk_grid_style g = {.xml = codings[i],
                                              .type = "Int16",
                                              .of_cells = of_cells,
                                              .cuts = cuts,
                                              .ghosts = ghosts,
                                              .attributes =
                                                  of_cells ? "Origin=\"-.5 -.5 -.5\"" : ""};
                    volumes_check(vtk_grid_files_xml("a.vti", &g), NULL, SAMPLE_I16, NULL);
                    if (i % 4 == 0)
                        volumes_check(vtk_grid_files_parallel("a.pvti", &g), NULL, SAMPLE_I16,
                                      NULL);
                }
    /* Writers without a share of the grid leave an empty piece. */
    const vtk_grid_style g = {.xml = codings[0], .cuts = 1};
    const char *empty = "<Piece Extent=\"0 -1 0 -1 0 -1\"><PointData><DataArray type=\"Int8\" "
                        "Name=\"other\"></DataArray></PointData></Piece><Piece ";
    volumes_check(vtk_files_patch(vtk_grid_files_xml("a.vti", &g), "<Piece ", empty), NULL,
                  SAMPLE_F32, NULL);
    empty = "<Piece Extent=\"0 -1 0 -1 0 -1\" Source=\"none\"/><Piece ";
    volumes_check(vtk_files_patch(vtk_grid_files_parallel("a.pvti", &g), "<Piece ", empty), NULL,
                  SAMPLE_F32, NULL);
}

/* Of a piece without depth the cells are surfaces, not the volume's. */
static void test_flat_piece(void **state) {
    (void)state;
    static const char *const extents[] = {"4 4 0 3 0 2", "0 0 0 3 0 2", "0 4 3 3 0 2",
                                          "0 4 0 3 2 2"};
    const double map[3][4] = {{1, 0, 0, 0.5}, {0, 1, 0, 0.5}, {0, 0, 1, 0.5}};
    const vtk_grid_style g = {.xml = codings[0], .of_cells = true};
    const char *path = vtk_grid_files_xml("a.vti", &g);
    for (size_t i = 0; i < sizeof extents / sizeof *extents; i++) {
        char flat[300];
        snprintf(flat, sizeof flat,
                 "</Piece><Piece Extent=\"%s\"><CellData><DataArray type=\"Float32\" Name=\"s\">"
                 "0 0 0 0 0 0 0 0 0 0 0 0</DataArray></CellData></Piece>",
                 extents[i]);
        volumes_check(vtk_files_patch(path, "</Piece>", flat), NULL, SAMPLE_F32, map);
    }
    /* Nor do layers of surfaces make a volume. */
    char text[1500] = "<VTKFile type='ImageData'><ImageData WholeExtent='0 2 0 2 0 2'>";
    for (int z = 0; z < 3; z++)
        snprintf(text + strlen(text), sizeof text - strlen(text),
                 "<Piece Extent='0 2 0 2 %d %d'><CellData><DataArray type='Int8' Name='a'>1 2 3 4"
                 "</DataArray></CellData></Piece>",
                 z, z);
    strcat(text, "</ImageData></VTKFile>");
    volumes_refused(scratch_text("b.vti", text), NULL, ST_CORRUPT,
                    "no piece has the sample at 0 0 0");
}

/* VTK's own writers tell the directions in the pieces' files alone. */
static void test_direction_of_pieces(void **state) {
    (void)state;
    const vtk_grid_style g = {
        .xml = codings[3], .cuts = 1, .attributes = "Direction=\"0 1 0 1 0 0 0 0 1\""};
    const char *path = vtk_grid_files_parallel("a.pvti", &g);
    const double map[3][4] = {{0, 1, 0, 0}, {1, 0, 0, 0}, {0, 0, 1, 0}};
    volumes_check(vtk_files_patch(path, g.attributes, ""), NULL, SAMPLE_F32, map);
    volumes_check(vtk_files_patch(path, "0 1 0 1 0 0 0 0 1", "1 0 0 0 1 0 0 0 1"), NULL, SAMPLE_F32,
                  NULL);
}

static void test_pieces_refused(void **state) {
    (void)state;
    vtk_grid_style g = {.xml = codings[0], .cuts = 1};
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

/* ---- what is refused ---- */

static void refused(const char *path, const char *from, const char *to, status st,
                    const char *said) {
    volumes_refused(vtk_files_patch(path, from, to), NULL, st, said);
}

static void test_structure(void **state) {
    (void)state;
    vtk_grid_style g = {.xml = codings[0]};
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
    vtk_grid_style g = {.xml = codings[0], .of_cells = true, .both = true};
    const char *a = vtk_grid_files_xml("a.vti", &g);
    volumes_refused(a, &(volume_hints){.field = "t"}, ST_USAGE,
                    "no array \"t\"; the points have \"p\", the cells \"s\", \"v\", \"rgb\"");
    volumes_refused(a, &(volume_hints){.field = "v", .component = 4}, ST_USAGE, "no component 4");
    volumes_refused(a, &(volume_hints){.field = "s", .step = 1}, ST_USAGE, "no step 1");
    g = (vtk_grid_style){.xml = codings[0]};
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
    const vtk_grid_style g = {.xml = codings[0], .rectilinear = true};
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
    const vtk_grid_style g = {.xml = codings[0]};
    const char *a = vtk_grid_files_xml("a.vti", &g);
    int kept = dup(STDIN_FILENO);
    assert_non_null(freopen(a, "rb", stdin));
    volumes_refused("-", NULL, ST_UNSUPPORTED, "standard input: VTK files are read at several");
    dup2(kept, STDIN_FILENO);
    close(kept);
}

/* A file is told by what is in it, however it is quoted, and by its name when it says nothing. */
static void test_recognised(void **state) {
    (void)state;
    const vtk_grid_style g = {.xml = codings[0]};
    size_t size;
    char *data = scratch_read(vtk_grid_files_xml("a.vti", &g), &size);
    volumes_check(scratch_write("noname", data, size), NULL, SAMPLE_F32, NULL);
    char *type = strstr(data, "type=\"ImageData\"");
    type[5] = type[15] = '\'';
    volumes_check(scratch_write("noname", data, size), NULL, SAMPLE_F32, NULL);
    free(data);
    data = scratch_read(vtk_grid_files_legacy("a.vtk", &g, 3, 0), &size);
    memcpy(strstr(data, "DATASET STRUCTURED_POINTS"), "dataset structured_points", 25);
    volumes_check(scratch_write("noname", data, size), NULL, SAMPLE_F32, NULL);
    free(data);
}

/* ---- sweeps ---- */

/* The files of the sweeps: each coding, legacy ones, pieces. */
enum { SWEPT = CODINGS + 6 };

static const char *swept(int i) {
    static const char *const names[] = {"a.vti", "a.vtr"};
    const bool odd = i % 2;
    if (i < CODINGS) {
        const vtk_grid_style g = {
            .xml = codings[i], .type = "Int32", .rectilinear = odd, .cuts = i % 3 == 0 ? 5 : 0};
        return vtk_grid_files_xml(names[odd], &g);
    }
    const vtk_grid_style g = {
        .xml = {.text = odd}, .rectilinear = i % 4 > 1, .of_cells = i % 5 == 0, .cuts = 1};
    return i < CODINGS + 4 ? vtk_grid_files_legacy("a.vtk", &g, 4, 2)
                           : vtk_grid_files_parallel("a.pvti", &(vtk_grid_style){
                                                                   .xml = codings[12 - odd],
                                                                   .cuts = 1,
                                                               });
}

/* Behind the last byte that must be there: of the samples, or a tag. */
static size_t needed(const char *data, size_t size) {
    const char *appended = memmem(data, size, "\n</AppendedData>", 16);
    const char *last = appended ? appended : memmem(data, size, "</VTKFile>", 10);
    return last ? (size_t)(last - data) : size;
}

static void test_cut(void **state) {
    (void)state;
    const volume_hints hints = {.field = "rgb"}; /* the last array */
    for (int i = 0; i < SWEPT; i++) {
        double samples[VOLUMES_SAMPLES];
        grid g;
        size_t size;
        char *data = scratch_read(swept(i), &size);
        const bool in_pieces = memmem(data, size, "Source=", 7);
        const size_t end = needed(data, size) - (memmem(data, size, "AppendedData", 12) ? 4 : 0) -
                           (memmem(data, size, "VTKFile", 7) ? 0 : 5);
        for (size_t n = (size_t)i; n < end && !in_pieces; n += n + 40 < end ? 7 : 1) {
            status st = volumes_read(scratch_write("cut.vti", data, n), &hints, &g, samples);
            if (st != ST_CORRUPT && st != ST_UNSUPPORTED && st != ST_USAGE)
                fail_msg("file %d cut to %zu of %zu bytes: status %d", i, n, size, (int)st);
        }
        free(data);
    }
}

/* Any byte changed gives an error or samples, never anything else. */
static void test_damage(void **state) {
    (void)state;
    static const char masks[] = {1, 0x10, (char)0xff};
    size_t tried[2] = {0, 0};
    for (int i = 0; i < SWEPT; i++) {
        double samples[VOLUMES_SAMPLES];
        grid g;
        size_t size, noticed = 0, all = 0;
        const char *path = swept(i);
        char name[40];
        char *data = scratch_read(path, &size);
        snprintf(name, sizeof name, "bad%s", strrchr(path, '.'));
        const size_t stride = i < CODINGS ? 10 : 2;
        for (size_t n = (size_t)i % stride; n < size; n += stride, all++) {
            const char mask = masks[n / stride % 3];
            data[n] ^= mask;
            noticed += volumes_read(scratch_write(name, data, size), NULL, &g, samples) != ST_OK;
            data[n] ^= mask;
        }
        /* Fields not asked for, digits, bytes of numbers: much may change unnoticed. */
        if (noticed < all / 20)
            fail_msg("file %d: %zu of %zu changes noticed", i, noticed, all);
        tried[i < CODINGS || i >= CODINGS + 4] += all;
        free(data);
    }
    assert_true(tried[0] > 1000 && tried[1] > 1000); /* legacy, XML */
}

static void test_faults(void **state) {
    (void)state;
    for (int i = 0; i < SWEPT; i += i < CODINGS ? 3 : 1)
        volumes_faults(swept(i), NULL);
}

/* ---- real ones ---- */

/* The same samples as the raw file's; f64 in the one may be f32 in the other. */
static void check_same(const char *path, const char *raw) {
    mem m;
    volume *a = NULL, *b = NULL;
    mem_init(&m, 0);
    if (volume_open(&m, path, NULL, &a) != ST_OK || volume_open(&m, raw, NULL, &b) != ST_OK)
        fail_msg("%s", status_text());
    const grid *g = volume_grid(a), *h = volume_grid(b);
    assert_memory_equal(g->dims, h->dims, sizeof g->dims);
    const size_t count = (size_t)g->dims[0] * g->dims[1];
    void *first = malloc(count * sizeof(double)), *second = malloc(count * sizeof(double));
    for (uint32_t k = 0; k < g->dims[2]; k++) {
        assert_int_equal(volume_read(a, 1, first), ST_OK);
        assert_int_equal(volume_read(b, 1, second), ST_OK);
        sample_to_stored(g->type, first, first, count);
        assert_memory_equal(first, second, count * sizeof(float));
    }
    free(first);
    free(second);
    volume_close(a);
    volume_close(b);
}

static void test_real(void **state) {
    (void)state;
    static const char *const pairs[][2] = {
        {"hydrogen_64/hydrogen.vti", "hydrogen_64/hydrogen_64_64x64x64_float32.raw.zst"},
        {"viscous_fingers/run01_055_original.vti",
         "viscous_fingers/run01_055_64x64x64_float32.raw.zst"},
        {"isabel_wind/isabel_02_original.vti.zst",
         "isabel_wind/isabel_02_125x125x25_float32.raw.zst"},
        {"carotid/carotid.vtk.zst", "carotid/carotid_76x49x45_float32.raw.zst"},
    };
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        char path[4096];
        const char *found = scratch_data(pairs[i][0]);
        if (!found)
            skip();
        snprintf(path, sizeof path, "%s", found);
        const char *raw = scratch_data(pairs[i][1]);
        if (!raw)
            skip();
        check_same(path, raw);
    }
}

/* ---- a larger one ---- */

enum { EDGE = 160 };

/* A grid of bytes in blocks, read within a budget far below its size. */
static void test_memory(void **state) {
    (void)state;
    const size_t samples = (size_t)EDGE * EDGE * EDGE;
    double *numbers = malloc(samples * sizeof *numbers);
    for (size_t i = 0; i < samples; i++)
        numbers[i] = (double)(i * 7919 % 10007 % 256);
    for (int packing = 0; packing < 3; packing++) {
        const vtk_xml_style style = {.appended = true,
                                     .raw = true,
                                     .block = 4096,
                                     .head64 = true,
                                     .packing = (vtk_writer_packing)packing};
        vtk_writer w;
        vtk_writer_begin(&w, "ImageData", &style);
        fprintf(w.out,
                "<ImageData WholeExtent=\"0 %d 0 %d 0 %d\"><Piece Extent=\"0 %d 0 %d 0 %d\">"
                "<PointData>\n",
                EDGE - 1, EDGE - 1, EDGE - 1, EDGE - 1, EDGE - 1, EDGE - 1);
        vtk_writer_array(&w, "a", "UInt8", 1, samples, numbers);
        fprintf(w.out, "</PointData></Piece></ImageData>\n");
        const char *path = vtk_writer_end(&w, "large.vti");
        static uint8_t slice[EDGE * EDGE];
        mem m;
        volume *v = NULL;
        mem_init(&m, (size_t)1 << 20);
        if (volume_open(&m, path, NULL, &v) != ST_OK)
            fail_msg("%s", status_text());
        for (size_t k = 0; k < EDGE; k++) {
            if (volume_read(v, 1, slice) != ST_OK)
                fail_msg("%s", status_text());
            for (size_t i = 0; i < sizeof slice; i += 7)
                assert_true(slice[i] == numbers[k * sizeof slice + i]);
        }
        assert_int_equal(volume_finish(v, NULL), ST_OK);
        volume_close(v);
        assert_int_equal(mem_used(&m), 0);
    }
    free(numbers);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_codings),
        cmocka_unit_test(test_legacy),
        cmocka_unit_test(test_fields),
        cmocka_unit_test(test_large_numbers),
        cmocka_unit_test(test_text),
        cmocka_unit_test(test_placement),
        cmocka_unit_test(test_rectilinear),
        cmocka_unit_test(test_pieces),
        cmocka_unit_test(test_flat_piece),
        cmocka_unit_test(test_direction_of_pieces),
        cmocka_unit_test(test_pieces_refused),
        cmocka_unit_test(test_structure),
        cmocka_unit_test(test_choice),
        cmocka_unit_test(test_rectilinear_refused),
        cmocka_unit_test(test_legacy_refused),
        cmocka_unit_test(test_claims),
        cmocka_unit_test(test_pipe),
        cmocka_unit_test(test_recognised),
        cmocka_unit_test(test_cut),
        cmocka_unit_test(test_damage),
        cmocka_unit_test(test_faults),
        cmocka_unit_test(test_real),
        cmocka_unit_test(test_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
