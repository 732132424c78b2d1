/* test_mesh_vtu.c - VTK XML grids: every coding, pieces, fields; refusals that name the line; cut
 * and damaged files; faults; memory that does not grow.
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

#include "tests/support/mesh_files.h"
#include "tests/support/scratch.h"
#include "tests/support/vtk_files.h"

/* ---- what is read ---- */

static const vtk_xml_style styles[] = {
    {.text = true},
    {.block = 0},
    {.split_head = true, .head64 = true},
    {.block = 64},
    {.block = 48, .head64 = true, .big_endian = true},
    {.appended = true},
    {.appended = true, .block = 4096, .head64 = true},
    {.appended = true, .raw = true, .big_endian = true},
    {.appended = true, .raw = true, .head64 = true},
    {.appended = true, .raw = true, .block = 24},
    {.appended = true, .raw = true, .block = 100, .head64 = true, .big_endian = true},
    {.block = 64, .packing = VTK_WRITER_LZ4},
    {.appended = true, .raw = true, .block = 128, .packing = VTK_WRITER_LZ4, .head64 = true},
    {.appended = true, .block = 100, .packing = VTK_WRITER_LZMA, .big_endian = true},
};

enum { STYLES = sizeof styles / sizeof *styles };

static void test_codings(void **state) {
    (void)state;
    for (int i = 0; i < STYLES; i++) {
        const char *path = vtk_files_xml("a.vtu", &styles[i]);
        const mesh_copy *a = mesh_files_good(path, NULL);
        vtk_files_check(a, 1, "alpha", 0);
        assert_string_equal(a->name, "");
        vtk_files_check(mesh_files_good(path, &(mesh_hints){.field = "n"}), 1, "n", 0);
    }
}

static void test_types(void **state) {
    (void)state;
    static const char *const whole[] = {"Int8",  "UInt8",  "Int16", "UInt16",
                                        "Int32", "UInt32", "Int64", "UInt64"};
    for (size_t i = 0; i < sizeof whole / sizeof *whole; i++)
        for (int big = 0; big < 2; big++) {
            vtk_xml_style s = {.appended = true, .raw = true, .big_endian = big};
            s.whole = whole[i];
            s.real = big ? "Float32" : "Float64";
            const char *path = vtk_files_xml("a.vtu", &s);
            vtk_files_check(mesh_files_good(path, &(mesh_hints){.field = "n"}), 1, "n", 0);
        }
}

static void test_fields(void **state) {
    (void)state;
    static const struct {
        const char *field;
        int component;
        bool of_cells;
    } cases[] = {{"v", 0, false}, {"v", 1, false}, {"v", 3, false}, {"alpha", 1, false},
                 {"q", 0, true},  {"w", 0, true},  {"w", 2, true}};
    for (int i = 0; i < STYLES; i++)
        for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
            const mesh_hints hints = {.field = cases[k].field,
                                      .component = cases[k].component,
                                      .cells_to_points = cases[k].of_cells};
            const char *path = vtk_files_xml("a.vtu", &styles[i]);
            vtk_files_check(mesh_files_good(path, &hints), 1, cases[k].field, cases[k].component);
        }
    const char *path = vtk_files_xml("a.vtu", &styles[0]);
    vtk_files_check(mesh_files_good(path, &(mesh_hints){.cells_to_points = true}), 1, "q", 0);
}

static void test_pieces(void **state) {
    (void)state;
    for (int i = 0; i < STYLES; i++)
        for (int pieces = 2; pieces <= 3; pieces++) {
            vtk_xml_style s = styles[i];
            s.pieces = pieces;
            const char *path = vtk_files_xml("a.vtu", &s);
            vtk_files_check(mesh_files_good(path, NULL), pieces, "alpha", 0);
            const mesh_hints cells = {.field = "w", .cells_to_points = true};
            vtk_files_check(mesh_files_good(path, &cells), pieces, "w", 0);
        }
    /* A piece without points, as parallel writers leave them. */
    vtk_xml_style s = {.text = true, .pieces = 2};
    const char *empty = "<Piece NumberOfPoints=\"0\" NumberOfCells=\"0\"></Piece>\n<Piece ";
    const char *path = vtk_files_patch(vtk_files_xml("a.vtu", &s), "<Piece ", empty);
    vtk_files_check(mesh_files_good(path, NULL), 2, "alpha", 0);
}

/* A mesh without any array but its geometry. */
static const char bare[] =
    "<VTKFile type='UnstructuredGrid'><UnstructuredGrid>\n"
    "<Piece NumberOfPoints='5' NumberOfCells='2'>\n"
    "<Points><DataArray type='Float64' NumberOfComponents='3'>\n"
    "0 0 0 1 0 0 0 1 0 0 0 1e-3 1 +1 1.5E+0\n"
    "</DataArray></Points><Cells>\n"
    "<DataArray type='Int64' Name='connectivity'>0 1 2 3 4 3 2 1</DataArray>\n"
    "<DataArray type='Int64' Name='offsets'>4 8</DataArray>\n"
    "<DataArray type='UInt8' Name='types'>10 10</DataArray>\n"
    "</Cells></Piece></UnstructuredGrid></VTKFile>\n";

static void test_bare(void **state) {
    (void)state;
    const mesh_copy *a = mesh_files_good(scratch_text("bare.vtu", bare), NULL);
    assert_int_equal(a->report.points, 5);
    assert_int_equal(a->report.tets, 2);
    assert_string_equal(a->report.field, "");
    assert_true(a->values[4] == 0 && a->xyz[3][2] == 1e-3f && a->xyz[4][2] == 1.5f);
    /* Recognised by what is in it, too. */
    assert_true(mesh_files_recognised(scratch_text("bare.xml", bare)));
    assert_true(mesh_files_recognised(scratch_text("odd.vtu", "?")));
    assert_int_equal(mesh_files_good(scratch_text("bare.xml", bare), NULL)->report.tets, 2);
}

/* Cells with ids that are no points, and with a vertex twice, are left out and counted. */
static void test_bad_ids(void **state) {
    (void)state;
    const char *path = scratch_text("bare.vtu", bare);
    static const char *const bad[] = {"0 1 2 5", "0 1 2 -1", "0 1 2 4294967296",
                                      "0 1 2 99999999999999999999"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        const char *changed = vtk_files_patch(path, "0 1 2 3 4", "%1 4");
        changed = vtk_files_patch(changed, "%1", bad[i]);
        const mesh_copy *a = mesh_files_good(changed, NULL);
        assert_int_equal(a->report.tets, 1);
        assert_int_equal(a->report.bad_indices, 1);
    }
    const mesh_copy *a = mesh_files_good(vtk_files_patch(path, "0 1 2 3 4", "0 1 2 2 4"), NULL);
    assert_int_equal(a->report.tets, 1);
    assert_int_equal(a->report.repeated, 1);
    /* An id is one of its own piece. */
    vtk_xml_style s = {.text = true, .pieces = 2};
    path = vtk_files_patch(vtk_files_xml("a.vtu", &s), " 4 15\n", " 4 16\n");
    a = mesh_files_good(path, NULL);
    assert_int_equal(a->report.bad_indices, 1);
    assert_int_equal(a->report.tets, 2 * VTK_FILES_TETS - 1);
    /* Nor does such a cell take part in averages. */
    a = mesh_files_good(path, &(mesh_hints){.field = "q", .cells_to_points = true});
    assert_true(isnan(a->values[15]) && a->values[15 + 16] == 0.75f * 8 + 101);
}

static void test_not_finite(void **state) {
    (void)state;
    vtk_xml_style s = {.text = true};
    const char *path = vtk_files_xml("a.vtu", &s);
    const mesh_copy *a = mesh_files_good(vtk_files_patch(path, "-1.75 ", "NaN "), NULL);
    assert_true(isnan(a->values[1]));
    a = mesh_files_good(vtk_files_patch(path, "-1.75 ", "-inf "), NULL);
    assert_true(isinf(a->values[1]));
    mesh_files_refused(vtk_files_patch(path, "1.5 0 1.5", "1.5 nan 1.5"), NULL, ST_CORRUPT,
                       "point 13 (counted from 0)");
}

/* ---- what is refused ---- */

static void refused(const char *path, const char *from, const char *to, status st,
                    const char *said) {
    mesh_files_refused(vtk_files_patch(path, from, to), NULL, st, said);
}

static void test_structure(void **state) {
    (void)state;
    const char *a = vtk_files_xml("a.vtu", &(vtk_xml_style){.text = true});
    refused(a, "<VTKFile", "<File", ST_CORRUPT, "line 2: <File>, expected <VTKFile>");
    refused(a, "\"UnstructuredGrid\"", "\"ImageData\"", ST_UNSUPPORTED,
            "this is VTK image data (.vti), which is not read here");
    refused(a, "type=\"UnstructuredGrid\" ", "", ST_CORRUPT, "UnstructuredGrid is supported");
    refused(a, "LittleEndian", "MiddleEndian", ST_CORRUPT, "expected LittleEndian or BigEndian");
    refused(a, "UInt32", "UInt16", ST_CORRUPT, "expected UInt32 or UInt64");
    refused(a, "header_type", "compressor=\"vtkPackedDataCompressor\" header_type", ST_UNSUPPORTED,
            "those of zlib, LZ4 and LZMA are supported");
    refused(a, "NumberOfPoints=\"16\"", "", ST_CORRUPT, "expected the attribute NumberOfPoints");
    refused(a, "NumberOfCells=\"9\"", "NumberOfCells=\"-9\"", ST_CORRUPT,
            "expected a whole number from 0 on");
    refused(a, "NumberOfPoints=\"16\"", "NumberOfPoints=\"17\"", ST_CORRUPT,
            "has 48 numbers, expected 49");
    refused(a, "NumberOfPoints=\"16\"", "NumberOfPoints=\"4294967295\"", ST_UNSUPPORTED,
            "more than 4294967294 points");
    refused(a, "<Points>", "<Nodes>", ST_CORRUPT, "mismatched tag");
    refused(a, "Points\" NumberOfComponents=\"3\"", "Points\" NumberOfComponents=\"2\"", ST_CORRUPT,
            "2 components, expected 3");
    refused(a, "</Points>", "<DataArray type=\"Int8\"/></Points>", ST_CORRUPT,
            "the points come twice");
    refused(a, "\"types\"", "\"offsets\"", ST_CORRUPT, "offsets comes twice");
    refused(a, "\"types\"", "\"kinds\"", ST_CORRUPT, "expected the types of its cells");
    refused(a, "\"offsets\"", "\"ends\"", ST_CORRUPT, "expected the offsets of its cells");
    refused(a, "\"connectivity\"", "\"faces\"", ST_CORRUPT, "expected the points of its cells");
    refused(a, "\"Float64\" Name=\"alpha\"", "\"Float16\" Name=\"alpha\"", ST_CORRUPT,
            "line 7: type=\"Float16\"");
    refused(a, "format=\"ascii\">\n", "format=\"hex\">\n", ST_CORRUPT, "line 7: format=\"hex\"");
    refused(a, "NumberOfComponents=\"1\"", "NumberOfComponents=\"x\"", ST_CORRUPT, "\"x\"");
    mesh_files_refused(scratch_text("b.vtu", ""), NULL, ST_CORRUPT, "expected XML");
    mesh_files_refused(scratch_text("b.vtu", "<VTKFile type='UnstructuredGrid'/>"), NULL,
                       ST_CORRUPT, "expected a Piece");
    refused(a, "?>", "?><!DOCTYPE VTKFile [<!ENTITY a \"b\">]>", ST_UNSUPPORTED, "document type");
}

static void test_numbers(void **state) {
    (void)state;
    const char *a = vtk_files_xml("a.vtu", &(vtk_xml_style){.text = true});
    refused(a, "-1.75 ", "-1.75x ", ST_CORRUPT, "line 7: array \"alpha\": before byte");
    refused(a, "-1.75 ", "-1.75x ", ST_CORRUPT, "\"-1.75x\", expected a number");
    refused(a, "-1.75 ", " ", ST_CORRUPT, "has 15 numbers, expected 16");
    refused(a, "-1.75 ", "1 2 ", ST_CORRUPT, "behind its last number, expected 16");
    refused(a, "-1.75 ", "<b/>", ST_CORRUPT, "has 1 numbers, expected 2");
    refused(a, "-1.75 ", "1e999 ", ST_CORRUPT, "expected a number");
    char longest[300];
    snprintf(longest, sizeof longest, "%0280d ", 1);
    refused(a, "-1.75 ", longest, ST_CORRUPT, "no text at byte");
    refused(a, "0 1 4 3", "0 1.5 4 3", ST_CORRUPT, "\"1.5\", expected a whole number");
    refused(a, "\"Int32\" Name=\"connectivity\"", "\"Float32\" Name=\"connectivity\"", ST_CORRUPT,
            "expected whole numbers");
    /* Cells end at 8 11 19 20 25 27 33 38 42; their types are 12 5 11 1 14 3 13 7 10. */
    refused(a, "8 11 19", "8 7 19", ST_CORRUPT, "cell 1 (counted from 0) ends at 7, expected 8");
    refused(a, "8 11 19", "8 -1 19", ST_CORRUPT, "ends at -1");
    refused(a, "8 11 19", "7 11 19", ST_CORRUPT, "of type 12 has 7 points, expected 8");
    refused(a, "38 42", "38 43", ST_CORRUPT, "of type 10 has 5 points, expected 4");
    refused(a, "33 38 42", "33 38", ST_CORRUPT, "has 8 numbers, expected 9");
    refused(a, "\n12 5", "\n24 5", ST_UNSUPPORTED, "quadratic tetrahedron");
    refused(a, "\n12 5", "\n42 5", ST_CORRUPT, "cell 0 (counted from 0) is a polyhedron");
    refused(a, "\n12 5", "\n99 5", ST_CORRUPT, "expected a cell type of VTK");
    refused(a, "\n12 5", "\n-1 5", ST_CORRUPT, "expected a cell type of VTK");
    refused(a, "\n12 5", "\n17 5", ST_CORRUPT, "of type 17");
    /* A connectivity that goes on behind the last cell. */
    refused(a, "0 1 4 15", "0 1 4 15 7", ST_CORRUPT, "behind its last number, expected 42");
}

static void test_fields_refused(void **state) {
    (void)state;
    const char *a = vtk_files_xml("a.vtu", &(vtk_xml_style){.text = true, .pieces = 2});
    mesh_files_refused(a, &(mesh_hints){.field = "beta"}, ST_USAGE,
                       "no array \"beta\" of the points, which have \"alpha\", \"v\", \"n\"");
    mesh_files_refused(a, &(mesh_hints){.field = "q"}, ST_USAGE,
                       "the cells have \"q\", \"w\" (--cells-to-points takes them");
    mesh_files_refused(a, &(mesh_hints){.field = "v", .cells_to_points = true}, ST_USAGE,
                       "of the cells, which have \"q\", \"w\"");
    mesh_files_refused(a, &(mesh_hints){.field = "v", .component = 4}, ST_USAGE,
                       "no component 4 but 1 to 3");
    mesh_files_refused(a, &(mesh_hints){.component = -1}, ST_USAGE, "no component -1");
    refused(a, "\"alpha\"", "\"beta\"", ST_CORRUPT, "piece 2 has no array \"beta\"");
    /* Strings are no values. */
    const char *b = vtk_files_patch(a, "\"Float64\" Name=\"alpha\"", "\"String\" Name=\"alpha\"");
    assert_string_equal(mesh_files_good(b, NULL)->report.field, "v");
    mesh_files_refused(b, &(mesh_hints){.field = "alpha"}, ST_UNSUPPORTED,
                       "strings and packed bits");
    refused(a, "Name=\"alpha\" NumberOfComponents=\"1\"", "Name=\"alpha\" NumberOfComponents=\"2\"",
            ST_CORRUPT, "1 components, expected 2 as in the first piece");
}

static void test_appended(void **state) {
    (void)state;
    const vtk_xml_style s = {.appended = true, .raw = true, .block = 64};
    const char *a = vtk_files_xml("a.vtu", &s);
    refused(a, "offset=\"0\"", "", ST_CORRUPT, "line 7: expected the attribute offset");
    refused(a, "offset=\"0\"", "offset=\"99999\"", ST_CORRUPT, "ends at byte");
    refused(a, "offset=\"0\"", "offset=\"1\"", ST_CORRUPT, "line 7: array \"alpha\"");
    refused(a, "encoding=\"raw\"", "encoding=\"hex\"", ST_CORRUPT, "expected raw or base64");
    refused(a, " _", " x", ST_CORRUPT, "expected the '_' of the appended data");
    refused(a, "AppendedData", "OtherData", ST_CORRUPT, "expected XML");
    refused(a, "compressor=\"vtkZLibDataCompressor\"", "", ST_CORRUPT,
            "points: has 6 bytes, expected a multiple of 8");
    const vtk_xml_style text = {.appended = true};
    a = vtk_files_xml("a.vtu", &text);
    char *data = scratch_read(a, NULL);
    *strstr(data, "<AppendedData") = 0;
    strcat(data, "</VTKFile>");
    mesh_files_refused(scratch_text("b.vtu", data), NULL, ST_CORRUPT, "without AppendedData");
    free(data);
}

static void test_base64(void **state) {
    (void)state;
    const char *a = vtk_files_xml("a.vtu", &(vtk_xml_style){.split_head = true});
    /* alpha's head is 128: gAAAAA==. */
    refused(a, "gAAAAA==", "gAAA?A==", ST_CORRUPT, "expected base64");
    refused(a, "gAAAAA==", "=AAAAA==", ST_CORRUPT, "expected base64");
    refused(a, "gAAAAA==", "gAAAA=A=", ST_CORRUPT, "expected base64");
    refused(a, "gAAAAA==", "iAAAAA==", ST_CORRUPT, "has 17 numbers, expected 16");
    refused(a, "gAAAAA==", "gQAAAA==", ST_CORRUPT, "expected a multiple of 8");
    refused(a, "gAAAAA==", "", ST_CORRUPT, "array \"alpha\"");
    refused(a, "gAAAAA==", "gAAAAA==\n</DataArray><DataArray type=\"Int8\" Name=\"x\">", ST_CORRUPT,
            "array \"alpha\": ends before byte");
    refused(a, "gAAAAA==", "gAAAAA==QQ\n</DataArray><DataArray type=\"Int8\" Name=\"x\">",
            ST_CORRUPT, "ends inside a group");
}

typedef struct block_case {
    int word; /* of the head of "alpha" */
    uint32_t value;
    const char *said;
} block_case;

static void refuse_blocks(vtk_writer_packing packing, const block_case *cases, size_t count) {
    const vtk_xml_style s = {.appended = true, .raw = true, .block = 64, .packing = packing};
    size_t size;
    char *data = scratch_read(vtk_files_xml("a.vtu", &s), &size);
    char *head = (char *)memmem(data, size, " _", 2) + 2;
    for (size_t i = 0; i < count; i++) {
        uint32_t kept;
        memcpy(&kept, head + 4 * cases[i].word, 4);
        memcpy(head + 4 * cases[i].word, &cases[i].value, 4);
        mesh_files_refused(scratch_write("b.vtu", data, size), NULL, ST_CORRUPT, cases[i].said);
        memcpy(head + 4 * cases[i].word, &kept, 4);
    }
    /* One byte more for the first block: it begins the second. */
    head[12]++;
    mesh_files_refused(scratch_write("b.vtu", data, size), NULL, ST_CORRUPT,
                       packing ? "block 1 before" : "bytes follow its end");
    free(data);
}

/* Blocks whose head does not say what is in them. */
static void test_blocks(void **state) {
    (void)state;
    static const block_case zlib[] = {
        {0, 3, "array \"alpha\": has 24 numbers, expected 16"},
        {0, 0xffffffff, "expected 17179869180 more of its table of blocks"},
        {1, 0, "no sound head"},
        {1, 32, "numbers, expected 16"},
        {2, 65, "no sound head"},
        {2, 8, "has 9 numbers"},
        {3, 0, "ends too early"},
        {3, 5, "ends too early"},
        {4, 1000000, "more of its blocks"},
    };
    static const block_case lz4[] = {
        {0, 3, "array \"alpha\": has 24 numbers, expected 16"},
        {0, 0xffffffff, "expected 17179869180 more of its table of blocks"},
        {1, 0x7fffffff, "too early for the"},
        {2, 8, "has 9 numbers"},
        {3, 0, "its length is not one of so many bytes"},
        {3, 5, "damaged LZ4 block 1 before byte"},
        {4, 1000000, "its length is not one of so many bytes"},
    };
    static const block_case lzma[] = {
        {2, 8, "has 9 numbers"},
        {3, 0, "its length is not one of so many bytes"},
        {3, 5, "damaged LZMA block 1 before byte"},
        {4, 1000000, "its length is not one of so many bytes"},
    };
    refuse_blocks(VTK_WRITER_ZLIB, zlib, sizeof zlib / sizeof *zlib);
    refuse_blocks(VTK_WRITER_LZ4, lz4, sizeof lz4 / sizeof *lz4);
    refuse_blocks(VTK_WRITER_LZMA, lzma, sizeof lzma / sizeof *lzma);
}

static void test_limits(void **state) {
    (void)state;
    char *deep = malloc(4 << 20), *at = deep;
    at += sprintf(at, "<VTKFile type='UnstructuredGrid'>");
    for (int i = 0; i < 100; i++)
        at += sprintf(at, "<a>");
    mesh_files_refused(scratch_text("b.vtu", deep), NULL, ST_CORRUPT, "more than 64 elements");
    at = deep + sprintf(deep, "<VTKFile type='");
    memset(at, 'x', 3 << 20);
    at[3 << 20] = 0;
    mesh_files_refused(scratch_text("b.vtu", deep), NULL, ST_CORRUPT, "a tag of more than");
    free(deep);
}

static void test_pipe(void **state) {
    (void)state;
    const char *a = vtk_files_xml("a.vtu", &styles[0]);
    int kept = dup(STDIN_FILENO);
    assert_non_null(freopen(a, "rb", stdin));
    mesh_files_refused("-", NULL, ST_UNSUPPORTED, "standard input: VTK files are read at several");
    dup2(kept, STDIN_FILENO);
    close(kept);
}

/* ---- sweeps ---- */

/* Behind the last byte that must be there: raw appended data need no tags behind them. */
static size_t needed(const char *data, size_t size) {
    const char *appended = memmem(data, size, "\n</AppendedData>", 16);
    const char *last = appended ? appended : memmem(data, size, "</VTKFile>", 10);
    return (size_t)(last - data);
}

static void test_cut(void **state) {
    (void)state;
    const mesh_hints hints = {.field = "alpha"};
    for (int i = 0; i < STYLES; i++) {
        const mesh_copy *a;
        size_t size;
        char *data = scratch_read(vtk_files_xml("a.vtu", &styles[i]), &size);
        size_t end = needed(data, size) - (styles[i].appended ? 4 : 0);
        for (size_t n = (size_t)i; n < end; n += n + 40 < end ? 11 : 1) {
            status st = mesh_files_read(scratch_write("cut.vtu", data, n), &hints, &a);
            if (st != ST_CORRUPT)
                fail_msg("style %d cut to %zu of %zu bytes: status %d", i, n, size, (int)st);
        }
        free(data);
    }
}

/* Any byte changed gives an error or a mesh that keeps mesh_input.h's promises. */
static void test_damage(void **state) {
    (void)state;
    static const char masks[] = {1, 0x10, (char)0xff};
    for (int i = 0; i < STYLES; i++) {
        const mesh_copy *a;
        size_t size, noticed = 0, all = 0;
        char *data = scratch_read(vtk_files_xml("a.vtu", &styles[i]), &size);
        for (size_t n = (size_t)i; n < size; n += 7, all++) {
            char mask = masks[n % 3];
            data[n] ^= mask;
            noticed += mesh_files_read(scratch_write("bad.vtu", data, size), NULL, &a) != ST_OK;
            data[n] ^= mask;
        }
        /* Names, fields not asked for, digits: much may change unnoticed. */
        if (noticed < all / 10)
            fail_msg("style %d: %zu of %zu changes noticed", i, noticed, all);
        free(data);
    }
}

static void test_faults(void **state) {
    (void)state;
    for (int i = 0; i < STYLES; i++) {
        mesh_hints hints = {.cells_to_points = i % 2};
        mesh_files_faults(vtk_files_xml("a.vtu", &styles[i]), &hints);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_codings),    cmocka_unit_test(test_types),
        cmocka_unit_test(test_fields),     cmocka_unit_test(test_pieces),
        cmocka_unit_test(test_bare),       cmocka_unit_test(test_bad_ids),
        cmocka_unit_test(test_not_finite), cmocka_unit_test(test_structure),
        cmocka_unit_test(test_numbers),    cmocka_unit_test(test_fields_refused),
        cmocka_unit_test(test_appended),   cmocka_unit_test(test_base64),
        cmocka_unit_test(test_blocks),     cmocka_unit_test(test_limits),
        cmocka_unit_test(test_pipe),       cmocka_unit_test(test_cut),
        cmocka_unit_test(test_damage),     cmocka_unit_test(test_faults),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
