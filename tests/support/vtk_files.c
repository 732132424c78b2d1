#include "tests/support/vtk_files.h"

#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/mesh/mesh_split.h"
#include "tests/support/scratch.h"

/* ---- the mesh ---- */

enum { IDS = 42 };

static const double position[VTK_FILES_POINTS][3] = {
    {0, 0, 0},     {1, 0, 0},     {2, 0, 0},     {0, 1, 0},    {1, 1, 0}, {2, 1, 0},
    {0, 0, 1},     {1, 0, 1},     {2, 0, 1},     {0, 1, 1},    {1, 1, 1}, {2, 1, 1},
    {0.5, 0.5, 2}, {1.5, 0, 1.5}, {1.5, 1, 1.5}, {0.1, 0, -1},
};

static const int cell_type[VTK_FILES_CELLS] = {12, 5, 11, 1, 14, 3, 13, 7, 10};
static const int cell_size[VTK_FILES_CELLS] = {8, 3, 8, 1, 5, 2, 6, 5, 4};
static const int ids[IDS] = {0, 1,  4,  3,  6,  7, 10, 9, 0,  1, 3,  1, 2, 4,
                             5, 7,  8,  10, 11, 5, 6,  7, 10, 9, 12, 1, 2, 7,
                             8, 13, 10, 11, 14, 0, 1,  4, 3,  9, 0,  1, 4, 15};

static double point_value(const char *field, int point, int component) {
    if (strcmp(field, "alpha") == 0)
        return 1.25 * point - 3;
    if (strcmp(field, "n") == 0)
        return 7 * point;
    return component == 0 ? point : component == 1 ? 2 * point + 0.5 : -point / 4.0;
}

static double cell_value(const char *field, int cell, int component) {
    return strcmp(field, "q") == 0 ? 0.75 * cell + 1 : component ? 3 * cell : -4 * cell;
}

static void put_point_field(vtk_writer *x, int piece, const char *name, const char *type,
                            int components) {
    double numbers[3 * VTK_FILES_POINTS];
    for (int p = 0; p < VTK_FILES_POINTS; p++)
        for (int c = 0; c < components; c++)
            numbers[components * p + c] = point_value(name, p, c) + 100 * piece;
    vtk_writer_array(x, name, type, components, (size_t)components * VTK_FILES_POINTS, numbers);
}

static void put_cell_field(vtk_writer *x, int piece, const char *name, const char *type,
                           int components) {
    double numbers[2 * VTK_FILES_CELLS];
    for (int p = 0; p < VTK_FILES_CELLS; p++)
        for (int c = 0; c < components; c++)
            numbers[components * p + c] = cell_value(name, p, c) + 100 * piece;
    vtk_writer_array(x, name, type, components, (size_t)components * VTK_FILES_CELLS, numbers);
}

static void put_cells(vtk_writer *x, const char *whole) {
    double numbers[IDS];
    for (int i = 0; i < IDS; i++)
        numbers[i] = ids[i];
    vtk_writer_array(x, "connectivity", whole, 1, IDS, numbers);
    int end = 0;
    for (int i = 0; i < VTK_FILES_CELLS; i++)
        numbers[i] = end += cell_size[i];
    vtk_writer_array(x, "offsets", whole, 1, VTK_FILES_CELLS, numbers);
    for (int i = 0; i < VTK_FILES_CELLS; i++)
        numbers[i] = cell_type[i];
    vtk_writer_array(x, "types", "UInt8", 1, VTK_FILES_CELLS, numbers);
}

static void put_piece(vtk_writer *x, int piece) {
    const char *real = x->style->real ? x->style->real : "Float64";
    const char *whole = x->style->whole ? x->style->whole : "Int32";
    double where[VTK_FILES_POINTS][3];
    memcpy(where, position, sizeof where);
    for (int p = 0; p < VTK_FILES_POINTS; p++)
        where[p][0] += 10 * piece;
    fprintf(x->out, "<Piece NumberOfPoints=\"%d\" NumberOfCells=\"%d\">\n<PointData>\n",
            VTK_FILES_POINTS, VTK_FILES_CELLS);
    put_point_field(x, piece, "alpha", real, 1);
    put_point_field(x, piece, "v", real, 3);
    put_point_field(x, piece, "n", whole, 1);
    fprintf(x->out, "</PointData>\n<CellData>\n");
    put_cell_field(x, piece, "q", real, 1);
    put_cell_field(x, piece, "w", real, 2);
    fprintf(x->out, "</CellData>\n<Points>\n");
    vtk_writer_array(x, "Points", real, 3, (size_t)3 * VTK_FILES_POINTS, where[0]);
    fprintf(x->out, "</Points>\n<Cells>\n");
    put_cells(x, whole);
    fprintf(x->out, "</Cells>\n</Piece>\n");
}

const char *vtk_files_xml(const char *name, const vtk_xml_style *style) {
    vtk_writer w;
    vtk_writer_begin(&w, "UnstructuredGrid", style);
    fprintf(w.out, "<UnstructuredGrid>\n<FieldData>"
                   "<DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" "
                   "format=\"ascii\">3.5</DataArray></FieldData>\n");
    int pieces = style->pieces ? style->pieces : 1;
    for (int i = 0; i < pieces; i++)
        put_piece(&w, i);
    fprintf(w.out, "</UnstructuredGrid>\n");
    return vtk_writer_end(&w, name);
}

/* ---- legacy ---- */

static void put_legacy_cells(FILE *out, int major, bool text) {
    double numbers[IDS + VTK_FILES_CELLS + 1];
    size_t count = 0;
    if (major >= 5) {
        fprintf(out, "CELLS %d %d\nOFFSETS vtktypeint64\n", VTK_FILES_CELLS + 1, IDS);
        numbers[count++] = 0;
        for (int i = 0; i < VTK_FILES_CELLS; i++, count++)
            numbers[count] = numbers[count - 1] + cell_size[i];
        vtk_writer_numbers(out, text, "Int64", count, numbers);
        fprintf(out, "CONNECTIVITY vtktypeint64\n");
        for (int i = 0; i < IDS; i++)
            numbers[i] = ids[i];
        vtk_writer_numbers(out, text, "Int64", IDS, numbers);
    } else {
        fprintf(out, "CELLS %d %d\n", VTK_FILES_CELLS, IDS + VTK_FILES_CELLS);
        for (int i = 0, at = 0; i < VTK_FILES_CELLS; i++) {
            numbers[count++] = cell_size[i];
            for (int k = 0; k < cell_size[i]; k++)
                numbers[count++] = ids[at++];
        }
        vtk_writer_numbers(out, text, "Int32", count, numbers);
    }
    for (int i = 0; i < VTK_FILES_CELLS; i++)
        numbers[i] = cell_type[i];
    fprintf(out, "\nCELL_TYPES %d\n", VTK_FILES_CELLS);
    vtk_writer_numbers(out, text, "Int32", VTK_FILES_CELLS, numbers);
}

static void put_legacy_points(FILE *out, bool text) {
    double numbers[3 * VTK_FILES_POINTS];
    fprintf(out, "POINT_DATA %d\nSCALARS alpha double\nLOOKUP_TABLE default\n", VTK_FILES_POINTS);
    for (int p = 0; p < VTK_FILES_POINTS; p++)
        numbers[p] = point_value("alpha", p, 0);
    vtk_writer_numbers(out, text, "Float64", VTK_FILES_POINTS, numbers);
    fprintf(out, "METADATA\nINFORMATION 0\n\nVECTORS v float\n");
    for (int p = 0; p < 3 * VTK_FILES_POINTS; p++)
        numbers[p] = point_value("v", p / 3, p % 3);
    vtk_writer_numbers(out, text, "Float32", 3 * VTK_FILES_POINTS, numbers);
    fprintf(out, "FIELD FieldData 2\nother%%20one 2 %d unsigned_char\n", VTK_FILES_POINTS);
    vtk_writer_numbers(out, text, "UInt8", 2 * VTK_FILES_POINTS, (double[2 * VTK_FILES_POINTS]){0});
    fprintf(out, "METADATA\nINFORMATION 0\n\nn 1 %d short\n", VTK_FILES_POINTS);
    for (int p = 0; p < VTK_FILES_POINTS; p++)
        numbers[p] = point_value("n", p, 0);
    vtk_writer_numbers(out, text, "Int16", VTK_FILES_POINTS, numbers);
}

static void put_legacy_cell_data(FILE *out, bool text) {
    double numbers[2 * VTK_FILES_CELLS];
    fprintf(out, "CELL_DATA %d\nSCALARS q float 1\nLOOKUP_TABLE default\n", VTK_FILES_CELLS);
    for (int i = 0; i < VTK_FILES_CELLS; i++)
        numbers[i] = cell_value("q", i, 0);
    vtk_writer_numbers(out, text, "Float32", VTK_FILES_CELLS, numbers);
    fprintf(out, "FIELD FieldData 1\nw 2 %d int\n", VTK_FILES_CELLS);
    for (int i = 0; i < 2 * VTK_FILES_CELLS; i++)
        numbers[i] = cell_value("w", i / 2, i % 2);
    vtk_writer_numbers(out, text, "Int32", 2 * VTK_FILES_CELLS, numbers);
}

const char *vtk_files_legacy(const char *name, int major, int minor, bool text) {
    vtk_writer w;
    vtk_writer_open(&w);
    fprintf(w.out,
            "# vtk DataFile Version %d.%d\nall kinds of cells\n%s\nDATASET UNSTRUCTURED_GRID\n",
            major, minor, text ? "ASCII" : "BINARY");
    if (major >= 4) {
        fprintf(w.out, "FIELD FieldData 1\nTIME 1 1 double\n");
        vtk_writer_numbers(w.out, text, "Float64", 1, (double[]){2.5});
    }
    fprintf(w.out, "POINTS %d float\n", VTK_FILES_POINTS);
    vtk_writer_numbers(w.out, text, "Float32", (size_t)3 * VTK_FILES_POINTS, position[0]);
    put_legacy_cells(w.out, major, text);
    put_legacy_points(w.out, text);
    put_legacy_cell_data(w.out, text);
    return vtk_writer_close(&w, name);
}

/* ---- changed files ---- */

/* A file of these three parts under the name of another, "x-" in front. */
static const char *write_parts(const char *path, const char *head, size_t head_size,
                               const char *middle, const char *tail, size_t tail_size) {
    char name[200];
    size_t length = strlen(middle);
    snprintf(name, sizeof name, "x-%s", strrchr(path, '/') + 1);
    char *all = malloc(head_size + length + tail_size + 1);
    memcpy(all, head, head_size);
    memcpy(all + head_size, middle, length);
    memcpy(all + head_size + length, tail, tail_size);
    const char *changed = scratch_write(name, all, head_size + length + tail_size);
    free(all);
    return changed;
}

const char *vtk_files_append(const char *path, const char *text) {
    size_t size;
    char *data = scratch_read(path, &size);
    const char *changed = write_parts(path, data, size, text, "", 0);
    free(data);
    return changed;
}

const char *vtk_files_patch(const char *path, const char *from, const char *to) {
    size_t size;
    char *data = scratch_read(path, &size);
    char *at = memmem(data, size, from, strlen(from));
    if (!at)
        fail_msg("%s: no \"%s\"", path, from);
    char *rest = at + strlen(from);
    const char *changed =
        write_parts(path, data, (size_t)(at - data), to, rest, size - (size_t)(rest - data));
    free(data);
    return changed;
}

/* ---- what must come of it ---- */

static cell_shape kind_of(int type) {
    switch (type) {
    case 11: return CELL_VOXEL;
    case 12: return CELL_HEXAHEDRON;
    case 13: return CELL_WEDGE;
    case 14: return CELL_PYRAMID;
    default: return CELL_TET;
    }
}

static bool is_volume(int type) {
    return type >= 10;
}

static double pick(const char *field, bool of_cell, int item, int component, int piece) {
    int components = strcmp(field, "v") == 0 ? 3 : strcmp(field, "w") == 0 ? 2 : 1;
    double number[3], sum = 0;
    for (int c = 0; c < components; c++) {
        number[c] = (of_cell ? cell_value(field, item, c) : point_value(field, item, c));
        number[c] += 100 * piece;
        sum += number[c] * number[c];
    }
    return component > 0 ? number[component - 1] : components == 1 ? number[0] : sqrt(sum);
}

/* The mean over the volume cells of a point. */
static double average(const char *field, int point, int component, int piece) {
    double sum = 0;
    int count = 0;
    for (int cell = 0, at = 0; cell < VTK_FILES_CELLS; at += cell_size[cell++])
        for (int k = 0; is_volume(cell_type[cell]) && k < cell_size[cell]; k++)
            if (ids[at + k] == point) {
                sum += pick(field, true, cell, component, piece);
                count++;
            }
    return count ? sum / count : 0;
}

static void check_tets(const mesh_copy *a, int pieces) {
    size_t n = 0;
    for (int piece = 0; piece < pieces; piece++)
        for (int cell = 0, at = 0; cell < VTK_FILES_CELLS; at += cell_size[cell++]) {
            uint32_t all[8], tets[MESH_SPLIT_TETS][4];
            if (!is_volume(cell_type[cell]))
                continue;
            for (int k = 0; k < cell_size[cell]; k++)
                all[k] = (uint32_t)(ids[at + k] + piece * VTK_FILES_POINTS);
            int count = mesh_split(kind_of(cell_type[cell]), all, tets);
            assert_memory_equal(a->tets[n], tets, (size_t)count * sizeof *tets);
            n += (size_t)count;
        }
    assert_int_equal(a->report.tets, n);
}

void vtk_files_check(const mesh_copy *a, int pieces, const char *field, int component) {
    bool of_cell = strcmp(field, "q") == 0 || strcmp(field, "w") == 0;
    assert_int_equal(a->report.points, pieces * VTK_FILES_POINTS);
    assert_int_equal(a->report.tets, pieces * VTK_FILES_TETS);
    assert_int_equal(a->report.skipped, pieces * 4);
    assert_int_equal(a->report.bad_indices + a->report.repeated, 0);
    for (int k = 0; k < CELL_SPLIT_SHAPES; k++)
        assert_int_equal(a->report.split[k], pieces);
    assert_string_equal(a->report.field, field);
    for (int i = 0; i < pieces * VTK_FILES_POINTS; i++) {
        int piece = i / VTK_FILES_POINTS, p = i % VTK_FILES_POINTS;
        double want = !*field   ? 0
                      : of_cell ? average(field, p, component, piece)
                                : pick(field, false, p, component, piece);
        assert_true(a->values[i] == (float)want);
        assert_true(a->xyz[i][0] == (float)(position[p][0] + 10 * piece));
        assert_true(a->xyz[i][1] == (float)position[p][1]);
        assert_true(a->xyz[i][2] == (float)position[p][2]);
    }
    check_tets(a, pieces);
    double all = 0;
    mesh_files_volume(a, &all);
    assert_true(fabs(all - 2.75 * pieces) < 1e-5);
    assert_true(mesh_files_closed(a));
}
