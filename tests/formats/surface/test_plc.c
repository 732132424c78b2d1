/* test_plc.c - points and facets from TetGen, PLY, STL, OFF and tables: what is read, what is
 * refused with file and place, cut and damaged files, faults; welding, dropping, open and flat
 * ones.
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

#include "formats/base/fault.h"
#include "formats/surface/plc.h"
#include "formats/surface/plc_clean.h"
#include "tests/support/scratch.h"

/* ---- what the tests share ---- */

static status read_file(const char *path, const plc_hints *hints, plc *x, mem *m) {
    mem_init(m, 0);
    return plc_read(m, path, hints, x);
}

static void end(plc *x, mem *m) {
    plc_release(x);
    assert_int_equal(mem_used(m), 0);
}

static status only_status(const char *path, const plc_hints *hints) {
    mem m;
    plc x;
    const status st = read_file(path, hints, &x, &m);
    end(&x, &m);
    return st;
}

static void refused(const char *path, const plc_hints *hints, status want, const char *said) {
    const status st = only_status(path, hints);
    if (st != want || !strstr(status_text(), said))
        fail_msg("%s: %d \"%s\", not %d \"%s\"", path, (int)st, status_text(), (int)want, said);
}

static void faults(const char *path, fault_kind kind) {
    long k = 0;
    for (bool fired = true; fired;) {
        fault_arm(kind, ++k);
        const status st = only_status(path, NULL);
        fired = fault_fired(kind);
        fault_arm(kind, 0);
        assert_int_equal(st, !fired ? ST_OK : kind == FAULT_ALLOC ? ST_NOMEM : ST_IO);
    }
    assert_true(k > 1);
}

/* Every prefix but for the last `spare` bytes is refused, every damage ends in a status;
 * allocations and reads that fail, too. */
static void sweeps(const char *path, size_t spare) {
    size_t size, good = 0;
    char *data = scratch_read(path, &size);
    const char *name = strrchr(path, '/') + 1;
    for (size_t n = 0; n + spare < size; n++) {
        scratch_write(name, data, n);
        if (only_status(path, NULL) == ST_OK)
            fail_msg("%s cut to %zu of %zu bytes is read", path, n, size);
    }
    for (size_t n = 0; n < size; n++)
        for (int mask = 1; mask < 256; mask = mask == 1 ? 0x10 : mask == 0x10 ? 0xff : 256) {
            data[n] = (char)(data[n] ^ mask);
            scratch_write(name, data, size);
            good += only_status(path, NULL) == ST_OK;
            data[n] = (char)(data[n] ^ mask);
        }
    scratch_write(name, data, size);
    free(data);
    assert_true(good > 0);
    faults(path, FAULT_ALLOC);
    faults(path, FAULT_READ);
}

/* A tetrahedron with the corners 0, x, y, z of length 1, 2, 3; in this order of points. */
static const double corners[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}};
static const uint32_t faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

static void check_tet(const plc *x) {
    assert_int_equal(x->points.count, 4);
    assert_memory_equal(x->points.data, corners, sizeof corners);
    assert_int_equal(x->facets.count, 4);
    assert_int_equal(x->polygons.count, 4);
    assert_int_equal(x->corners.count, 12);
    assert_memory_equal(x->corners.data, faces, sizeof faces);
    for (size_t f = 0; f < 4; f++) {
        assert_int_equal(plc_facet_at(x, f)->polygon, f);
        assert_int_equal(plc_facet_at(x, f)->number, f);
        assert_int_equal(plc_polygons_end(x, f), f + 1);
        assert_int_equal(plc_corners_begin(x, f), 3 * f);
    }
}

static void check_values(const plc *x, const char *field, const double *want) {
    assert_string_equal(x->field, field);
    assert_int_equal(x->values.count, want ? x->points.count : 0);
    for (size_t i = 0; i < x->values.count; i++) {
        const double got = ((const double *)x->values.data)[i];
        assert_true(got == want[i] || (isnan(got) && isnan(want[i])));
    }
}

static void reads_tet(const char *path, const plc_hints *hints, const char *field,
                      const double *values, bool weld) {
    mem m;
    plc x;
    plc_report report;
    if (read_file(path, hints, &x, &m) != ST_OK)
        fail_msg("%s", status_text());
    if (weld) {
        assert_int_equal(plc_clean(&x, false, &report), ST_OK);
        assert_int_equal(report.welded, 8);
        assert_int_equal(report.flat + report.repeated, 0);
    }
    check_tet(&x);
    check_values(&x, field, values);
    assert_int_equal(plc_check_closed(&x, path), ST_OK);
    assert_int_equal(plc_check_solid(&x, path), ST_OK);
    end(&x, &m);
}

/* ---- tables ---- */

static void check_table(const char *text, const plc_hints *hints, const char *field,
                        const double *values) {
    mem m;
    plc x;
    if (read_file(scratch_text("t.csv", text), hints, &x, &m) != ST_OK)
        fail_msg("%s", status_text());
    assert_int_equal(x.points.count, 4);
    assert_memory_equal(x.points.data, corners, sizeof corners);
    assert_int_equal(x.facets.count, 0);
    check_values(&x, field, values);
    end(&x, &m);
}

static void test_tables(void **state) {
    (void)state;
    const double t[4] = {7, (double)NAN, 9, 1e300}, q[4] = {1, 2, 3, 4};
    check_table("0 0 0\n1,0,0\n\n# a comment\n0;2;0 # another\n\t0 0 3", NULL, "", NULL);
    check_table("t,y,x,z,\"q\"\n7,0,0,0,1\n,0,1,0,2\r\n9,2,0,0,3\n1e300,0,0,3,4\n", NULL, "t", t);
    check_table("t,Y,\"X\",z,\"q\"\n7,0,0,0,1\n,0,1,0,2\r\n9,2,0,0,3\n1e300,0,0,3,4\n",
                &(plc_hints){.field = "q"}, "q", q);
    check_table("\"Points:0\",\"Points:1\",\"Points:2\",q\n0 0 0 1\n1 0 0 2\n0 2 0 3\n0 0 3 4\n",
                NULL, "q", q);
    check_table("0 0 0 7 1\n1 0 0 nan 2\n0 2 0 9 3\n0 0 3 1e300 4\n", NULL, "column4", t);
    check_table("0 0 0 7 1\n1 0 0 7 2\n0 2 0 9 3\n0 0 3 1e300 4\n", &(plc_hints){.field = "5"},
                "column5", q);
    check_table("0 0 0\n1 0 0\n0 2 0\n0 0 3\n", &(plc_hints){.field = "distance", .optional = true},
                "", NULL);
}

static void test_tables_refused(void **state) {
    (void)state;
    static const struct {
        const char *text, *said;
    } cases[] = {
        {"0 0\n", "t.csv: line 1: \"0 0\", expected three columns"},
        {"x y z\n0 0 0\n\n1 1\n", "t.csv: line 4: \"1 1\", expected x, y and z"},
        {"0 0 0\n1 one 0\n", "t.csv: line 2: \"one\", expected a number"},
        {"0 0 0\n0 0 nan\n",
         "t.csv: line 2: point 1 (counted from 0): z is nan, expected a finite"},
        {"0 0 0\n0 1e39 0\n", "line 2: point 1 (counted from 0): y is 1e+39"},
        {"0,0,0\n0,,0\n", "t.csv: line 2: \"\", expected a number"},
        {"0,0,0,0\n0,0,0,z\n", "t.csv: line 2: \"z\", expected a number"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        refused(scratch_text("t.csv", cases[i].text), NULL, ST_CORRUPT, cases[i].said);
    refused(scratch_text("t.csv", "x y z t\n"), &(plc_hints){.field = "s"}, ST_UNSUPPORTED,
            "t.csv: no field \"s\" among the 4 columns");
    refused(scratch_path("none.csv"), NULL, ST_IO, "none.csv");
    refused(scratch_text("t.dat", "0 0 0\n"), NULL, ST_UNSUPPORTED,
            "no known format (it begins with 30");
    refused(scratch_path("t.dat"), &(plc_hints){.format = "obj"}, ST_USAGE, "no format \"obj\"");
    assert_int_equal(only_status(scratch_path("t.dat"), &(plc_hints){.format = "CSV"}), ST_OK);
}

/* ---- OFF ---- */

#define OFF                                                         \
    "OFF # a tet\n4 4 6\n0 0 0\n1 0 0\n0 2 0\n0 0 3\n3 0 2 1 255\n" \
    "3 0 1 3\n3 0 3 2 0.5 0.5 1\n3 1 2 3\n"

static void test_off(void **state) {
    (void)state;
    reads_tet(scratch_text("t.off", OFF), NULL, "", NULL, false);
    reads_tet(scratch_text("t.off", "COFF 4 4 6\n0 0 0 1 0 0 1\n1 0 0 1 0 0 1\n0 2 0 1 1 1 1\n"
                                    "0 0 3 1 1 1 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3"),
              NULL, "", NULL, false);
    const char *path = scratch_text("t.off", OFF);
    sweeps(path, sizeof "3 1 2 3\n");
    refused(scratch_text("t.off", "OFG\n"), NULL, ST_CORRUPT, "line 1: \"OFG\", expected OFF");
    refused(scratch_text("t.off", "OFF BINARY\n"), NULL, ST_UNSUPPORTED, "binary OFF");
    refused(scratch_text("t.off", "OFF\n2 1 0\n0 0 0\n1 inf 1\n"), NULL, ST_CORRUPT,
            "t.off: line 4: point 1 (counted from 0): y is inf");
    refused(scratch_text("t.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"), NULL, ST_CORRUPT,
            "t.off: line 6: \"3\", expected the number of a vertex");
    refused(scratch_text("t.off", OFF), &(plc_hints){.field = "q"}, ST_UNSUPPORTED, "OFF has none");
}

/* ---- PLY ---- */

#define PLY_HEADER(format)                                                           \
    "ply\nformat " format " 1.0\ncomment made by hand\nelement vertex 4\n"           \
    "property float x\nproperty double y\nproperty int16 z\nproperty uchar red\n"    \
    "property list uchar short extra\nproperty float quality\nproperty int other\n"  \
    "element face 4\nproperty uchar flags\nproperty list uint8 int vertex_indices\n" \
    "element edge 1\nproperty int vertex1\nend_header\n"

static const double quality[4] = {0.5, 1.5, -2, 4}, other[4] = {-1, -2, -3, 70000};

static const char *write_text_ply(void) {
    return scratch_text("t.ply", PLY_HEADER("ascii") "0 0 0 9 2 5 6 0.5 -1\n1 0 0 9 0 1.5 -2\n"
                                                     "0 2 0 9 1 7 -2 -3\n0 0 3 9 0 4 70000\n"
                                                     "0 3 0 2 1\n0 3 0 1 3 1 3 0 3 2\n0 3 1 2 3\n"
                                                     "77\n");
}

typedef struct bytes {
    char data[4096];
    size_t size;
    bool big;
} bytes;

static void put(bytes *b, const void *value, size_t size) {
    const char *from = value;
    for (size_t i = 0; i < size; i++)
        b->data[b->size++] = from[b->big ? size - 1 - i : i]; /* of a little-endian machine */
}
static void put_int(bytes *b, int64_t value, size_t size) {
    put(b, &value, size);
}
static void put_float(bytes *b, double value) {
    const float f = (float)value;
    put(b, &f, sizeof f);
}

static const char *write_binary_ply(bool big) {
    bytes b = {.big = big};
    const char *header = big ? PLY_HEADER("binary_big_endian") : PLY_HEADER("binary_little_endian");
    b.size = strlen(header);
    memcpy(b.data, header, b.size);
    for (int i = 0; i < 4; i++) {
        put_float(&b, corners[i][0]);
        put(&b, &corners[i][1], 8);
        put_int(&b, (int64_t)corners[i][2], 2);
        put_int(&b, 200, 1);
        put_int(&b, i, 1);
        for (int k = 0; k < i; k++)
            put_int(&b, -k, 2);
        put_float(&b, quality[i]);
        put_int(&b, (int64_t)other[i], 4);
    }
    for (int f = 0; f < 4; f++) {
        put_int(&b, 0, 1);
        put_int(&b, 3, 1);
        for (int c = 0; c < 3; c++)
            put_int(&b, faces[f][c], 4);
    }
    put_int(&b, 77, 4);
    return scratch_write("t.ply", b.data, b.size);
}

static void test_ply(void **state) {
    (void)state;
    const plc_hints second = {.field = "other"};
    reads_tet(write_text_ply(), NULL, "quality", quality, false);
    reads_tet(write_text_ply(), &second, "other", other, false);
    sweeps(write_text_ply(), sizeof "77");
    for (int big = 0; big < 2; big++) {
        reads_tet(write_binary_ply(big), NULL, "quality", quality, false);
        reads_tet(write_binary_ply(big), &second, "other", other, false);
        sweeps(write_binary_ply(big), 0);
    }
}

static void test_ply_refused(void **state) {
    (void)state;
#define XYZ "property float x\nproperty float y\nproperty float z\n"
#define V1  "element vertex 1\n" XYZ
    static const struct {
        const char *text;
        status st;
        const char *said;
    } cases[] = {
        {"plx\n", ST_CORRUPT, "line 1: \"plx\", expected ply"},
        {"ply\nformat text 1.0\n", ST_CORRUPT, "line 2: \"text\", expected ascii"},
        {"ply\nformat ascii 2.0\n", ST_CORRUPT, "line 2: \"2.0\", expected 1.0"},
        {"ply\nformat ascii 1.0\nelement vertex -1\n", ST_CORRUPT, "line 3: \"-1\", expected the"},
        {"ply\nformat ascii 1.0\nproperty float x\n", ST_CORRUPT, "line 3: "},
        {"ply\nformat ascii 1.0\nelement vertex 1\nproperty real x\n", ST_CORRUPT,
         "line 4: \"real\", expected a type"},
        {"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n0\n", ST_CORRUPT,
         "expected vertices with properties x, y and z"},
        {"ply\nformat ascii 1.0\n" V1 "element face 1\nproperty int n\nend_header\n", ST_CORRUPT,
         "faces without a list vertex_indices"},
        {"ply\nformat ascii 1.0\n" V1 "element tristrips 1\nproperty list int int "
         "vertex_indices\nend_header\n",
         ST_UNSUPPORTED, "strips of triangles"},
        {"ply\nformat ascii 1.0\n" V1 "end_header\n0 nan 0\n", ST_CORRUPT,
         "line 8: point 0 (counted from 0): y is nan"},
        {"ply\nformat ascii 1.0\n" V1 "end_header\n0 0 x\n", ST_CORRUPT,
         "line 8: \"x\", expected a number"},
        {"ply\nformat ascii 1.0\n" V1 "end_header\n0 0 0 0\n", ST_CORRUPT, "expected the end"},
        {"ply\nformat ascii 1.0\n" V1
         "element face 1\nproperty list int int vertex_index\nend_header\n0 0 0\n3 0 0 1\n",
         ST_CORRUPT, "facet 0 (counted from 0) has a corner that is no point"},
        {"ply\nformat ascii 1.0\n" V1
         "element face 1\nproperty list int int vertex_index\nend_header\n0 0 0\n-3 0 0 1\n",
         ST_CORRUPT, "face 0 (counted from 0): a list of -3"},
        {"ply\nformat binary_little_endian 1.0\n" V1 "end_header\n0123456", ST_CORRUPT,
         "inside vertex 0"},
        {"ply\nformat binary_little_endian 1.0\nelement vertex 1000000000000\n" XYZ
         "end_header\n012345678901",
         ST_CORRUPT, "inside vertex 1 "},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        refused(scratch_text("t.ply", cases[i].text), NULL, cases[i].st, cases[i].said);
    refused(write_text_ply(), &(plc_hints){.field = "speed"}, ST_UNSUPPORTED,
            "the vertices have no property \"speed\"");
}

/* ---- STL ---- */

static const char *write_binary_stl(void) {
    bytes b = {0};
    b.size = 80;
    memcpy(b.data, "solid, but not a text", 22);
    put_int(&b, 4, 4);
    for (int f = 0; f < 4; f++) {
        for (int a = 0; a < 3; a++)
            put_float(&b, 0);
        for (int c = 0; c < 3; c++)
            for (int a = 0; a < 3; a++)
                put_float(&b,
                          c == 0 && corners[faces[f][c]][a] == 0 ? -0.0 : corners[faces[f][c]][a]);
        put_int(&b, 0, 2);
    }
    return scratch_write("t.stl", b.data, b.size);
}

static const char *write_text_stl(int solids) {
    char text[4096];
    int n = sprintf(text, "solid two words\n");
    for (int f = 0; f < 4; f++) {
        n += sprintf(text + n, "  facet normal 0 0 nan\n    outer loop\n");
        for (int c = 0; c < 3; c++) {
            const double *p = corners[faces[f][c]];
            n += sprintf(text + n, "      vertex %g %.3e %g\n", p[0], p[1], p[2]);
        }
        n += sprintf(text + n, "    endloop\n  endfacet\n");
        if (f < solids - 1)
            n += sprintf(text + n, "endsolid\nSOLID\n");
    }
    sprintf(text + n, "endsolid two words\n");
    return scratch_text("t.stl", text);
}

/* Points come in the order of the triangles: 0 2 1 3. */
static void reads_stl(const char *path) {
    static const double order[4][3] = {{0, 0, 0}, {0, 2, 0}, {1, 0, 0}, {0, 0, 3}};
    static const uint32_t want[4][3] = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {2, 1, 3}};
    mem m;
    plc x;
    plc_report report;
    if (read_file(path, NULL, &x, &m) != ST_OK)
        fail_msg("%s", status_text());
    assert_int_equal(x.points.count, 12);
    assert_int_equal(plc_clean(&x, false, &report), ST_OK);
    assert_int_equal(report.welded, 8);
    assert_int_equal(x.points.count, 4);
    assert_memory_equal(x.points.data, order, sizeof order); /* also: no -0 is left */
    assert_memory_equal(x.corners.data, want, sizeof want);
    assert_int_equal(plc_check_closed(&x, path), ST_OK);
    end(&x, &m);
}

static void test_stl(void **state) {
    (void)state;
    reads_stl(write_binary_stl());
    sweeps(write_binary_stl(), 0);
    reads_stl(write_text_stl(3));
    reads_stl(write_text_stl(1));
    sweeps(write_text_stl(1), sizeof " two words\n");
    refused(scratch_text("t.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 inf\n"), NULL,
            ST_CORRUPT, "line 4: point 0 (counted from 0): z is inf");
    refused(scratch_text("t.stl", "solid\nfacet normal 0 0\nouter loop\n"), NULL, ST_CORRUPT,
            "line 3: \"outer\", expected a number of the normal");
    refused(write_text_stl(1), &(plc_hints){.field = "q"}, ST_UNSUPPORTED, "STL has none");
}

/* ---- TetGen ---- */

#define POLY_NODES \
    "4 3 2 1\n1 0 0 0 0.5 -1 3\n2 1 0 0 1.5 -2 0\n3 0 2 0 -2 -3 0\n4 0 0 3 4 70000 0\n"
#define POLY_FACETS                                                               \
    "4 1\n1 0 1\n3 1 3 2\n1\n3 1 2 4 # the second\n1 0\n3 1 4 3\n1\n3  2\n 3 4\n" \
    "1\n1 0.125 0.25 0.5\n2\n1 0.1 0.1 0.1 -7 0.01\n2 0.1 0.2 0.1 5\n"

static void check_poly(const char *path) {
    static const double hole[3] = {0.125, 0.25, 0.5};
    static const double regions[2][5] = {{0.1, 0.1, 0.1, -7, 0.01}, {0.1, 0.2, 0.1, 5, 5}};
    mem m;
    plc x;
    if (read_file(path, NULL, &x, &m) != ST_OK)
        fail_msg("%s", status_text());
    check_tet(&x);
    check_values(&x, "attr1", quality);
    assert_true(x.loose);
    assert_int_equal(x.counted_from, 1);
    assert_int_equal(x.holes.count, 1);
    assert_memory_equal(x.holes.data, hole, sizeof hole);
    assert_int_equal(x.regions.count, 2);
    assert_memory_equal(x.regions.data, regions, sizeof regions);
    end(&x, &m);
}

static void test_poly(void **state) {
    (void)state;
    const double marker[4] = {3, 0, 0, 0};
    check_poly(scratch_text("t.poly", "# made by hand\n" POLY_NODES POLY_FACETS));
    sweeps(scratch_path("t.poly"), sizeof "2\n1 0.1 0.1 0.1 -7 0.01\n2 0.1 0.2 0.1 5\n" + 30);
    scratch_text("t.node", POLY_NODES);
    check_poly(scratch_text("t.poly", "0 3\n" POLY_FACETS));
    faults(scratch_path("t.poly"), FAULT_ALLOC);
    faults(scratch_path("t.poly"), FAULT_READ);
    reads_tet(
        scratch_text("t.smesh", POLY_NODES "4 1\n3 1 3 2 7\n3 1 2 4\n3 1 4\n3 5\n3 2 3 4\n0\n"),
        &(plc_hints){.field = "2"}, "attr2", other, false);
    reads_tet(scratch_path("t.smesh"), &(plc_hints){.field = "marker"}, "marker", marker, false);
    refused(scratch_path("t.smesh"), &(plc_hints){.field = "attr3"}, ST_UNSUPPORTED,
            "no field \"attr3\", there are 2: attr1 .., and marker");
    assert_int_equal(only_status(scratch_path("t.node"), NULL), ST_OK);
}

static void test_poly_holes(void **state) {
    (void)state;
    mem m;
    plc x;
    const char *path =
        scratch_text("t.poly", "3 3\n0 0 0 0\n1 1 0 0\n2 0 1 0\n2 0\n2 1 5\n3 0 1 2\n"
                               "2 0 1\n1 0.5 0.25 0\n1 1\n3 2 1 0\n1 3 4 5\n");
    assert_int_equal(read_file(path, NULL, &x, &m), ST_OK);
    assert_int_equal(x.facets.count, 2);
    assert_int_equal(plc_polygons_end(&x, 0), 2);
    assert_int_equal(plc_corners_begin(&x, 1), 3);
    assert_int_equal(plc_corners_begin(&x, 2), 5);
    assert_int_equal(plc_facet_at(&x, 1)->hole, 1);
    assert_int_equal(plc_facet_holes_end(&x, 1), 2);
    assert_true(((const double *)x.facet_holes.data)[3] == 3);
    plc_report report; /* segments in a facet stay */
    assert_int_equal(plc_clean(&x, false, &report), ST_OK);
    assert_int_equal(x.polygons.count, 3);
    end(&x, &m);
}

static void test_poly_refused(void **state) {
    (void)state;
#define P3 "3 3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n"
    static const struct {
        const char *text, *said;
    } cases[] = {
        {"3 3\n2 0 0 0\n", "line 2: \"2\", expected the ids of points"},
        {"3 3\n1 0 0 0\n3 0 0 0\n", "line 3: \"3\", expected the ids"},
        {"3 3\n1 0 0\n", "line 2: nothing more here, expected a coordinate"},
        {"1 3\n1 0 nan 0\n", "line 2: point 0 (counted from 0): y is nan"},
        {P3 "1 0\n1\n3 1 2 4\n", "facet 1 (counted from 1) has a corner that is no point"},
        {P3 "1 0\n1\n3 1 2 0\n", "facet 1 (counted from 1) has a corner"},
        {P3 "1 0\n1\n3 1 2 x\n", "line 7: \"x\", expected the id of a point"},
        {P3 "1 0\n1\n3 1 2 3 4\n", "line 7: \"4\", expected the end of the line"},
        {P3 "1 0\n0\n", "line 6: \"0\", expected the number of a facet's polygons"},
        {P3 "1 0\n1\n3 1 2 3\nholes\n", "line 8: \"holes\", expected the number of holes"},
        {P3 "1 0\n1\n3 1 2 3\n0\n0\nmore\n", "line 10: \"more\", expected the end"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        refused(scratch_text("u.poly", cases[i].text), NULL, ST_CORRUPT, cases[i].said);
    refused(scratch_text("u.poly", "0\n1 0\n1\n3 1 2 3\n"), NULL, ST_IO, "u.node");
    refused(scratch_text("u.node", "2 2\n"), NULL, ST_UNSUPPORTED, "points of 2 dimensions");
}

/* ---- cleaning and refusing ---- */

static void test_clean(void **state) {
    (void)state;
    mem m;
    plc x;
    plc_report report;
    /* Points 4 and 5 are 1 and 0 again; faces: good, flat, repeated (turned), a quad with a corner
     * twice, one with two corners. */
    const char *path =
        scratch_text("t.off", "OFF 6 5 0\n0 0 0\n1 0 0\n0 2 0\n0 0 3\n1 0 -0\n-0 0 0\n"
                              "3 0 1 2\n3 0 4 1\n3 2 5 4\n4 0 5 2 3\n2 0 1\n");
    assert_int_equal(read_file(path, NULL, &x, &m), ST_OK);
    assert_int_equal(plc_clean(&x, false, &report), ST_OK);
    assert_int_equal(report.welded, 2);
    assert_int_equal(report.flat, 2);
    assert_int_equal(report.repeated, 1);
    assert_memory_equal(x.points.data, corners, sizeof corners);
    static const uint32_t want[6] = {0, 1, 2, 0, 2, 3};
    assert_int_equal(x.facets.count, 2);
    assert_int_equal(x.corners.count, 6);
    assert_memory_equal(x.corners.data, want, sizeof want);
    assert_int_equal(plc_facet_at(&x, 1)->number, 3);
    assert_int_equal(plc_check_closed(&x, "t.off"), ST_CORRUPT);
    assert_non_null(
        strstr(status_text(), "facet 0 (counted from 0) has the edge (0 0 0) to (1 0 0) alone"));
    end(&x, &m);
}

static void test_floats(void **state) {
    (void)state;
    mem m;
    plc x;
    plc_report report;
    const char *text = "0.1 0 0 5\n0.10000000000000001 0 0 6\n0.1000000001 0 0 7\n0.2 0 0 8\n";
    const double want[4] = {5, 7, 8}, rounded[2] = {5, 8};
    assert_int_equal(read_file(scratch_text("t.csv", text), NULL, &x, &m), ST_OK);
    assert_int_equal(plc_clean(&x, false, &report), ST_OK);
    assert_int_equal(report.welded, 1);
    check_values(&x, "column4", want);
    assert_int_equal(plc_clean(&x, true, &report), ST_OK);
    assert_int_equal(report.welded, 1);
    check_values(&x, "column4", rounded);
    assert_true(plc_point(&x, 1)[0] == (double)0.2f);
    end(&x, &m);
}

static void test_solid(void **state) {
    (void)state;
    static const struct {
        const char *text, *said; /* NULL: fine */
    } cases[] = {
        {"0 0 0\n1 0 0\n0 1 0\n", "t.csv: 3 different points, expected 4 or more"},
        {"0 0 0\n1 0 0\n0 1 0\n1 0 -0\n", "3 different points"},
        {"1 1 1\n2 2 2\n3 3 3\n4 4 4\n", "all 4 points lie on one line"},
        {"1 1 1\n2 1 1\n3 1 7\n4 1 4\n5 1 -1e6\n", "all 5 points lie in one plane"},
        {"1 0 0\n0 1 0\n0 0 1\n1 1 -1\n0.5 0.25 0.25\n", "all 5 points lie in one plane"},
        {"0 0 0\n1 0 0\n0 1 0\n0 0 1e-6\n", NULL},
        {"1e30 0 0\n-1e30 0 0\n0 1e30 0\n0 0 1e30\n", NULL},
        {"1e-30 0 0\n-1e-30 0 0\n0 1e-30 0\n0 0 1e-30\n", NULL},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        mem m;
        plc x;
        plc_report report;
        assert_int_equal(read_file(scratch_text("t.csv", cases[i].text), NULL, &x, &m), ST_OK);
        assert_int_equal(plc_clean(&x, true, &report), ST_OK);
        const status st = plc_check_solid(&x, "t.csv");
        if (st != (cases[i].said ? ST_CORRUPT : ST_OK) ||
            (cases[i].said && !strstr(status_text(), cases[i].said)))
            fail_msg("case %zu: %d \"%s\"", i, (int)st, status_text());
        end(&x, &m);
    }
}

/* Words and records cross the buffer's end at all places. */
static void test_long(void **state) {
    (void)state;
    enum { POINTS = 30000 };
    char *text = malloc((size_t)POINTS * 60);
    int n = sprintf(text, "id x y z\n");
    for (int i = 0; i < POINTS; i++)
        n += sprintf(text + n, "%d %.*f %d.25 -%d\n", 3 * i, i % 17, i / 8.0, i, i);
    mem m;
    plc x;
    assert_int_equal(read_file(scratch_text("l.csv", text), NULL, &x, &m), ST_OK);
    free(text);
    assert_int_equal(x.points.count, POINTS);
    for (uint32_t i = 0; i < POINTS; i++) {
        assert_true(plc_point(&x, i)[1] == i + 0.25 && plc_point(&x, i)[2] == -(double)i);
        assert_true(((const double *)x.values.data)[i] == 3 * i);
    }
    plc_report report;
    assert_int_equal(plc_clean(&x, true, &report), ST_OK);
    assert_int_equal(report.welded, 0);
    end(&x, &m);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tables),       cmocka_unit_test(test_tables_refused),
        cmocka_unit_test(test_off),          cmocka_unit_test(test_ply),
        cmocka_unit_test(test_ply_refused),  cmocka_unit_test(test_stl),
        cmocka_unit_test(test_poly),         cmocka_unit_test(test_poly_holes),
        cmocka_unit_test(test_poly_refused), cmocka_unit_test(test_clean),
        cmocka_unit_test(test_floats),       cmocka_unit_test(test_solid),
        cmocka_unit_test(test_long),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
