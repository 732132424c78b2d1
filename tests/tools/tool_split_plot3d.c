/* tool_split_plot3d.c - a curvilinear PLOT3D grid as tetrahedra: each cell becomes six around its
 * main diagonal, alike in all cells, so that neighbours agree on every face.
 *
 *   split_plot3d XYZ Q OUT [density|pressure|momentum|energy]
 *
 * XYZ and Q are one whole grid each, C binary without record marks, big endian float32, three
 * int32 dimensions first; bytes behind the last array are passed over. OUT is a mesh stream ("-":
 * stdout). Pressure is that of an ideal gas with gamma 1.4; momentum is its length.
 */
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NODES_MAX = 1 << 26, TETS_A_CELL = 6, VARIABLES = 5 };
enum { DENSITY, ENERGY = 4 };

typedef struct grid {
    uint32_t dims[3];
    size_t nodes, cells;
    float *xyz;    /* all x, all y, all z */
    float *q;      /* density, momentum x, y, z, energy */
    float *values; /* the field asked for */
} grid;

_Noreturn static void stop(int code, const char *path, const char *what) {
    fprintf(stderr, "split_plot3d: %s: %s\n", path, what);
    exit(code);
}

/* ---- reading ---- */

static uint32_t big_endian(const unsigned char b[4]) {
    return (uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 | (uint32_t)b[2] << 8 | b[3];
}

static void read_words(FILE *in, const char *path, uint32_t *out, size_t count) {
    unsigned char b[4];
    for (size_t i = 0; i < count; i++) {
        if (fread(b, sizeof b, 1, in) != 1)
            stop(3, path, "ends too early");
        out[i] = big_endian(b);
    }
}

/* The arrays of a file behind its dimensions and `skip` words. */
static float *read_arrays(const char *path, uint32_t dims[3], size_t skip, size_t arrays) {
    uint32_t words[4];
    FILE *in = fopen(path, "rb");
    if (!in)
        stop(1, path, "cannot be opened");
    read_words(in, path, dims, 3);
    for (int a = 0; a < 3; a++)
        if (dims[a] < 2 || dims[a] > NODES_MAX)
            stop(3, path, "dimensions make no sense");
    uint64_t nodes = (uint64_t)dims[0] * dims[1];
    if (nodes > NODES_MAX || nodes * dims[2] > NODES_MAX)
        stop(3, path, "too many nodes");
    size_t count = arrays * (size_t)(nodes * dims[2]);
    read_words(in, path, words, skip);
    uint32_t *bits = malloc(count * sizeof *bits);
    float *out = malloc(count * sizeof *out);
    if (!bits || !out)
        stop(4, path, "no room");
    read_words(in, path, bits, count);
    memcpy(out, bits, count * sizeof *out);
    free(bits);
    fclose(in);
    return out;
}

static float value_of(const grid *g, const char *field, size_t i) {
    double v[VARIABLES];
    for (size_t k = 0; k < VARIABLES; k++)
        v[k] = g->q[k * g->nodes + i];
    double squares = v[1] * v[1] + v[2] * v[2] + v[3] * v[3];
    if (strcmp(field, "momentum") == 0)
        return (float)sqrt(squares);
    if (strcmp(field, "energy") == 0)
        return (float)v[ENERGY];
    if (strcmp(field, "pressure") == 0)
        return (float)((1.4 - 1) * (v[ENERGY] - squares / v[DENSITY] / 2));
    return (float)v[DENSITY];
}

static grid read_grid(const char *xyz_path, const char *q_path, const char *field) {
    grid g = {0};
    uint32_t q_dims[3];
    g.xyz = read_arrays(xyz_path, g.dims, 0, 3);
    g.q = read_arrays(q_path, q_dims, 4, VARIABLES);
    if (memcmp(g.dims, q_dims, sizeof q_dims) != 0)
        stop(3, q_path, "other dimensions than the nodes");
    g.nodes = (size_t)g.dims[0] * g.dims[1] * g.dims[2];
    g.cells = (size_t)(g.dims[0] - 1) * (g.dims[1] - 1) * (g.dims[2] - 1);
    g.values = malloc(g.nodes * sizeof *g.values);
    if (!g.values)
        stop(4, q_path, "no room");
    for (size_t i = 0; i < g.nodes; i++)
        g.values[i] = value_of(&g, field, i);
    return g;
}

/* ---- writing: words little endian ---- */

static void write_word(FILE *out, uint32_t word) {
    unsigned char b[4] = {(unsigned char)word, (unsigned char)(word >> 8),
                          (unsigned char)(word >> 16), (unsigned char)(word >> 24)};
    fwrite(b, sizeof b, 1, out);
}

static void write_float(FILE *out, float value) {
    uint32_t word;
    memcpy(&word, &value, sizeof word);
    write_word(out, word);
}

/* The six ways from corner 0 to corner 7, one axis after the other. */
static void write_cell(FILE *out, const grid *g, size_t corner) {
    static const int orders[TETS_A_CELL][3] = {{0, 1, 2}, {1, 0, 2}, {1, 2, 0},
                                               {2, 1, 0}, {2, 0, 1}, {0, 2, 1}};
    const size_t step[3] = {1, g->dims[0], (size_t)g->dims[0] * g->dims[1]};
    for (int n = 0; n < TETS_A_CELL; n++) {
        size_t at = corner;
        write_word(out, (uint32_t)at);
        for (int k = 0; k < 3; k++) {
            at += step[orders[n][k]];
            write_word(out, (uint32_t)at);
        }
    }
}

static void write_mesh(FILE *out, const grid *g, const char *field) {
    fprintf(out, "LEAFCAST MESH 1\nname: plot3d\nfield: %s\npoints: %zu\ntets: %zu\n\n", field,
            g->nodes, TETS_A_CELL * g->cells);
    for (size_t i = 0; i < g->nodes; i++)
        for (size_t a = 0; a < 3; a++)
            write_float(out, g->xyz[a * g->nodes + i]);
    for (size_t i = 0; i < g->nodes; i++)
        write_float(out, g->values[i]);
    for (size_t z = 0; z + 1 < g->dims[2]; z++)
        for (size_t y = 0; y + 1 < g->dims[1]; y++)
            for (size_t x = 0; x + 1 < g->dims[0]; x++)
                write_cell(out, g, x + g->dims[0] * (y + g->dims[1] * z));
}

static bool is_field(const char *name) {
    static const char *const names[] = {"density", "pressure", "momentum", "energy"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        if (strcmp(name, names[i]) == 0)
            return true;
    return false;
}

int main(int argc, char **argv) {
    const char *field = argc > 4 ? argv[4] : "density";
    if (argc < 4 || argc > 5 || !is_field(field)) {
        fprintf(stderr, "split_plot3d XYZ Q OUT [density|pressure|momentum|energy]\n");
        return 2;
    }
    grid g = read_grid(argv[1], argv[2], field);
    FILE *out = strcmp(argv[3], "-") == 0 ? stdout : fopen(argv[3], "wb");
    if (!out)
        stop(1, argv[3], "cannot be written");
    write_mesh(out, &g, field);
    if (ferror(out) | fclose(out))
        stop(1, argv[3], "cannot be written");
    free(g.xyz);
    free(g.q);
    free(g.values);
    return 0;
}
