/* test_heights_files.c - files of elevations, and the slices that terrain is made of. */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "formats/grid/volume.h"
#include "tests/support/scratch.h"

enum { MOST = 64 };

/* Open as terrain, and read all its slices, `at_once` at a time: each elevation is there twice. */
static void expect(const char *path, const volume_hints *more, const float *want, uint32_t nx,
                   uint32_t ny, uint32_t at_once, const double to_world[12]) {
    volume_hints hints = more ? *more : (volume_hints){.name = NULL};
    mem m;
    volume *v = NULL;
    float got[2 * MOST];
    hints.heights = true;
    mem_init(&m, 0);
    if (volume_open(&m, path, &hints, &v) != ST_OK)
        fail_msg("%s", status_text());
    const grid *g = volume_grid(v);
    assert_true(g->heights && g->type == SAMPLE_F32);
    assert_int_equal(g->dims[0], nx);
    assert_int_equal(g->dims[1], 2);
    assert_int_equal(g->dims[2], ny);
    for (uint32_t k = 0; k < ny; k += at_once)
        assert_int_equal(volume_read(v, k + at_once > ny ? ny - k : at_once, got + 2 * nx * k),
                         ST_OK);
    for (uint32_t k = 0; k < ny; k++)
        for (uint32_t i = 0; i < 2 * nx; i++) {
            const float a = got[2 * nx * k + i], b = want[nx * k + i % nx];
            assert_true(a == b || (isnan(a) && isnan(b)));
        }
    for (int i = 0; i < 12; i++)
        assert_true(fabs(((const double *)g->to_world)[i] - to_world[i]) < 1e-12);
    assert_int_equal(volume_finish(v, NULL), ST_OK);
    volume_close(v);
    assert_int_equal(mem_used(&m), 0);
}

static void refused(const char *path, status want, const char *text) {
    const volume_hints hints = {.heights = true};
    mem m;
    volume *v = NULL;
    mem_init(&m, 0);
    assert_int_equal(volume_open(&m, path, &hints, &v), want);
    if (!strstr(status_text(), text))
        fail_msg("\"%s\" without \"%s\"", status_text(), text);
    assert_int_equal(mem_used(&m), 0);
}

static void test_asc(void **state) {
    (void)state;
    const float want[6] = {1.5f, 2.0f, NAN, 4.0f, 5.0f, -6.0f};
    const double corner[12] = {10, 0, 0, 105, 0, 0, -10, 215, 0, 1, 0, 0};
    const double centre[12] = {10, 0, 0, 100, 0, 0, -10, 210, 0, 1, 0, 0};
    const char *path =
        scratch_text("a.asc", "ncols 3\nnrows 2\nxllcorner 100\nyllcorner 200\ncellsize 10\n"
                              "NODATA_value -9999\n1.5 2 -9999\n4 5 -6\n");
    expect(path, NULL, want, 3, 2, 1, corner);
    expect(path, NULL, want, 3, 2, 2, corner);
    const float kept[6] = {1.5f, 2.0f, -9999.0f, 4.0f, 5.0f, NAN};
    expect(path, &(volume_hints){.has_missing = true, .missing = -6.0}, kept, 3, 2, 1, corner);
    expect(scratch_text("b.asc", "NCOLS 3\r\nNROWS 2\r\nXLLCENTER 100\r\nYLLCENTER 200\r\n"
                                 "CELLSIZE 10\r\nNODATA_VALUE 0\r\n1.5 2 0 4 5 -6"),
           NULL, want, 3, 2, 2, centre);
}

static void test_asc_refused(void **state) {
    (void)state;
    refused(
        scratch_text("a.asc", "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2 3 4"),
        ST_CORRUPT, "ends at byte");
    refused(scratch_text("a.asc", "ncols 3\nnrows 2\nxllcorner 0\ncellsize 1\n1 2 3 4 5 6"),
            ST_CORRUPT, "a place along x and y");
    refused(scratch_text("a.asc", "ncols 3\nncols 3\n1 2 3 4 5 6"), ST_CORRUPT, "each once");
    refused(scratch_text("a.asc", "ncols 3\nnrows x\n1 2 3 4 5 6"), ST_CORRUPT, "is no number");
    refused(scratch_text("a.asc", "ncols 3.5\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n1"),
            ST_CORRUPT, "ncols and nrows");
    refused(scratch_text("a.asc", "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 0\n1"),
            ST_CORRUPT, "cellsize above 0");
    refused(scratch_text("a.asc", "ncols 3\nwords 2\n1 2 3"), ST_CORRUPT, "found \"words\"");
}

static void test_hgt(void **state) {
    (void)state;
    const unsigned char bytes[18] = {0, 1, 0, 2, 0, 3, 1, 0, 0x80, 0, 0xff, 0xff, 0, 7, 0, 8, 0, 9};
    const float want[9] = {1, 2, 3, 256, NAN, -1, 7, 8, 9};
    const double place[12] = {0.5, 0, 0, -6, 0, 0, -0.5, 48, 0, 1, 0, 0};
    expect(scratch_write("N47W006.hgt", bytes, sizeof bytes), NULL, want, 3, 3, 1, place);
    const double nowhere[12] = {0.5, 0, 0, 0, 0, 0, -0.5, 1, 0, 1, 0, 0};
    expect(scratch_write("tile.hgt", bytes, sizeof bytes), NULL, want, 3, 3, 2, nowhere);
    refused(scratch_write("short.hgt", bytes, sizeof bytes - 2), ST_CORRUPT, "is a square");
}

/* ---- models of the U.S. Geological Survey ---- */

/* What the head says, and where profiles begin, in units of the plane. */
typedef struct model {
    int plane, up, profiles;
    double north, height_step, angle;
    const char *end; /* of each record */
} model;

/* Write a number at a column of a record. */
static void at(char *record, int column, int width, const char *text) {
    memcpy(record + column + width - (int)strlen(text), text, strlen(text));
}

static void at_int(char *record, int column, int value) {
    char text[16];
    snprintf(text, sizeof text, "%d", value);
    at(record, column, 6, text);
}

/* With the exponent's D of Fortran. */
static void at_real(char *record, int column, int width, double value) {
    char text[32];
    snprintf(text, sizeof text, "%.5E", value);
    if (width == 24)
        *strchr(text, 'E') = 'D';
    at(record, column, width, text);
}

enum { RECORD = 1024, PROFILES = 3, LONG = 150 };

/* Three profiles, each one node further north than the last, 4, 3 and `last` nodes long. */
static size_t write_model(const model *m, int last, char *to) {
    const int counts[PROFILES] = {4, 3, last};
    char record[RECORD];
    size_t size = 0;
    memset(record, ' ', RECORD);
    at_int(record, 156, 1);
    at_int(record, 528, m->plane);
    at_int(record, 534, m->up);
    at_real(record, 786, 24, m->angle);
    at_real(record, 816, 12, 90.0);
    at_real(record, 828, 12, 180.0);
    at_real(record, 840, 12, m->height_step);
    at_int(record, 852, 1);
    at_int(record, 858, m->profiles);
    size += (size_t)sprintf(to + size, "%.1024s%s", record, m->end);
    for (int p = 0; p < PROFILES; p++) {
        memset(record, ' ', RECORD);
        at_int(record, 0, 1);
        at_int(record, 6, p + 1);
        at_int(record, 12, counts[p]);
        at_int(record, 18, 1);
        at_real(record, 24, 24, 3600.0 + 90.0 * p);
        at_real(record, 48, 24, m->north + 180.0 * p);
        at_real(record, 72, 24, p == 1 ? 100.0 : 0.0);
        for (int i = 0, column = 144; i < counts[p]; i++, column += 6) {
            if (column + 6 > 1020) {
                size += (size_t)sprintf(to + size, "%.1024s%s", record, m->end);
                memset(record, ' ', RECORD);
                column = 0;
            }
            at_int(record, column, p == 0 && i == 1 ? -32767 : 10 * p + i);
        }
        size += (size_t)sprintf(to + size, "%.1024s%s", record, m->end);
    }
    return size;
}

static void test_dem(void **state) {
    (void)state;
    static char text[8 * (RECORD + 4)];
    const model plain = {3, 2, PROFILES, 7200.0, 1.0, 0.0, ""};
    /* From north to south; the second profile has a datum. */
    float all[15] = {NAN, NAN, 22, 3, 112, 21, 2, 111, 20, NAN, 110, NAN, 0, NAN, NAN};
    const double degrees[12] = {0.025, 0, 0, 1, 0, 0, -0.05, 2.2, 0, 1, 0, 0};
    size_t size = write_model(&plain, 3, text);
    expect(scratch_write("a.dem", text, size), NULL, all, 3, 5, 1, degrees);
    expect(scratch_write("a.dem", text, size), NULL, all, 3, 5, 5, degrees);
    const model lines = {2, 1, PROFILES, 7200.0, 0.5, 0.25, "\r\n"};
    const double metres[12] = {90, 0, 0, 3600, 0, 0, -180, 7920, 0, 1, 0, 0};
    for (int i = 0; i < 15; i++)
        all[i] = i == 4 || i == 7 || i == 10 ? 100 + (all[i] - 100) / 2 : all[i] / 2;
    size = write_model(&lines, 3, text);
    expect(scratch_write("b.DEM", text, size), NULL, all, 3, 5, 2, metres);
}

/* A profile's heights go on in further records. */
static void test_dem_long(void **state) {
    (void)state;
    static char text[8 * (RECORD + 4)];
    const model plain = {2, 2, PROFILES, 0.0, 1.0, 0.0, "\n"};
    const size_t size = write_model(&plain, LONG, text);
    const char *path = scratch_write("long.dem", text, size);
    static float got[2 * PROFILES * (LONG + 2)];
    const volume_hints hints = {.heights = true};
    mem m;
    volume *v = NULL;
    mem_init(&m, 0);
    assert_int_equal(volume_open(&m, path, &hints, &v), ST_OK);
    assert_int_equal(volume_grid(v)->dims[2], LONG + 2);
    assert_int_equal(volume_read(v, LONG + 2, got), ST_OK);
    for (int i = 0; i < LONG; i++)
        assert_true(got[2 * PROFILES * (LONG - 1 - i) + 2] == (float)(20 + i));
    volume_close(v);
}

static void test_dem_refused(void **state) {
    (void)state;
    static char text[8 * (RECORD + 4)];
    const model plain = {3, 2, PROFILES, 7200.0, 1.0, 0.0, ""};
    const size_t size = write_model(&plain, 3, text);
    refused(scratch_write("a.dem", text, size - RECORD), ST_CORRUPT, "before its last profile");
    refused(scratch_write("a.dem", text, 600), ST_CORRUPT, "expected an angle, found \"\"");
    at(text, RECORD + 144, 6, "1x");
    refused(scratch_write("a.dem", text, size), ST_CORRUPT, "expected an elevation, found \"1x\"");
    write_model(&(model){0, 2, PROFILES, 0, 1, 0, ""}, 3, text);
    refused(scratch_write("a.dem", text, size), ST_UNSUPPORTED, "arc-seconds (3), found 0");
    write_model(&(model){3, 3, PROFILES, 0, 1, 0, ""}, 3, text);
    refused(scratch_write("a.dem", text, size), ST_CORRUPT, "feet (1) or metres (2), found 3");
    write_model(&(model){3, 2, 1, 0, 1, 0, ""}, 3, text);
    refused(scratch_write("a.dem", text, size), ST_CORRUPT, "found 1 rows of 1");
    write_model(&(model){3, 2, PROFILES, 0, 0, 0, ""}, 3, text);
    refused(scratch_write("a.dem", text, size), ST_CORRUPT, "resolutions above 0");
    write_model(&plain, 3, text);
    at_int(text, RECORD + 12, 0);
    refused(scratch_write("a.dem", text, size), ST_CORRUPT, "expected one column of 1 to");
    write_model(&plain, 3, text);
    at_real(text, 2 * RECORD + 24, 24, 9000.0);
    refused(scratch_write("a.dem", text, size), ST_CORRUPT, "profile 1 (counted from 0)");
    refused(scratch_write("a.dem", "\1\2\3\4", 4), ST_UNSUPPORTED, "--dims");
}

static void test_not_terrain(void **state) {
    (void)state;
    refused(scratch_text("a.nrrd", "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\n"
                                   "encoding: raw\n\n12345678"),
            ST_USAGE, "one slice, and this one has 2");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_asc),         cmocka_unit_test(test_asc_refused),
        cmocka_unit_test(test_hgt),         cmocka_unit_test(test_dem),
        cmocka_unit_test(test_dem_long),    cmocka_unit_test(test_dem_refused),
        cmocka_unit_test(test_not_terrain),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
