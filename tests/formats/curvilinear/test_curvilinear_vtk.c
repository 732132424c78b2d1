/* test_curvilinear_vtk.c - structured grids of VTK that are curvilinear, XML and legacy, in every
 * coding, of one and of two pieces; which are regular grids rather; refusals, cut and changed
 * files, faults.
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
#include "formats/curvilinear/curvilinear_input.h"
#include "formats/curvilinear/curvilinear_input_kind.h"
#include "formats/grid/volume_kind.h"
#include "formats/input_open.h"
#include "tests/support/scratch.h"
#include "tests/support/vtk_files.h"
#include "tests/support/vtk_writer.h"

enum { I = 4, J = 3, K = 5, SECOND = 3, ROOM = I * J * K };

static const vtk_xml_style codings[] = {
    {.text = true},
    {.big_endian = true},
    {.split_head = true, .head64 = true},
    {.appended = true},
    {.appended = true, .raw = true, .big_endian = true},
    {.block = 48},
    {.appended = true, .block = 100, .packing = VTK_WRITER_LZ4},
    {.appended = true, .raw = true, .block = 64, .packing = VTK_WRITER_LZMA, .head64 = true}};
enum { CODINGS = sizeof codings / sizeof *codings };

/* What a file has. The second piece has SECOND nodes along i, and values 1000 higher. */
typedef struct form {
    const vtk_xml_style *style;
    const char *type; /* of points and "s" */
    int pieces;
    bool marks, straight; /* straight: the nodes of a regular grid */
    const char *cells;    /* an array of the cells, of zeros but for its last; NULL: none */
    bool first_cell;      /* the first, in place of the last */
    int cell_mark;        /* the last; 0: 32 */
} form;

static int nodes_of(int piece) {
    return (piece ? SECOND : I) * J * K;
}

static double place(const form *f, int piece, int node, int axis) {
    const int ni = piece ? SECOND : I;
    const int at[3] = {node % ni + piece * (I - 1), node / ni % J, node / ni / J};
    const double bend = f->straight ? 0 : 0.1 * at[0] * at[0] + 1e-9 * at[2];
    return at[axis] + (axis == 1 ? bend : 0);
}

static double value(int piece, int node) {
    return 1000 * piece + node;
}

static int mark_of(int piece, int node) {
    return (node + piece) % 5 == 0 ? 2 : (node + piece) % 3 == 0 ? 1 : 0;
}

static void fill(const form *f, int piece, double *xyz, double *s, double *v, double *marks) {
    for (int n = 0; n < nodes_of(piece); n++) {
        s[n] = value(piece, n);
        marks[n] = mark_of(piece, n);
        for (int a = 0; a < 3; a++) {
            xyz[3 * n + a] = place(f, piece, n, a);
            v[3 * n + a] = (a == 0 ? 3 : a == 1 ? 4 : 12) * value(piece, n);
        }
    }
}

static void write_piece(vtk_writer *w, const form *f, int piece) {
    double xyz[3 * ROOM], s[ROOM], v[3 * ROOM], marks[ROOM], cells[ROOM] = {0};
    const size_t count = (size_t)nodes_of(piece);
    const int cell_count = ((piece ? SECOND : I) - 1) * (J - 1) * (K - 1);
    fill(f, piece, xyz, s, v, marks);
    fprintf(w->out, "<Piece Extent=\"%d %d 0 %d 7 %d\"><PointData>", piece ? I - 1 : 0,
            piece ? I + SECOND - 2 : I - 1, J - 1, K + 6);
    if (f->marks)
        vtk_writer_array(w, "vtkGhostType", "UInt8", 1, count, marks);
    vtk_writer_array(w, "s", f->type, 1, count, s);
    vtk_writer_array(w, "v", "Float64", 3, 3 * count, v);
    fprintf(w->out, "</PointData><CellData>");
    cells[f->first_cell ? 0 : cell_count - 1] = f->cell_mark ? f->cell_mark : 32;
    if (f->cells)
        vtk_writer_array(w, f->cells, "UInt8", 1, (size_t)cell_count, cells);
    fprintf(w->out, "</CellData><Points>");
    vtk_writer_array(w, "Points", f->type, 3, 3 * count, xyz);
    fprintf(w->out, "</Points></Piece>");
}

static const char *write_xml(const form *f) {
    vtk_writer w;
    vtk_writer_begin(&w, "StructuredGrid", f->style);
    fprintf(w.out, "<StructuredGrid WholeExtent=\"0 %d 0 %d 7 %d\">",
            f->pieces > 1 ? I + SECOND - 2 : I - 1, J - 1, K + 6);
    for (int p = 0; p < f->pieces; p++)
        write_piece(&w, f, p);
    fprintf(w.out, "</StructuredGrid>");
    return vtk_writer_end(&w, "a.vts");
}

static const char *write_legacy(const form *f, bool text) {
    vtk_writer w = {.style = NULL};
    double xyz[3 * ROOM], s[ROOM], v[3 * ROOM], marks[ROOM];
    fill(f, 0, xyz, s, v, marks);
    vtk_writer_open(&w);
    const char *type = strcmp(f->type, "Float64") == 0 ? "double" : "float";
    fprintf(w.out, "# vtk DataFile Version 3.0\nt\n%s\nDATASET STRUCTURED_GRID\n",
            text ? "ASCII" : "BINARY");
    fprintf(w.out, "DIMENSIONS %d %d %d\nPOINTS %d %s\n", I, J, K, ROOM, type);
    vtk_writer_numbers(w.out, text, f->type, 3 * ROOM, xyz);
    fprintf(w.out, "\nPOINT_DATA %d\n", ROOM);
    if (f->marks) {
        fprintf(w.out, "SCALARS vtkGhostType unsigned_char 1\nLOOKUP_TABLE default\n");
        vtk_writer_numbers(w.out, text, "UInt8", ROOM, marks);
        fprintf(w.out, "\n");
    }
    fprintf(w.out, "SCALARS s %s 1\nLOOKUP_TABLE default\n", type);
    vtk_writer_numbers(w.out, text, f->type, ROOM, s);
    fprintf(w.out, "\nVECTORS v double\n");
    vtk_writer_numbers(w.out, text, "Float64", 3 * ROOM, v);
    fprintf(w.out, "\n");
    return vtk_writer_close(&w, "a.vtk");
}

/* ---- reading ---- */

static status read_all(const char *path, const curvilinear_hints *hints) {
    static float places[1 << 12][3], values[1 << 12];
    static uint8_t is_node[1 << 12];
    mem m;
    mem_init(&m, 0);
    curvilinear_input *x = NULL;
    status_describe(ST_OK, "%s", "");
    status st = curvilinear_input_open(&m, path, hints, &x);
    const curvilinear_source *s = st == ST_OK ? curvilinear_input_source(x) : NULL;
    for (uint32_t z = 0; st == ST_OK && z < s->zones; z++)
        for (uint32_t k = 0; st == ST_OK && k < s->nodes[z][2]; k++) {
            st = (uint64_t)s->nodes[z][0] * s->nodes[z][1] > 1 << 12 ? ST_FAILED : ST_OK;
            if (st == ST_OK)
                st = s->places(s->own, z, k, 1, places);
            if (st == ST_OK)
                st = s->values(s->own, z, 0, k, 1, values);
            if (st == ST_OK && s->blanked)
                st = s->blanks(s->own, z, k, 1, is_node);
        }
    curvilinear_input_close(x);
    assert_int_equal(mem_used(&m), 0);
    assert_true(st == ST_OK || st == ST_FAILED || status_text()[0]);
    return st;
}

static void refused(const char *path, status want, const char *said) {
    const status st = read_all(path, NULL);
    if (st != want || !strstr(status_text(), said))
        fail_msg("status %d, expected %d; \"%s\", expected \"%s\"", st, want, status_text(), said);
}

static void check_planes(const form *f, const curvilinear_source *s, int piece, int first,
                         int count) {
    float places[ROOM][3], values[ROOM];
    uint8_t is_node[ROOM];
    const int plane = nodes_of(piece) / K, end = count * plane;
    const uint32_t z = (uint32_t)piece, k = (uint32_t)first, n = (uint32_t)count;
    if (s->places(s->own, z, k, n, places) != ST_OK)
        fail_msg("%s", status_text());
    for (int i = 0; i < end; i++)
        for (int a = 0; a < 3; a++)
            assert_true(places[i][a] == (float)place(f, piece, first * plane + i, a));
    static const double factors[] = {1, 4, 13}; /* as check_file() takes them */
    for (uint32_t field = 0; field < 3; field++) {
        assert_int_equal(s->values(s->own, z, field, k, n, values), ST_OK);
        for (int i = 0; i < end; i++)
            assert_true(values[i] == (float)(factors[field] * value(piece, first * plane + i)));
    }
    assert_int_equal(s->blanked, f->marks);
    if (f->marks)
        assert_int_equal(s->blanks(s->own, z, k, n, is_node), ST_OK);
    for (int i = 0; f->marks && i < end; i++)
        assert_int_equal(is_node[i], mark_of(piece, first * plane + i) != 2);
}

static void check_file(const form *f, const char *path, const char *format) {
    mem m;
    mem_init(&m, 0);
    curvilinear_input *x;
    if (curvilinear_input_open(&m, path, NULL, &x) != ST_OK)
        fail_msg("%s", status_text());
    static const char *const names[] = {"s", "v_y", "v"};
    assert_string_equal(curvilinear_input_format(x), format);
    assert_int_equal(curvilinear_input_fields(x), 2);
    assert_int_equal(curvilinear_input_take(x, names, 3), ST_OK);
    const curvilinear_source *s = curvilinear_input_source(x);
    assert_int_equal(s->zones, f->pieces);
    /* In order, then back, with steps over planes. */
    for (int p = 0; p < f->pieces; p++) {
        const uint32_t nodes[3] = {p ? SECOND : I, J, K};
        assert_memory_equal(s->nodes[p], nodes, sizeof nodes);
        for (int k = 0; k < K; k++)
            check_planes(f, s, p, k, 1);
    }
    for (int p = f->pieces; p-- > 0;) {
        check_planes(f, s, p, 0, K);
        check_planes(f, s, p, 0, 1);
        check_planes(f, s, p, 2, 2);
        check_planes(f, s, p, 1, 1);
        check_planes(f, s, p, 4, 1);
    }
    /* From zone to zone, each time further. */
    for (int k = 0; k < K; k++)
        check_planes(f, s, k % f->pieces, k, 1);
    curvilinear_input_close(x);
    assert_int_equal(mem_used(&m), 0);
}

static void test_codings(void **state) {
    (void)state;
    for (int c = 0; c < CODINGS; c++)
        for (int wide = 0; wide < 2; wide++)
            for (int pieces = 1; pieces <= 2; pieces++) {
                const form f = {.style = &codings[c],
                                .type = wide ? "Float64" : "Float32",
                                .pieces = pieces,
                                .marks = c % 2 == wide};
                check_file(&f, write_xml(&f), "VTK structured grid");
            }
}

static void test_legacy(void **state) {
    (void)state;
    for (int i = 0; i < 8; i++) {
        const form f = {.type = i & 1 ? "Float64" : "Float32", .pieces = 1, .marks = (i & 2) != 0};
        check_file(&f, write_legacy(&f, i & 4), "legacy VTK structured grid");
    }
}

/* Marks of cells: which of them hide the cell, in a piece alone and beside another. The last cell
 * of each piece has the mark. */
static void check_hidden(const char *name, int mark, int pieces, bool hidden, bool marks) {
    const form f = {.style = &codings[4],
                    .type = "Float32",
                    .pieces = pieces,
                    .marks = marks,
                    .cells = name,
                    .cell_mark = mark};
    mem m;
    mem_init(&m, 0);
    curvilinear_input *x;
    if (curvilinear_input_open(&m, write_xml(&f), NULL, &x) != ST_OK)
        fail_msg("%s", status_text());
    const curvilinear_source *s = curvilinear_input_source(x);
    assert_true(s->blanked);
    for (int z = 0; z < pieces; z++)
        for (uint32_t count = 1; count <= K; count++) {
            uint8_t is_node[ROOM];
            const uint32_t row = z ? SECOND : I, plane = row * J, first = K - count;
            assert_int_equal(s->blanks(s->own, (uint32_t)z, first, count, is_node), ST_OK);
            for (uint32_t n = 0; n < count * plane; n++) {
                const uint32_t node = n + first * plane;
                const bool at = node == row - 2 + row * (J - 2) + plane * (K - 2);
                const int blank = marks && mark_of(z, (int)node) == 2;
                assert_int_equal(is_node[n], blank ? 0 : at && hidden ? 3 : 1);
            }
        }
    curvilinear_input_close(x);
    assert_int_equal(mem_used(&m), 0);
}

static void test_hidden_cells(void **state) {
    (void)state;
    for (int pieces = 1; pieces <= 2; pieces++) {
        check_hidden("vtkGhostType", 32, pieces, true, false);
        check_hidden("vtkGhostType", 32, pieces, true, true);
        check_hidden("vtkGhostType", 8, pieces, true, false);
        check_hidden("vtkGhostType", 1, pieces, pieces > 1, false);
        check_hidden("vtkGhostType", 2 | 4 | 16, pieces, false, false);
        check_hidden("vtkGhostLevels", 2, pieces, pieces > 1, false);
    }
}

/* A regular grid stays one; what is curvilinear, or has no values, becomes curvilinear. */
static void test_kinds(void **state) {
    (void)state;
    for (int legacy = 0; legacy < 2; legacy++)
        for (int straight = 0; straight < 2; straight++) {
            const form f = {
                .style = &codings[5], .type = "Float64", .pieces = 1, .straight = straight};
            mem m;
            mem_init(&m, 0);
            input in;
            const char *path = legacy ? write_legacy(&f, false) : write_xml(&f);
            if (input_open(&m, path, NULL, &in) != ST_OK)
                fail_msg("%s", status_text());
            assert_ptr_equal(in.kind, straight ? &volume_kind : &curvilinear_input_kind);
            input_close(&in);
            assert_int_equal(mem_used(&m), 0);
        }
}

/* ---- pieces that are files, and collections ---- */

static const char *write_piece_file(const form *f, int piece) {
    vtk_writer w;
    vtk_writer_begin(&w, "StructuredGrid", f->style);
    fprintf(w.out, "<StructuredGrid WholeExtent=\"0 5 0 2 7 11\">");
    write_piece(&w, f, piece);
    fprintf(w.out, "</StructuredGrid>");
    return vtk_writer_end(&w, piece ? "p1.vts" : "p0.vts");
}

static const char second_piece[] = "<Piece Extent=\"3 5 0 2 7 11\" Source=\"p1.vts\"/>";
static const char *write_pieces(const form *f) {
    char text[1024];
    write_piece_file(f, 0);
    write_piece_file(f, 1);
    snprintf(text, sizeof text,
             "<VTKFile type=\"PStructuredGrid\"><PStructuredGrid WholeExtent=\"0 5 0 2 7 11\" "
             "GhostLevel=\"0\"><Piece Extent=\"0 -1 0 -1 0 -1\" Source=\"empty.vts\"/>"
             "<Piece Extent=\"0 3 0 2 7 11\" Source=\"p0.vts\"/>%s</PStructuredGrid></VTKFile>",
             second_piece);
    return scratch_text("a.pvts", text);
}

enum { WHOLE = I + SECOND - 1 };

/* The piece that a node of the whole is taken of, the last that has it; its number there. */
static int piece_of(int node, int *own) {
    const int i = node % WHOLE, row = node / WHOLE, piece = i >= I - 1;
    *own = piece ? i - (I - 1) + SECOND * row : i + I * row;
    return piece;
}

static void check_joined(const form *f, const curvilinear_source *s, uint32_t first,
                         uint32_t count) {
    float places[WHOLE * J * K][3], values[WHOLE * J * K];
    uint8_t is_node[WHOLE * J * K];
    const int plane = WHOLE * J;
    if (s->places(s->own, 0, first, count, places) != ST_OK)
        fail_msg("%s", status_text());
    assert_int_equal(s->values(s->own, 0, 1, first, count, values), ST_OK);
    assert_int_equal(s->blanked, f->marks || f->cells);
    if (s->blanked)
        assert_int_equal(s->blanks(s->own, 0, first, count, is_node), ST_OK);
    for (int n = 0; n < (int)count * plane; n++) {
        int own;
        const int piece = piece_of((int)first * plane + n, &own), row = piece ? SECOND : I;
        for (int a = 0; a < 3; a++)
            assert_true(places[n][a] == (float)place(f, piece, own, a));
        assert_true(values[n] == (float)(4 * value(piece, own)));
        /* The last cell of each piece: that of the first begins before the common plane. */
        const bool hidden = f->cells && own == row - 2 + row * (J - 2) + row * J * (K - 2);
        if (s->blanked)
            assert_int_equal(is_node[n], f->marks && mark_of(piece, own) == 2 ? 0 : hidden ? 3 : 1);
    }
}

static void test_pieces(void **state) {
    (void)state;
    for (int c = 0; c < CODINGS; c++) {
        const form f = {.style = &codings[c],
                        .type = "Float64",
                        .marks = c % 2,
                        .cells = c % 3 ? NULL : "vtkGhostType"};
        mem m;
        mem_init(&m, 0);
        input in;
        static const char *const names[] = {"s", "v_y"};
        if (input_open(&m, write_pieces(&f), NULL, &in) != ST_OK)
            fail_msg("%s", status_text());
        assert_ptr_equal(in.kind, &curvilinear_input_kind);
        assert_true(in.kind->traits(in.own) & INPUT_FILES);
        curvilinear_input *x = in.own;
        assert_int_equal(curvilinear_input_take(x, names, 2), ST_OK);
        const curvilinear_source *s = curvilinear_input_source(x);
        assert_int_equal(s->zones, 1);
        assert_memory_equal(s->nodes[0], ((const uint32_t[]){WHOLE, J, K}), 12);
        for (uint32_t k = 0; k < K; k++)
            check_joined(&f, s, k, 1);
        check_joined(&f, s, 0, K);
        check_joined(&f, s, 2, 3);
        check_joined(&f, s, 1, 2);
        input_close(&in);
        assert_int_equal(mem_used(&m), 0);
    }
}

/* A cell that begins where its piece does, at nodes that another piece ends with, which is read
 * later. */
static void test_pieces_hide(void **state) {
    (void)state;
    const form f = {
        .style = &codings[0], .type = "Float32", .cells = "vtkGhostType", .first_cell = true};
    write_pieces(&f);
    char text[1024];
    snprintf(text, sizeof text,
             "<VTKFile type=\"PStructuredGrid\"><PStructuredGrid WholeExtent=\"0 5 0 2 7 11\">%s"
             "<Piece Extent=\"0 3 0 2 7 11\" Source=\"p0.vts\"/></PStructuredGrid></VTKFile>",
             second_piece);
    mem m;
    mem_init(&m, 0);
    curvilinear_input *x;
    assert_int_equal(curvilinear_input_open(&m, scratch_text("b.pvts", text), NULL, &x), ST_OK);
    const curvilinear_source *s = curvilinear_input_source(x);
    uint8_t is_node[WHOLE * J];
    assert_int_equal(s->blanks(s->own, 0, 0, 1, is_node), ST_OK);
    for (int n = 0; n < WHOLE * J; n++)
        assert_int_equal(is_node[n], n == 0 || n == I - 1 ? 3 : 1);
    curvilinear_input_close(x);
    assert_int_equal(mem_used(&m), 0);
}

static void test_pieces_refused(void **state) {
    (void)state;
    form f = {.style = &codings[0], .type = "Float32"};
    const char *path = write_pieces(&f);
    assert_int_equal(read_all(path, NULL), ST_OK);
    refused(vtk_files_patch(path, second_piece, ""), ST_CORRUPT, "no piece has node 4 0 0");
    refused(vtk_files_patch(path, "Extent=\"3 5", "Extent=\"2 5"), ST_CORRUPT,
            "p1.vts: expected one piece of 4 x 3 x 5 nodes, as ");
    refused(vtk_files_patch(path, "Extent=\"3 5", "Extent=\"4 6"), ST_CORRUPT,
            "outside of WholeExtent");
    refused(vtk_files_patch(path, "Source=\"p1.vts\"", ""), ST_CORRUPT,
            "expected the attribute Source");
    refused(vtk_files_patch(path, "p1.vts", "p2.vts"), ST_IO, "p2.vts");
    refused(vtk_files_patch(path, "p1.vts", "../p1.vts"), ST_UNSUPPORTED, "p1.vts");
    refused(scratch_text("none.pvts", "<VTKFile type=\"PStructuredGrid\"><PStructuredGrid "
                                      "WholeExtent=\"0 5 0 2 7 11\"/></VTKFile>"),
            ST_CORRUPT, "it names no pieces");
    refused(vtk_files_patch(path, "WholeExtent=\"0 5 0 2 7 11\"", "WholeExtent=\"0 5 0 2 7 7\""),
            ST_UNSUPPORTED, "1 nodes along k");
    scratch_text("p2.vts", "<VTKFile type=\"PStructuredGrid\"></VTKFile>");
    refused(vtk_files_patch(path, "p1.vts", "p2.vts"), ST_UNSUPPORTED,
            "expected a structured grid");
    size_t size;
    char *bytes =
        scratch_read(vtk_files_patch(write_piece_file(&f, 1), "Name=\"s\"", "Name=\"t\""), &size);
    scratch_write("p1.vts", bytes, size);
    free(bytes);
    refused(path, ST_CORRUPT, "p1.vts: no array \"s\" of 1 components");
}

/* Steps: a file, then one in pieces. */
static void test_collection(void **state) {
    (void)state;
    const form f = {.style = &codings[1], .type = "Float32", .pieces = 1};
    const char *text =
        "<VTKFile type=\"Collection\"><Collection><DataSet timestep=\"2.5\" file=\"a.pvts\"/>"
        "<DataSet timestep=\"0.5\" file=\"a.vts\"/></Collection></VTKFile>";
    write_xml(&f);
    write_pieces(&f);
    const char *path = scratch_text("a.pvd", text);
    mem m;
    mem_init(&m, 0);
    input in;
    if (input_open(&m, path, &(input_hints){.curvilinear.step = 1}, &in) != ST_OK)
        fail_msg("%s", status_text());
    assert_ptr_equal(in.kind, &curvilinear_input_kind);
    assert_int_equal(in.kind->traits(in.own),
                     INPUT_ONE_LEVEL | INPUT_CHOICES | INPUT_FILES | INPUT_STEPS | INPUT_SERIES);
    curvilinear_input *x = in.own;
    const double *times;
    assert_int_equal(curvilinear_input_steps(x, &times), 2);
    assert_true(times[0] == 0.5 && times[1] == 2.5 && !curvilinear_input_still(x));
    static const char *const names[] = {"s", "v_y", "v"};
    for (int i = 0; i < 3; i++) {
        assert_int_equal(curvilinear_input_seek(x, i == 1 ? 0 : 1), ST_OK);
        assert_int_equal(curvilinear_input_take(x, names, 3), ST_OK);
        const curvilinear_source *s = curvilinear_input_source(x);
        assert_int_equal(s->nodes[0][0], i == 1 ? I : WHOLE);
        if (i == 1)
            check_planes(&f, s, 0, 0, K);
        else
            check_joined(&f, s, 0, K);
    }
    input_close(&in);
    assert_int_equal(mem_used(&m), 0);
    refused(vtk_files_patch(path, "2.5", "0.5"), ST_UNSUPPORTED, "several grids at one time");
    refused(vtk_files_patch(path, "a.pvts", "none.vts"), ST_IO, "none.vts");
    const curvilinear_hints hints = {.step = 2};
    assert_int_equal(read_all(path, &hints), ST_USAGE);
    scratch_text("x.vts", "<VTKFile type=\"ImageData\"></VTKFile>");
    refused(vtk_files_patch(path, "a.vts", "x.vts"), ST_UNSUPPORTED,
            "x.vts, expected a structured");
    static const fault_kind kinds[] = {FAULT_ALLOC, FAULT_READ};
    for (int i = 0; i < 2; i++)
        for (long k = 1, fired = 1; fired; k++) {
            fault_arm(kinds[i], k);
            const status st = read_all(path, &(curvilinear_hints){.step = 1});
            fired = fault_fired(kinds[i]);
            fault_arm(kinds[i], 0);
            assert_true(fired ? st != ST_OK : st == ST_OK && k > 10);
        }
}

/* ---- refusals ---- */

static void test_refused(void **state) {
    (void)state;
    form f = {.style = &codings[0], .type = "Float32", .pieces = 1};
    const char *path = write_xml(&f);
    refused(vtk_files_patch(path, "<Points>", "<Other>"), ST_CORRUPT, "mismatched");
    refused(vtk_files_patch(path, "<Piece Extent=\"0 3", "<Piece Extent=\"0 0"), ST_UNSUPPORTED,
            "piece 1 has 1 nodes along i, expected 2 to");
    refused(vtk_files_patch(path, "<Piece Extent=\"0 3", "<Piece Extent=\"0 4"), ST_CORRUPT, "");
    refused(vtk_files_patch(path, "<Piece Extent=\"0 3", "<Piece Extent=\"0 99999999"), ST_CORRUPT,
            "");
    refused(vtk_files_patch(path, "Name=\"Points\" NumberOfComponents=\"3\"",
                            "Name=\"Points\" NumberOfComponents=\"2\""),
            ST_CORRUPT, "2 components, expected 3 numbers");
    refused(vtk_files_patch(path, "Name=\"s\"", "Name=\"vtkGhostType\""), ST_CORRUPT,
            "expected a byte a point");
    f.pieces = 2;
    refused(vtk_files_patch(write_xml(&f), "Name=\"s\"", "Name=\"t\""), ST_CORRUPT,
            "piece 2 has no array \"t\"");
    f.cells = "vtkGhostType";
    refused(vtk_files_patch(write_xml(&f), "type=\"UInt8\" Name=\"vtkGhostType\"",
                            "type=\"Int16\" Name=\"vtkGhostType\""),
            ST_CORRUPT, "expected a byte a cell");
    f.cells = "other";
    assert_int_equal(read_all(write_xml(&f), NULL), ST_OK);
    char name[] = "q.bin", *names[] = {name};
    const curvilinear_hints hints = {.solutions = {names, 1}};
    assert_int_equal(read_all(path, &hints), ST_USAGE);
}

static void test_legacy_refused(void **state) {
    (void)state;
    const form f = {.type = "Float32", .pieces = 1};
    const char *path = write_legacy(&f, true);
    refused(vtk_files_patch(path, "DIMENSIONS 4 3 5\n", ""), ST_CORRUPT, "told before");
    refused(vtk_files_patch(path, "DIMENSIONS 4 3 5", "DIMENSIONS 4 3 1"), ST_UNSUPPORTED,
            "\"1\", expected 2 to");
    refused(vtk_files_patch(path, "DIMENSIONS 4 3 5", "DIMENSIONS 99999999 99999999 5"), ST_CORRUPT,
            "more than 2^47 nodes");
    refused(vtk_files_patch(path, "POINTS 60", "POINTS 61"), ST_CORRUPT,
            "\"61\", expected as many");
    refused(vtk_files_patch(path, "POINT_DATA 60", "POINT_DATA 59"), ST_CORRUPT, "");
    refused(vtk_files_patch(path, "\n0 0", "\nnan 0"), ST_CORRUPT, "node 0 0 0: expected finite");
}

/* ---- damage ---- */

static void test_cut(void **state) {
    (void)state;
    for (int c = 0; c <= CODINGS; c++) {
        const form f = {.style = &codings[c % CODINGS], .type = "Float32", .pieces = 1};
        size_t size;
        char *bytes = scratch_read(c < CODINGS ? write_xml(&f) : write_legacy(&f, false), &size);
        const char *name = c < CODINGS ? "cut.vts" : "cut.vtk";
        const size_t spare = 60; /* tags behind appended data */
        for (size_t cut = 0; cut + spare < size; cut += 7)
            if (read_all(scratch_write(name, bytes, cut), NULL) == ST_OK)
                fail_msg("coding %d: cut at %zu of %zu", c, cut, size);
        for (size_t at = 0; at < size; at += 5) {
            bytes[at] ^= 0x11;
            const status st = read_all(scratch_write(name, bytes, size), NULL);
            assert_true(st != ST_NOMEM);
            bytes[at] ^= 0x11;
        }
        free(bytes);
    }
}

static void test_faults(void **state) {
    (void)state;
    static const fault_kind kinds[] = {FAULT_ALLOC, FAULT_READ};
    const form f = {.style = &codings[5], .type = "Float64", .pieces = 2, .marks = true};
    for (int i = 0; i < 4; i++) {
        const char *path = i < 2 ? write_xml(&f) : write_legacy(&f, false);
        long k = 1;
        for (bool fired = true; fired; k++) {
            fault_arm(kinds[i % 2], k);
            const status st = read_all(path, NULL);
            fired = fault_fired(kinds[i % 2]);
            fault_arm(kinds[i % 2], 0);
            assert_true(fired ? st != ST_OK : st == ST_OK);
        }
        assert_true(k > 3);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_hidden_cells), cmocka_unit_test(test_pieces),
        cmocka_unit_test(test_pieces_hide),  cmocka_unit_test(test_pieces_refused),
        cmocka_unit_test(test_collection),   cmocka_unit_test(test_codings),
        cmocka_unit_test(test_legacy),       cmocka_unit_test(test_kinds),
        cmocka_unit_test(test_refused),      cmocka_unit_test(test_legacy_refused),
        cmocka_unit_test(test_cut),          cmocka_unit_test(test_faults),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
