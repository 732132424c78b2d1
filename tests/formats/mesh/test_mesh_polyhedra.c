/* test_mesh_polyhedra.c - polyhedra of VTK's files, in all forms that it has for their faces: cells
 * that fill space stay whole, a linear field stays linear, faces fit those of other shapes;
 * refusals that name the cell; cut and damaged files; faults.
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

#include "formats/mesh/mesh_polyhedron.h"
#include "tests/support/mesh_files.h"
#include "tests/support/scratch.h"
#include "tests/support/vtk_files.h"

/* ---- truncated octahedra, which fill space ---- */

enum {
    FACES = 14,
    HEXAGONS = 8,
    NUMBERS = 6 * 5 + HEXAGONS * 7,
    CELLS_MAX = 60,
    POINTS_MAX = 1200
};

typedef struct foam {
    int cells, points;
    int at[POINTS_MAX][3];
    int stream[CELLS_MAX][NUMBERS]; /* faces: how many corners, then ids */
    int apex; /* of a pyramid on the first cell's face below; last of the points */
    int base[4];
    /* In XML: how often the piece comes again; whether the first cell is hidden. */
    int again;
    bool hides;
} foam;

static int id_at(foam *f, const int at[3]) {
    int i = 0;
    while (i < f->points && memcmp(f->at[i], at, sizeof f->at[i]) != 0)
        i++;
    assert_true(i < POINTS_MAX);
    if (i == f->points)
        memcpy(f->at[f->points++], at, sizeof f->at[i]);
    return i;
}

/* A face's corners around it: those of the 24 that lie farthest along a direction. */
static int add_face(foam *f, const int middle[3], const int along[3], int height, int *to) {
    struct {
        double angle;
        int id;
    } corner[6], kept;
    int count = 0;
    const bool square = along[0] * along[1] * along[2] == 0;
    const double p[3] = {along[1], square ? along[2] : -along[0],
                         square ? along[0] : 0}; /* across */
    double v[3];
    for (int a = 0; a < 3; a++)
        v[a] = along[(a + 1) % 3] * p[(a + 2) % 3] - along[(a + 2) % 3] * p[(a + 1) % 3];
    for (int x = -2; x <= 2; x++)
        for (int y = -2; y <= 2; y++)
            for (int z = -2; z <= 2; z++) {
                const int q[3] = {x, y, z};
                if (abs(x) + abs(y) + abs(z) != 3 || x * y * z != 0 ||
                    x * along[0] + y * along[1] + z * along[2] != height)
                    continue;
                double one = 0, other = 0;
                for (int a = 0; a < 3; a++) {
                    one += q[a] * p[a];
                    other += q[a] * v[a];
                }
                corner[count].angle = atan2(other, one);
                corner[count++].id =
                    id_at(f, (int[3]){middle[0] + x, middle[1] + y, middle[2] + z});
            }
    for (int i = 1; i < count; i++)
        for (int k = i; k > 0 && corner[k].angle < corner[k - 1].angle; k--) {
            kept = corner[k];
            corner[k] = corner[k - 1];
            corner[k - 1] = kept;
        }
    *to++ = count;
    for (int i = 0; i < count; i++)
        *to++ = corner[i].id;
    return 1 + count;
}

static void add_cell(foam *f, const int middle[3]) {
    int *to = f->stream[f->cells++];
    assert_true(f->cells <= CELLS_MAX);
    for (int a = 0; a < 3; a++)
        for (int side = -1; side <= 1; side += 2) {
            int along[3] = {0};
            along[a] = side;
            to += add_face(f, middle, along, 2, to);
        }
    for (int n = 0; n < 8; n++)
        to += add_face(f, middle, (int[3]){n & 1 ? 1 : -1, n & 2 ? 1 : -1, n & 4 ? 1 : -1}, 3, to);
}

/* n^3 cells, those between them, and a pyramid below the first one. */
static foam foam_of(int n) {
    static foam f;
    memset(&f, 0, sizeof f);
    for (int i = 0; i < n * n * n; i++) {
        const int at[3] = {4 * (i % n), 4 * (i / n % n), 4 * (i / (n * n))};
        add_cell(&f, at);
        if (at[0] < 4 * n - 4 && at[1] < 4 * n - 4 && at[2] < 4 * n - 4)
            add_cell(&f, (int[3]){at[0] + 2, at[1] + 2, at[2] + 2});
    }
    const int *below = f.stream[0] + 4 * 5;
    assert_int_equal(f.at[below[1]][2], -2);
    memcpy(f.base, below + 1, sizeof f.base);
    f.apex = id_at(&f, (int[3]){0, 0, -4});
    return f;
}

/* ---- its files ---- */

typedef enum form { FACES_AND_OFFSETS, FACE_LISTS, LEGACY, LEGACY_5, FORMS } form;

static double value_at(const int at[3]) {
    return at[0] + 2 * at[1] + 3 * at[2];
}

static void write_points(FILE *out, const foam *f, const char *between) {
    for (int i = 0; i < f->points; i++)
        fprintf(out, "%d %d %d%s", f->at[i][0], f->at[i][1], f->at[i][2], between);
}

static void write_stream(FILE *out, const foam *f, int cell) {
    for (int i = 0; i < NUMBERS; i++)
        fprintf(out, "%d ", f->stream[cell][i]);
}

static void begin_array(FILE *out, const char *name, int components) {
    fprintf(out,
            "<DataArray type=\"Int64\" Name=\"%s\" NumberOfComponents=\"%d\" format=\"ascii\">\n",
            name, components);
}
static void end_array(FILE *out) {
    fprintf(out, "\n</DataArray>\n");
}

/* The different ids of a cell, as VTK lists them. Returns how many: 24. */
static int write_ids(FILE *out, const foam *f, int cell) {
    int count = 0;
    for (int id = 0; id < f->points; id++) {
        bool there = false;
        for (int at = 0; at < NUMBERS; at += 1 + f->stream[cell][at])
            for (int i = 1; i <= f->stream[cell][at]; i++)
                there |= f->stream[cell][at + i] == id;
        if (there)
            fprintf(out, "%d ", id);
        count += there;
    }
    return count;
}

static void write_face_arrays(FILE *out, const foam *f, form how) {
    if (how == FACES_AND_OFFSETS) {
        begin_array(out, "faces", 1);
        for (int c = 0; c < f->cells; c++) {
            fprintf(out, "%d ", FACES);
            write_stream(out, f, c);
        }
        end_array(out);
        begin_array(out, "faceoffsets", 1);
        for (int c = 0; c < f->cells; c++)
            fprintf(out, "%d ", (c + 1) * (NUMBERS + 1));
        fprintf(out, "-1");
        end_array(out);
        return;
    }
    begin_array(out, "face_connectivity", 1);
    for (int c = 0; c < f->cells; c++)
        for (int at = 0; at < NUMBERS; at += 1 + f->stream[c][at])
            for (int i = 1; i <= f->stream[c][at]; i++)
                fprintf(out, "%d ", f->stream[c][at + i]);
    end_array(out);
    begin_array(out, "face_offsets", 1);
    for (int c = 0, end = 0; c < f->cells; c++)
        for (int at = 0; at < NUMBERS; at += 1 + f->stream[c][at])
            fprintf(out, "%d ", end += f->stream[c][at]);
    end_array(out);
    begin_array(out, "polyhedron_to_faces", 1);
    for (int i = 0; i < f->cells * FACES; i++)
        fprintf(out, "%d ", i);
    end_array(out);
    begin_array(out, "polyhedron_offsets", 1);
    for (int c = 0; c < f->cells; c++)
        fprintf(out, "%d ", (c + 1) * FACES);
    fprintf(out, "%d", f->cells * FACES);
    end_array(out);
}

static void write_piece(FILE *out, const foam *f, form how) {
    fprintf(out, "<Piece NumberOfPoints=\"%d\" NumberOfCells=\"%d\">\n<PointData>\n", f->points,
            f->cells + 1);
    begin_array(out, "f", 1);
    for (int i = 0; i < f->points; i++)
        fprintf(out, "%g ", value_at(f->at[i]));
    end_array(out);
    begin_array(out, "g", 1);
    for (int i = 0; i < f->points; i++)
        fprintf(out, "%d ", f->at[i][0]);
    end_array(out);
    fprintf(out, "</PointData>\n<CellData>\n");
    begin_array(out, "c", 1);
    for (int c = 0; c <= f->cells; c++)
        fprintf(out, "7 ");
    end_array(out);
    if (f->hides) {
        begin_array(out, "vtkGhostType", 1);
        for (int c = 0; c <= f->cells; c++)
            fprintf(out, "%d ", c == 0 ? 32 : 0);
        end_array(out);
    }
    fprintf(out, "</CellData>\n<Points>\n");
    begin_array(out, "Points", 3);
    write_points(out, f, "\n");
    end_array(out);
    fprintf(out, "</Points>\n<Cells>\n");
    begin_array(out, "connectivity", 1);
    for (int c = 0; c < f->cells; c++)
        assert_int_equal(write_ids(out, f, c), 24);
    fprintf(out, "%d %d %d %d %d", f->base[0], f->base[1], f->base[2], f->base[3], f->apex);
    end_array(out);
    begin_array(out, "offsets", 1);
    for (int c = 0; c < f->cells; c++)
        fprintf(out, "%d ", 24 * (c + 1));
    fprintf(out, "%d", 24 * f->cells + 5);
    end_array(out);
    begin_array(out, "types", 1);
    for (int c = 0; c < f->cells; c++)
        fprintf(out, "42 ");
    fprintf(out, "14");
    end_array(out);
    write_face_arrays(out, f, how);
    fprintf(out, "</Cells>\n</Piece>\n");
}

static void write_xml(FILE *out, const foam *f, form how) {
    fprintf(out, "<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
                 "<UnstructuredGrid>\n");
    for (int i = 0; i <= f->again; i++)
        write_piece(out, f, how);
    fprintf(out, "</UnstructuredGrid>\n</VTKFile>\n");
}

static void write_legacy(FILE *out, const foam *f, form how) {
    const int each = NUMBERS + 1;
    fprintf(out,
            "# vtk DataFile Version %s\nfoam\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS %d float\n",
            how == LEGACY_5 ? "5.1" : "3.0", f->points);
    write_points(out, f, "\n");
    if (how == LEGACY)
        fprintf(out, "CELLS %d %d\n", f->cells + 1, f->cells * (each + 1) + 6);
    else {
        fprintf(out, "CELLS %d %d\nOFFSETS vtktypeint64\n", f->cells + 2, f->cells * each + 5);
        for (int c = 0; c <= f->cells; c++)
            fprintf(out, "%d ", c * each);
        fprintf(out, "%d\nCONNECTIVITY vtktypeint64\n", f->cells * each + 5);
    }
    for (int c = 0; c < f->cells; c++) {
        if (how == LEGACY)
            fprintf(out, "%d ", each);
        fprintf(out, "%d ", FACES);
        write_stream(out, f, c);
        fprintf(out, "\n");
    }
    fprintf(out, "%s%d %d %d %d %d\n", how == LEGACY ? "5 " : "", f->base[0], f->base[1],
            f->base[2], f->base[3], f->apex);
    fprintf(out, "CELL_TYPES %d\n", f->cells + 1);
    for (int c = 0; c < f->cells; c++)
        fprintf(out, "42 ");
    fprintf(out, "14\nPOINT_DATA %d\nSCALARS f float 1\nLOOKUP_TABLE default\n", f->points);
    for (int i = 0; i < f->points; i++)
        fprintf(out, "%g ", value_at(f->at[i]));
    fprintf(out, "\n");
}

static const char *file_of(const foam *f, form how) {
    const char *path = scratch_path(how < LEGACY ? "foam.vtu" : "foam.vtk");
    FILE *out = fopen(path, "w");
    assert_non_null(out);
    (how < LEGACY ? write_xml : write_legacy)(out, f, how);
    assert_int_equal(fclose(out), 0);
    return path;
}

/* ---- what is read ---- */

static void check(const mesh_copy *a, const foam *f) {
    const int cells = f->cells, tets = cells * (6 * 2 + HEXAGONS * 6) + 2;
    assert_int_equal(a->report.polyhedra, cells);
    assert_int_equal(a->report.split[CELL_PYRAMID], 1);
    assert_int_equal(a->report.points, f->points + cells * (1 + HEXAGONS));
    assert_int_equal(a->report.tets, tets);
    for (uint64_t i = 0; i < a->report.points; i++) {
        const float *p = a->xyz[i];
        assert_true(a->values[i] == p[0] + 2 * p[1] + 3 * p[2]);
    }
    double magnitude;
    (void)mesh_files_volume(a, &magnitude);
    assert_true(fabs(magnitude - (32.0 * cells + 4.0 / 3)) < 1e-9 * magnitude);
    assert_true(mesh_files_closed(a));
}

static void test_forms(void **state) {
    (void)state;
    for (int n = 1; n <= 3; n++) {
        const foam f = foam_of(n);
        mesh_copy *first = NULL;
        for (int how = 0; how < FORMS; how++) {
            const mesh_copy *a = mesh_files_good(file_of(&f, (form)how), NULL);
            check(a, &f);
            if (first)
                mesh_files_same(first, a);
            else
                first = mesh_files_keep(a);
        }
        free(first);
    }
}

/* Middles of faces that two cells have are at the same place with the same value. */
static void test_shared(void **state) {
    (void)state;
    const foam f = foam_of(3);
    const mesh_copy *a = mesh_files_good(file_of(&f, LEGACY), NULL);
    int twice = 0;
    for (uint64_t i = (uint64_t)f.points; i < a->report.points; i++)
        for (uint64_t k = (uint64_t)f.points; k < i; k++)
            if (memcmp(a->xyz[i], a->xyz[k], sizeof a->xyz[i]) == 0) {
                assert_true(a->values[i] == a->values[k]);
                twice++;
            }
    assert_int_equal(twice, 8 * 8); /* the eight cells between have all of theirs shared */
}

/* Pieces that follow one another; cells that are not to be drawn. */
static void test_pieces(void **state) {
    (void)state;
    foam f = foam_of(2);
    double magnitude;
    f.again = 2;
    const mesh_copy *a = mesh_files_good(file_of(&f, FACE_LISTS), NULL);
    assert_int_equal(a->report.polyhedra, 3 * f.cells);
    for (uint64_t i = 0; i < a->report.points; i++) {
        const float *x = a->xyz[i];
        assert_true(a->values[i] == x[0] + 2 * x[1] + 3 * x[2]);
    }
    (void)mesh_files_volume(a, &magnitude);
    assert_true(fabs(magnitude - 3 * (32.0 * f.cells + 4.0 / 3)) < 1e-9 * magnitude);
    f.again = 0;
    f.hides = true;
    a = mesh_files_good(file_of(&f, FACES_AND_OFFSETS), NULL);
    assert_int_equal(a->report.polyhedra, f.cells - 1);
    assert_int_equal(a->report.ghosts, 1);
}

/* ---- several fields ---- */

typedef struct columns {
    uint64_t points;
    float xyz[POINTS_MAX][3], values[2 * POINTS_MAX];
} columns;

static status take_points(void *ctx, uint64_t first, size_t count, const float (*xyz)[3]) {
    columns *c = ctx;
    assert_true(first + count <= POINTS_MAX);
    memcpy(c->xyz[first], xyz, count * sizeof *xyz);
    c->points = first + count;
    return ST_OK;
}

static status take_values(void *ctx, uint64_t first, size_t count, const float *values) {
    columns *c = ctx;
    assert_true(first + count <= 2 * POINTS_MAX);
    memcpy(c->values + first, values, count * sizeof *values);
    return ST_OK;
}

static status take_tets(void *ctx, size_t count, const uint32_t (*ids)[4]) {
    (void)ctx, (void)count, (void)ids;
    return ST_OK;
}

static void test_fields(void **state) {
    static const char *const names[] = {"g", "f"};
    static columns c;
    (void)state;
    const foam f = foam_of(2);
    const mesh_sink sink = {
        .ctx = &c, .points = take_points, .values = take_values, .tets = take_tets};
    const mesh_hints hints = {.field = NULL};
    mesh_input *x = NULL;
    mesh_report report;
    mem m;
    mem_init(&m, 0);
    assert_int_equal(mesh_input_open(&m, file_of(&f, FACES_AND_OFFSETS), &hints, &x), ST_OK);
    assert_int_equal(mesh_input_take(x, names, 2), ST_OK);
    assert_int_equal(mesh_input_read(x, &sink, &report), ST_OK);
    mesh_input_close(x);
    assert_int_equal(mem_used(&m), 0);
    assert_int_equal(c.points, f.points + f.cells * (1 + HEXAGONS));
    for (uint64_t i = 0; i < c.points; i++) {
        const float *p = c.xyz[i];
        assert_true(c.values[i] == p[0]);
        assert_true(c.values[c.points + i] == p[0] + 2 * p[1] + 3 * p[2]);
    }
}

/* ---- a file that changes while it is read ---- */

/* Where in a file a number of three digits stands, and what it becomes as soon as points are taken.
 */
typedef struct change {
    const char *path;
    long at;
    const char *to;
    uint64_t most; /* points that were counted */
} change;

static status change_file(void *ctx, uint64_t first, size_t count, const float (*xyz)[3]) {
    const change *c = ctx;
    (void)xyz;
    assert_true(first + count <= c->most);
    FILE *f = first == 0 ? fopen(c->path, "r+") : NULL;
    if (!f)
        return ST_OK;
    assert_int_equal(fseek(f, c->at, SEEK_SET), 0);
    assert_int_equal(fputs(c->to, f) >= 0, 1);
    assert_int_equal(fclose(f), 0);
    return ST_OK;
}

static status pass_values(void *ctx, uint64_t first, size_t count, const float *values) {
    (void)ctx, (void)first, (void)count, (void)values;
    return ST_OK;
}

/* A cell of the last of many pieces gets an id that is no point, or loses one, once points of the
 * first ones have been handed over: the points that were counted are then not those that come. */
static void test_changed(void **state) {
    (void)state;
    foam f = foam_of(3);
    f.again = 30;
    for (int more = 0; more < 2; more++) {
        foam g = f;
        int *id = &g.stream[g.cells - 1][NUMBERS - 1];
        const int good = *id;
        char digits[8], was[24];
        assert_true(good > 99 && good < 1000);
        if (more)
            *id = 999; /* no point yet */
        change c = {.path = file_of(&g, FACES_AND_OFFSETS), .to = digits};
        c.most = (uint64_t)(g.points + (g.cells - more) * (1 + HEXAGONS)) * (uint64_t)(1 + g.again);
        snprintf(digits, sizeof digits, "%d", more ? good : 999);
        snprintf(was, sizeof was, "%d \n</DataArray>", *id);
        char *text = scratch_read(c.path, NULL), *at = text, *next;
        for (next = text; (next = strstr(next, was)) != NULL; next++)
            at = next;
        assert_true(at > text);
        c.at = at - text;
        free(text);
        const mesh_sink sink = {
            .ctx = &c, .points = change_file, .values = pass_values, .tets = take_tets};
        const mesh_hints hints = {.field = NULL};
        mesh_input *x = NULL;
        mesh_report report;
        mem m;
        mem_init(&m, 0);
        assert_int_equal(mesh_input_open(&m, c.path, &hints, &x), ST_OK);
        assert_int_equal(mesh_input_read(x, &sink, &report), ST_IO);
        assert_non_null(strstr(status_text(), "changed while it was read"));
        mesh_input_close(x);
        assert_int_equal(mem_used(&m), 0);
    }
}

/* ---- a cube, cut above: sides of five corners, points in three faces and in four ---- */

static void test_cube(void **state) {
    static const char text[] =
        "# vtk DataFile Version 3.0\ncube\nASCII\nDATASET UNSTRUCTURED_GRID\n"
        "POINTS 10 float\n0 0 0 4 0 0 4 4 0 0 4 0 0 0 4 4 0 4 4 4 4 0 4 4\n"
        "1 0 4 1 4 4\nCELLS 1 39\n38 7 4 0 1 2 3 5 0 1 5 8 4 4 1 2 6 5\n"
        "5 2 3 7 9 6 4 3 0 4 7 4 4 8 9 7 4 8 5 6 9\nCELL_TYPES 1\n42\n"
        "POINT_DATA 10\nSCALARS f float 1\nLOOKUP_TABLE default\n"
        "0 0 0 0 0 0 0 0 10 0\n";
    static const float middles[3][4] = {{1.8F, 2, 2.4F, 1}, {1.8F, 0, 2.4F, 2}, {1.8F, 4, 2.4F, 0}};
    (void)state;
    double magnitude;
    const mesh_copy *a = mesh_files_good(scratch_text("cube.vtk", text), NULL);
    assert_int_equal(a->report.points, 13);
    for (int i = 0; i < 3; i++) {
        assert_memory_equal(a->xyz[10 + i], middles[i], sizeof a->xyz[0]);
        assert_true(a->values[10 + i] == middles[i][3]);
    }
    (void)mesh_files_volume(a, &magnitude);
    assert_true(fabs(magnitude - 64) < 1e-5);
}

/* A pyramid, whose apex is in four faces: its middle has each point once. */
static void test_apex(void **state) {
    static const char text[] =
        "# vtk DataFile Version 3.0\napex\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 float\n"
        "0 0 0 4 0 0 4 4 0 0 4 0 2 2 5\nCELLS 1 23\n22 5 4 0 1 2 3 3 0 1 4 3 1 2 4 3 2 3 4 3 3 0 "
        "4\n"
        "CELL_TYPES 1\n42\nPOINT_DATA 5\nSCALARS f float 1\nLOOKUP_TABLE default\n0 0 0 0 5\n";
    static const float middle[3] = {2, 2, 1};
    (void)state;
    const mesh_copy *a = mesh_files_good(scratch_text("apex.vtk", text), NULL);
    assert_int_equal(a->report.points, 6);
    assert_memory_equal(a->xyz[5], middle, sizeof middle);
    assert_true(a->values[5] == 1);
}

static void test_faults_of_streams(void **state) {
    static const uint64_t good[] = {3, 0, 1, 2, 3, 0, 1, 3, 3, 0, 2, 3, 3, 1, 2, 3};
    uint64_t bad[16];
    (void)state;
    assert_null(mesh_polyhedron_fault(&(mesh_polyhedron){4, good, 16}));
    memcpy(bad, good, sizeof bad);
    for (uint64_t most = 4; most > 3; most *= 16) { /* up to where it wraps */
        bad[12] = most;
        assert_string_equal(mesh_polyhedron_fault(&(mesh_polyhedron){4, bad, 16}),
                            "has a face that ends behind it");
    }
}

/* A cell's value at its points, and at those that are made of them. */
static void test_cells_to_points(void **state) {
    (void)state;
    const foam f = foam_of(2);
    const mesh_copy *a =
        mesh_files_good(file_of(&f, FACES_AND_OFFSETS), &(mesh_hints){.cells_to_points = true});
    for (uint64_t i = 0; i < a->report.points; i++)
        assert_true(a->values[i] == 7);
}

/* ---- what is refused ---- */

static void test_refused(void **state) {
    static const struct {
        form how;
        const char *old, *patch;
        status st;
        const char *said;
    } cases[] = {
        {FACES_AND_OFFSETS, "\"faces\"", "\"other\"", ST_CORRUPT, "expected an array of faces"},
        {FACES_AND_OFFSETS, "\"faceoffsets\"", "\"other\"", ST_CORRUPT,
         "expected the other arrays"},
        {FACES_AND_OFFSETS, "\n14 4 ", "\n3 4 ", ST_CORRUPT, "has less than four faces"},
        {FACES_AND_OFFSETS, "\n14 4 ", "\n15 4 ", ST_CORRUPT, "has fewer faces than it says"},
        {FACES_AND_OFFSETS, "\n14 4 ", "\n13 4 ", ST_CORRUPT, "has more numbers than its faces"},
        {FACES_AND_OFFSETS, "\n14 4 ", "\n14 2 ", ST_CORRUPT, "less than three corners"},
        {FACES_AND_OFFSETS, "\n14 4 ", "\n14 99 ", ST_CORRUPT, "ends behind it"},
        {FACES_AND_OFFSETS, "\n87 -1", "\n-1 -1", ST_CORRUPT, "is a polyhedron without faces"},
        {FACES_AND_OFFSETS, "\n87 -1", "\n9999999 -1", ST_UNSUPPORTED, "faces of more than"},
        {FACE_LISTS, "\"polyhedron_offsets\"", "\"other\"", ST_CORRUPT,
         "expected the other arrays"},
        {FACE_LISTS, "12 13 \n", "13 12 \n", ST_UNSUPPORTED, "has face 13, expected 12"},
        {FACE_LISTS, "\n14 14", "\n0 14", ST_CORRUPT, "is a polyhedron without faces"},
        {FACE_LISTS, "\n14 14", "\n13 14", ST_CORRUPT, "has faces, but is none"},
        {FACE_LISTS, "\n4 8 ", "\n-1 8 ", ST_CORRUPT, "ends before it begins"},
        {FACE_LISTS, "\n14 14", "\n-1 14", ST_CORRUPT, "ends before it begins"},
        {FACE_LISTS, "\n4 8 ", "\n4 3 ", ST_CORRUPT, "ends before it begins"},
        {LEGACY, "\n87 14 ", "\n87 3 ", ST_CORRUPT, "has less than four faces"},
        {LEGACY, "\n87 14 4", "\n87 14 5", ST_CORRUPT, "cell 0 (counted from 0) has"},
    };
    (void)state;
    const foam f = foam_of(1);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const char *path = vtk_files_patch(file_of(&f, cases[i].how), cases[i].old, cases[i].patch);
        mesh_files_refused(path, NULL, cases[i].st, cases[i].said);
    }
}

/* A cell with an id that is no point is left out, with the points that it would add. */
static void test_bad_ids(void **state) {
    (void)state;
    const foam f = foam_of(2);
    foam g = f;
    g.stream[3][1] = f.points;
    const mesh_copy *a = mesh_files_good(file_of(&g, LEGACY), NULL);
    assert_int_equal(a->report.polyhedra, f.cells - 1);
    assert_int_equal(a->report.bad_indices, 1);
    assert_int_equal(a->report.points, f.points + (f.cells - 1) * (1 + HEXAGONS));
}

static void test_damage(void **state) {
    (void)state;
    const foam f = foam_of(1);
    for (int how = 0; how < FORMS; how++) {
        const char *path = file_of(&f, (form)how);
        (void)mesh_files_damage(path, NULL);
        if (how < LEGACY) /* a legacy file may end behind its points */
            mesh_files_truncate(path, NULL, 12);
        mesh_files_faults(path, NULL);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_forms),
        cmocka_unit_test(test_shared),
        cmocka_unit_test(test_cells_to_points),
        cmocka_unit_test(test_refused),
        cmocka_unit_test(test_pieces),
        cmocka_unit_test(test_fields),
        cmocka_unit_test(test_changed),
        cmocka_unit_test(test_cube),
        cmocka_unit_test(test_apex),
        cmocka_unit_test(test_faults_of_streams),
        cmocka_unit_test(test_bad_ids),
        cmocka_unit_test(test_damage),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
