#include "tests/support/vtk_grid_files.h"

#include <stdlib.h>
#include <string.h>

#include "tests/support/scratch.h"
#include "tests/support/volumes.h"

/* Of a piece, from 0 on: nodes, both ends included. */
typedef struct extent {
    int lo[3], hi[3];
} extent;

double vtk_grid_files_coordinate(int a, int i) {
    return (i * i + 2 * i + a) / 4.0;
}

static const char *type_of(const vtk_grid_style *g) {
    return g->type ? g->type : "Float32";
}

/* ---- extents ---- */

static extent whole(const vtk_grid_style *g) {
    const int more = g->of_cells;
    return (extent){{0, 0, 0},
                    {VOLUMES_NX - 1 + more, VOLUMES_NY - 1 + more, VOLUMES_NZ - 1 + more}};
}

/* The piece of that number, of 8: false when there is none. */
static bool piece_of(const vtk_grid_style *g, unsigned number, extent *out) {
    *out = whole(g);
    for (int a = 0; a < 3; a++) {
        const int last = out->hi[a], cut = (last + 1) / 2;
        const bool second = number >> a & 1;
        if (!(g->cuts >> a & 1)) {
            if (second)
                return false;
        } else if (second)
            out->lo[a] = cut > g->ghosts ? cut - g->ghosts : 0;
        else
            out->hi[a] = cut + g->ghosts < last ? cut + g->ghosts : last;
    }
    return true;
}

static void put_extent(FILE *out, const char *name, const vtk_grid_style *g, const extent *e) {
    fprintf(out, " %s=\"", name);
    for (int a = 0; a < 3; a++)
        fprintf(out, "%s%d %d", a ? " " : "", e->lo[a] + g->lo[a], e->hi[a] + g->lo[a]);
    fprintf(out, "\"");
}

/* ---- arrays ---- */

enum { ROOM = 3 * 5 * 4 * 3 };

static double sample(const char *name, const char *type, int n, int component) {
    if (strcmp(name, "v") == 0)
        return (int[]){3, 4, 12}[component] * n;
    if (strcmp(name, "rgb") == 0)
        return n;
    return *type == 'U' ? 7 * n : 7 * n - 50;
}

/* An array's numbers in a box of samples; how many. */
static size_t numbers_of(const vtk_grid_style *g, const char *name, int components, const extent *e,
                         double numbers[ROOM]) {
    size_t count = 0;
    for (int k = e->lo[2]; k < e->hi[2] + !g->of_cells; k++)
        for (int j = e->lo[1]; j < e->hi[1] + !g->of_cells; j++)
            for (int i = e->lo[0]; i < e->hi[0] + !g->of_cells; i++)
                for (int c = 0; c < components; c++)
                    numbers[count++] =
                        sample(name, type_of(g), i + VOLUMES_NX * (j + VOLUMES_NY * k), c);
    return count;
}

static size_t coordinates_of(int a, const extent *e, double numbers[ROOM]) {
    for (int i = e->lo[a]; i <= e->hi[a]; i++)
        numbers[i - e->lo[a]] = vtk_grid_files_coordinate(a, i);
    return (size_t)(e->hi[a] - e->lo[a] + 1);
}

/* ---- XML ---- */

static void put_array(vtk_writer *w, const vtk_grid_style *g, const char *name, const char *type,
                      int components, const extent *e) {
    double numbers[ROOM];
    const size_t count = numbers_of(g, name, components, e, numbers);
    vtk_writer_array(w, name, type, components, count, numbers);
}

static void put_arrays(vtk_writer *w, const vtk_grid_style *g, const extent *e) {
    const char *owner = g->of_cells ? "CellData" : "PointData";
    if (g->both) {
        const vtk_grid_style points = {.type = "Int8"};
        fprintf(w->out, "<PointData>\n");
        put_array(w, &points, "p", "Int8", 1, e);
        fprintf(w->out, "</PointData>\n");
    }
    fprintf(w->out, "<%s Scalars=\"s\">\n", owner);
    put_array(w, g, "s", type_of(g), 1, e);
    put_array(w, g, "v", "Float32", 3, e);
    put_array(w, g, "rgb", "UInt8", 3, e);
    fprintf(w->out, "</%s>\n", owner);
}

static void put_piece(vtk_writer *w, const vtk_grid_style *g, const extent *e) {
    double numbers[ROOM];
    fprintf(w->out, "<Piece");
    put_extent(w->out, "Extent", g, e);
    fprintf(w->out, ">\n");
    put_arrays(w, g, e);
    if (g->rectilinear) {
        fprintf(w->out, "<Coordinates>\n");
        for (int a = 0; a < 3; a++) {
            const size_t count = coordinates_of(a, e, numbers);
            vtk_writer_array(w, "", a == 1 ? "Float32" : "Float64", 1, count, numbers);
        }
        fprintf(w->out, "</Coordinates>\n");
    }
    fprintf(w->out, "</Piece>\n");
}

static const char *element_of(const vtk_grid_style *g) {
    return g->rectilinear ? "RectilinearGrid" : "ImageData";
}

static void put_start(vtk_writer *w, const vtk_grid_style *g, const char *prefix, const extent *e) {
    fprintf(w->out, "<%s%s", prefix, element_of(g));
    put_extent(w->out, "WholeExtent", g, e);
    fprintf(w->out, " %s>\n", g->attributes ? g->attributes : "");
}

static const char *put_file(const char *name, const vtk_grid_style *g, const extent *only) {
    vtk_writer w;
    const extent all = whole(g);
    extent e;
    vtk_writer_begin(&w, element_of(g), &g->xml);
    put_start(&w, g, "", &all);
    for (unsigned i = 0; i < 8; i++)
        if (only ? i == 0 : piece_of(g, i, &e))
            put_piece(&w, g, only ? only : &e);
    fprintf(w.out, "</%s>\n", element_of(g));
    return vtk_writer_end(&w, name);
}

const char *vtk_grid_files_xml(const char *name, const vtk_grid_style *g) {
    return put_file(name, g, NULL);
}

const char *vtk_grid_files_parallel(const char *name, const vtk_grid_style *g) {
    vtk_writer w;
    const vtk_xml_style plain = {.text = true};
    const extent all = whole(g);
    char type[32], piece[32];
    extent e;
    snprintf(type, sizeof type, "P%s", element_of(g));
    vtk_writer_begin(&w, type, &plain);
    put_start(&w, g, "P", &all);
    fprintf(w.out, "<PPointData><PDataArray type=\"Float32\" Name=\"s\"/></PPointData>\n");
    for (unsigned i = 0; i < 8; i++)
        if (piece_of(g, i, &e)) {
            snprintf(piece, sizeof piece, "piece %u.%s", i, g->rectilinear ? "vtr" : "vti");
            put_file(piece, g, &e);
            fprintf(w.out, "<Piece");
            put_extent(w.out, "Extent", g, &e);
            fprintf(w.out, " Source=\"%s\"/>\n", piece);
        }
    fprintf(w.out, "</%s>\n", type);
    return vtk_writer_end(&w, name);
}

/* ---- legacy ---- */

static const char *legacy_type(const char *type) {
    static const char *const names[][2] = {
        {"Int8", "char"},          {"UInt8", "unsigned_char"},
        {"Int16", "short"},        {"UInt16", "unsigned_short"},
        {"Int32", "int"},          {"UInt32", "unsigned_int"},
        {"Int64", "vtktypeint64"}, {"UInt64", "vtktypeuint64"},
        {"Float32", "float"},      {"Float64", "double"},
    };
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (strcmp(type, names[i][0]) == 0)
            return names[i][1];
    abort();
}

static void put_legacy_geometry(FILE *out, const vtk_grid_style *g, const extent *e) {
    double numbers[ROOM];
    if (g->lo[0] || g->lo[1] || g->lo[2])
        fprintf(out, "EXTENT %d %d %d %d %d %d\n", g->lo[0], e->hi[0] + g->lo[0], g->lo[1],
                e->hi[1] + g->lo[1], g->lo[2], e->hi[2] + g->lo[2]);
    else
        fprintf(out, "DIMENSIONS %d %d %d\n", e->hi[0] + 1, e->hi[1] + 1, e->hi[2] + 1);
    if (!g->rectilinear)
        fprintf(out, "%s", g->attributes ? g->attributes : "");
    for (int a = 0; a < 3 && g->rectilinear; a++) {
        const size_t count = coordinates_of(a, e, numbers);
        fprintf(out, "%c_COORDINATES %zu %s\n", "XYZ"[a], count, a == 1 ? "float" : "double");
        vtk_writer_numbers(out, g->xml.text, a == 1 ? "Float32" : "Float64", count, numbers);
    }
}

const char *vtk_grid_files_legacy(const char *name, const vtk_grid_style *g, int major, int minor) {
    vtk_writer w;
    double numbers[ROOM];
    const extent e = whole(g);
    const char *type = type_of(g);
    vtk_writer_open(&w);
    fprintf(w.out, "# vtk DataFile Version %d.%d\na grid\n%s\nDATASET %s\n", major, minor,
            g->xml.text ? "ASCII" : "BINARY",
            g->rectilinear ? "RECTILINEAR_GRID" : "STRUCTURED_POINTS");
    put_legacy_geometry(w.out, g, &e);
    size_t count = numbers_of(g, "s", 1, &e, numbers);
    fprintf(w.out, "%s %zu\nSCALARS s %s 1\nLOOKUP_TABLE hot\n",
            g->of_cells ? "CELL_DATA" : "POINT_DATA", count, legacy_type(type));
    vtk_writer_numbers(w.out, g->xml.text, type, count, numbers);
    fprintf(w.out, "LOOKUP_TABLE hot 2\n");
    const double table[8] = {0};
    vtk_writer_numbers(w.out, g->xml.text, "UInt8", 8, table);
    fprintf(w.out, "VECTORS v float\n");
    vtk_writer_numbers(w.out, g->xml.text, "Float32", numbers_of(g, "v", 3, &e, numbers), numbers);
    fprintf(w.out, "FIELD FieldData 1\nrgb 3 %zu unsigned_char\n", count);
    vtk_writer_numbers(w.out, g->xml.text, "UInt8", numbers_of(g, "rgb", 3, &e, numbers), numbers);
    return vtk_writer_close(&w, name);
}
