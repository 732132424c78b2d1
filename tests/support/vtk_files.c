#include "tests/support/vtk_files.h"

#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>
#include <lz4.h>
#include <lzma.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

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

/* ---- numbers ---- */

static void put_bytes(FILE *out, const void *value, size_t width, bool big) {
    const uint8_t *bytes = value; /* little endian, as all machines the tests run on */
    for (size_t i = 0; i < width; i++)
        fputc(bytes[big ? width - 1 - i : i], out);
}

#define PUT(name, type_name)               \
    if (strcmp(type, name) == 0) {         \
        type_name v = (type_name)number;   \
        put_bytes(out, &v, sizeof v, big); \
    }

static void put_number(FILE *out, const char *type, double number, bool big) {
    PUT("Float32", float)
    PUT("Float64", double)
    PUT("Int8", int8_t)
    PUT("UInt8", uint8_t)
    PUT("Int16", int16_t)
    PUT("UInt16", uint16_t)
    PUT("Int32", int32_t)
    PUT("UInt32", uint32_t)
    PUT("Int64", int64_t)
    PUT("UInt64", uint64_t)
}

/* ---- XML ---- */

typedef struct bytes {
    char *data;
    size_t size;
    FILE *out;
} bytes;

static void bytes_begin(bytes *b) {
    b->out = open_memstream(&b->data, &b->size);
    assert_non_null(b->out);
}

static void bytes_end(bytes *b) {
    fclose(b->out);
}

/* Base64 of bytes, a line end after each 20 letters: readers have to pass over them. */
static void put_base64(FILE *out, const uint8_t *data, size_t size) {
    static const char letters[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < size; i += 3) {
        uint32_t bits = (uint32_t)data[i] << 16;
        bits |= i + 1 < size ? (uint32_t)data[i + 1] << 8 : 0;
        bits |= i + 2 < size ? data[i + 2] : 0;
        fputc(letters[bits >> 18], out);
        fputc(letters[bits >> 12 & 63], out);
        fputc(i + 1 < size ? letters[bits >> 6 & 63] : '=', out);
        fputc(i + 2 < size ? letters[bits & 63] : '=', out);
        if (i % 15 == 12)
            fputc('\n', out);
    }
}

static void put_head(FILE *out, const vtk_xml_style *s, uint64_t number) {
    put_bytes(out, &number, s->head64 ? 8 : 4, s->big_endian);
}

static size_t pack_block(const vtk_xml_style *s, const char *data, size_t size, char packed[8192]) {
    size_t at = 0;
    if (s->packing == VTK_FILES_LZ4)
        return (size_t)LZ4_compress_default(data, packed, (int)size, 8192);
    if (s->packing == VTK_FILES_LZMA) {
        assert_int_equal(lzma_easy_buffer_encode(5, LZMA_CHECK_CRC32, NULL, (const uint8_t *)data,
                                                 size, (uint8_t *)packed, &at, 8192),
                         LZMA_OK);
        return at;
    }
    uLongf room = 8192;
    assert_int_equal(compress2((Bytef *)packed, &room, (const Bytef *)data, size, 9), Z_OK);
    return room;
}

/* The head, and the blocks behind it. */
static void pack(const vtk_xml_style *s, const bytes *plain, FILE *head, FILE *body) {
    if (!s->block) {
        put_head(head, s, plain->size);
        fwrite(plain->data, 1, plain->size, body);
        return;
    }
    size_t blocks = (plain->size + s->block - 1) / s->block;
    put_head(head, s, blocks);
    put_head(head, s, s->block);
    put_head(head, s, plain->size % s->block);
    for (size_t i = 0; i < blocks; i++) {
        char packed[8192];
        size_t at = i * s->block, left = plain->size - at;
        size_t size = pack_block(s, plain->data + at, left < s->block ? left : s->block, packed);
        put_head(head, s, size);
        fwrite(packed, 1, size, body);
    }
}

/* Numbers as they stand in the file. */
static void put_coded(FILE *out, const vtk_xml_style *s, const bytes *plain) {
    bytes head, body;
    bytes_begin(&head);
    bytes_begin(&body);
    pack(s, plain, head.out, body.out);
    bytes_end(&head);
    bytes_end(&body);
    if (s->appended && s->raw) {
        fwrite(head.data, 1, head.size, out);
        fwrite(body.data, 1, body.size, out);
    } else if (s->block || s->split_head) {
        put_base64(out, (const uint8_t *)head.data, head.size);
        put_base64(out, (const uint8_t *)body.data, body.size);
    } else {
        head.data = realloc(head.data, head.size + body.size);
        memcpy(head.data + head.size, body.data, body.size);
        put_base64(out, (const uint8_t *)head.data, head.size + body.size);
    }
    free(head.data);
    free(body.data);
}

typedef struct xml {
    const vtk_xml_style *s;
    FILE *out;
    bytes appended;
    int piece;
} xml;

static void put_array(xml *x, const char *name, const char *type, int components, size_t count,
                      const double *numbers) {
    const vtk_xml_style *s = x->s;
    fprintf(x->out, "<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%d\" ", type, name,
            components);
    if (s->text) {
        fprintf(x->out, "format=\"ascii\">\n");
        for (size_t i = 0; i < count; i++)
            fprintf(x->out, "%.17g%c", numbers[i], i % 6 == 5 ? '\n' : ' ');
    } else {
        bytes plain;
        bytes_begin(&plain);
        for (size_t i = 0; i < count; i++)
            put_number(plain.out, type, numbers[i], s->big_endian);
        bytes_end(&plain);
        fflush(x->appended.out);
        if (s->appended)
            fprintf(x->out, "format=\"appended\" offset=\"%zu\">", x->appended.size);
        else
            fprintf(x->out, "format=\"binary\">\n ");
        put_coded(s->appended ? x->appended.out : x->out, s, &plain);
        free(plain.data);
    }
    fprintf(x->out, "\n</DataArray>\n");
}

static void put_point_field(xml *x, const char *name, const char *type, int components) {
    double numbers[3 * VTK_FILES_POINTS];
    for (int p = 0; p < VTK_FILES_POINTS; p++)
        for (int c = 0; c < components; c++)
            numbers[components * p + c] = point_value(name, p, c) + 100 * x->piece;
    put_array(x, name, type, components, (size_t)components * VTK_FILES_POINTS, numbers);
}

static void put_cell_field(xml *x, const char *name, const char *type, int components) {
    double numbers[2 * VTK_FILES_CELLS];
    for (int p = 0; p < VTK_FILES_CELLS; p++)
        for (int c = 0; c < components; c++)
            numbers[components * p + c] = cell_value(name, p, c) + 100 * x->piece;
    put_array(x, name, type, components, (size_t)components * VTK_FILES_CELLS, numbers);
}

static void put_cells(xml *x, const char *whole) {
    double numbers[IDS];
    for (int i = 0; i < IDS; i++)
        numbers[i] = ids[i];
    put_array(x, "connectivity", whole, 1, IDS, numbers);
    int end = 0;
    for (int i = 0; i < VTK_FILES_CELLS; i++)
        numbers[i] = end += cell_size[i];
    put_array(x, "offsets", whole, 1, VTK_FILES_CELLS, numbers);
    for (int i = 0; i < VTK_FILES_CELLS; i++)
        numbers[i] = cell_type[i];
    put_array(x, "types", "UInt8", 1, VTK_FILES_CELLS, numbers);
}

static void put_piece(xml *x) {
    const char *real = x->s->real ? x->s->real : "Float64";
    const char *whole = x->s->whole ? x->s->whole : "Int32";
    double where[VTK_FILES_POINTS][3];
    memcpy(where, position, sizeof where);
    for (int p = 0; p < VTK_FILES_POINTS; p++)
        where[p][0] += 10 * x->piece;
    fprintf(x->out, "<Piece NumberOfPoints=\"%d\" NumberOfCells=\"%d\">\n<PointData>\n",
            VTK_FILES_POINTS, VTK_FILES_CELLS);
    put_point_field(x, "alpha", real, 1);
    put_point_field(x, "v", real, 3);
    put_point_field(x, "n", whole, 1);
    fprintf(x->out, "</PointData>\n<CellData>\n");
    put_cell_field(x, "q", real, 1);
    put_cell_field(x, "w", real, 2);
    fprintf(x->out, "</CellData>\n<Points>\n");
    put_array(x, "Points", real, 3, (size_t)3 * VTK_FILES_POINTS, where[0]);
    fprintf(x->out, "</Points>\n<Cells>\n");
    put_cells(x, whole);
    fprintf(x->out, "</Cells>\n</Piece>\n");
}

static const char *finish(bytes *file, const char *name) {
    bytes_end(file);
    const char *path = scratch_write(name, file->data, file->size);
    free(file->data);
    return path;
}

const char *vtk_files_xml(const char *name, const vtk_xml_style *style) {
    static const char *const compressors[] = {" compressor=\"vtkZLibDataCompressor\"",
                                              " compressor=\"vtkLZ4DataCompressor\"",
                                              " compressor=\"vtkLZMADataCompressor\""};
    bytes file;
    bytes_begin(&file);
    xml x = {.s = style, .out = file.out};
    bytes_begin(&x.appended);
    fprintf(file.out,
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
            "byte_order=\"%s\" header_type=\"%s\"%s>\n<UnstructuredGrid>\n<FieldData>"
            "<DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" "
            "format=\"ascii\">3.5</DataArray></FieldData>\n",
            style->big_endian ? "BigEndian" : "LittleEndian", style->head64 ? "UInt64" : "UInt32",
            style->block ? compressors[style->packing] : "");
    int pieces = style->pieces ? style->pieces : 1;
    for (x.piece = 0; x.piece < pieces; x.piece++)
        put_piece(&x);
    fprintf(file.out, "</UnstructuredGrid>\n");
    bytes_end(&x.appended);
    if (style->appended) {
        fprintf(file.out, "<AppendedData encoding=\"%s\">\n _", style->raw ? "raw" : "base64");
        fwrite(x.appended.data, 1, x.appended.size, file.out);
        fprintf(file.out, "\n</AppendedData>\n");
    }
    free(x.appended.data);
    fprintf(file.out, "</VTKFile>\n");
    return finish(&file, name);
}

/* ---- legacy ---- */

/* Numbers of a legacy file; its name for the type comes from the caller. */
static void put_legacy(FILE *out, bool text, const char *type, size_t count,
                       const double *numbers) {
    for (size_t i = 0; i < count; i++) {
        if (text)
            fprintf(out, "%.17g%s", numbers[i], i % 9 == 8 ? " \n" : " ");
        else
            put_number(out, type, numbers[i], true);
    }
    fprintf(out, "\n");
}

static void put_legacy_cells(FILE *out, int major, bool text) {
    double numbers[IDS + VTK_FILES_CELLS + 1];
    size_t count = 0;
    if (major >= 5) {
        fprintf(out, "CELLS %d %d\nOFFSETS vtktypeint64\n", VTK_FILES_CELLS + 1, IDS);
        numbers[count++] = 0;
        for (int i = 0; i < VTK_FILES_CELLS; i++, count++)
            numbers[count] = numbers[count - 1] + cell_size[i];
        put_legacy(out, text, "Int64", count, numbers);
        fprintf(out, "CONNECTIVITY vtktypeint64\n");
        for (int i = 0; i < IDS; i++)
            numbers[i] = ids[i];
        put_legacy(out, text, "Int64", IDS, numbers);
    } else {
        fprintf(out, "CELLS %d %d\n", VTK_FILES_CELLS, IDS + VTK_FILES_CELLS);
        for (int i = 0, at = 0; i < VTK_FILES_CELLS; i++) {
            numbers[count++] = cell_size[i];
            for (int k = 0; k < cell_size[i]; k++)
                numbers[count++] = ids[at++];
        }
        put_legacy(out, text, "Int32", count, numbers);
    }
    for (int i = 0; i < VTK_FILES_CELLS; i++)
        numbers[i] = cell_type[i];
    fprintf(out, "\nCELL_TYPES %d\n", VTK_FILES_CELLS);
    put_legacy(out, text, "Int32", VTK_FILES_CELLS, numbers);
}

static void put_legacy_points(FILE *out, bool text) {
    double numbers[3 * VTK_FILES_POINTS];
    fprintf(out, "POINT_DATA %d\nSCALARS alpha double\nLOOKUP_TABLE default\n", VTK_FILES_POINTS);
    for (int p = 0; p < VTK_FILES_POINTS; p++)
        numbers[p] = point_value("alpha", p, 0);
    put_legacy(out, text, "Float64", VTK_FILES_POINTS, numbers);
    fprintf(out, "METADATA\nINFORMATION 0\n\nVECTORS v float\n");
    for (int p = 0; p < 3 * VTK_FILES_POINTS; p++)
        numbers[p] = point_value("v", p / 3, p % 3);
    put_legacy(out, text, "Float32", 3 * VTK_FILES_POINTS, numbers);
    fprintf(out, "FIELD FieldData 2\nother%%20one 2 %d unsigned_char\n", VTK_FILES_POINTS);
    put_legacy(out, text, "UInt8", 2 * VTK_FILES_POINTS, (double[2 * VTK_FILES_POINTS]){0});
    fprintf(out, "METADATA\nINFORMATION 0\n\nn 1 %d short\n", VTK_FILES_POINTS);
    for (int p = 0; p < VTK_FILES_POINTS; p++)
        numbers[p] = point_value("n", p, 0);
    put_legacy(out, text, "Int16", VTK_FILES_POINTS, numbers);
}

static void put_legacy_cell_data(FILE *out, bool text) {
    double numbers[2 * VTK_FILES_CELLS];
    fprintf(out, "CELL_DATA %d\nSCALARS q float 1\nLOOKUP_TABLE default\n", VTK_FILES_CELLS);
    for (int i = 0; i < VTK_FILES_CELLS; i++)
        numbers[i] = cell_value("q", i, 0);
    put_legacy(out, text, "Float32", VTK_FILES_CELLS, numbers);
    fprintf(out, "FIELD FieldData 1\nw 2 %d int\n", VTK_FILES_CELLS);
    for (int i = 0; i < 2 * VTK_FILES_CELLS; i++)
        numbers[i] = cell_value("w", i / 2, i % 2);
    put_legacy(out, text, "Int32", 2 * VTK_FILES_CELLS, numbers);
}

const char *vtk_files_legacy(const char *name, int major, int minor, bool text) {
    bytes file;
    bytes_begin(&file);
    fprintf(file.out,
            "# vtk DataFile Version %d.%d\nall kinds of cells\n%s\nDATASET UNSTRUCTURED_GRID\n",
            major, minor, text ? "ASCII" : "BINARY");
    if (major >= 4) {
        fprintf(file.out, "FIELD FieldData 1\nTIME 1 1 double\n");
        put_legacy(file.out, text, "Float64", 1, (double[]){2.5});
    }
    fprintf(file.out, "POINTS %d float\n", VTK_FILES_POINTS);
    put_legacy(file.out, text, "Float32", (size_t)3 * VTK_FILES_POINTS, position[0]);
    put_legacy_cells(file.out, major, text);
    put_legacy_points(file.out, text);
    put_legacy_cell_data(file.out, text);
    return finish(&file, name);
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

static mesh_cell kind_of(int type) {
    switch (type) {
    case 11: return MESH_VOXEL;
    case 12: return MESH_HEX;
    case 13: return MESH_WEDGE;
    case 14: return MESH_PYRAMID;
    default: return MESH_TET;
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
    for (int k = 0; k < MESH_SPLIT_KINDS; k++)
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
