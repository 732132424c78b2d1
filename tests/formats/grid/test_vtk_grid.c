/* test_vtk_grid.c - VTK files of grids, XML and legacy: every coding, type and compressor; pieces
 * in one file and in several; points and cells; cut and damaged files; faults; memory that does not
 * grow.
 */
/* marks: bits, long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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
        cmocka_unit_test(test_codings),     cmocka_unit_test(test_legacy),
        cmocka_unit_test(test_fields),      cmocka_unit_test(test_large_numbers),
        cmocka_unit_test(test_text),        cmocka_unit_test(test_placement),
        cmocka_unit_test(test_rectilinear), cmocka_unit_test(test_pieces),
        cmocka_unit_test(test_flat_piece),  cmocka_unit_test(test_direction_of_pieces),
        cmocka_unit_test(test_recognised),  cmocka_unit_test(test_cut),
        cmocka_unit_test(test_damage),      cmocka_unit_test(test_faults),
        cmocka_unit_test(test_real),        cmocka_unit_test(test_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
