#include "tests/support/cell_mix.h"

#include <string.h>

/* A vertex of the mesh. */
typedef struct vertex {
    double p[3], value;
    unsigned sides;
} vertex;

static vertex node_of(const hex_lab *s, int i, int j, int k) {
    const int at[3] = {i, j, k};
    vertex v = {.value = (double)s->value[k][j][i]};
    for (int a = 0; a < 3; a++) {
        v.p[a] = (double)s->p[k][j][i][a];
        if (a > 0 || !s->closed)
            v.sides |= (unsigned)(at[a] == 0) << 2 * a | (unsigned)(at[a] == HEX_LAB_CELLS)
                                                             << (2 * a + 1);
    }
    return v;
}

/* A new vertex in the middle, as floats are. */
static vertex middle_of(const vertex *v, int count) {
    vertex out = {.value = 0.0};
    for (int i = 0; i < count; i++) {
        for (int a = 0; a < 3; a++)
            out.p[a] += v[i].p[a] / count;
        out.value += v[i].value / count;
    }
    for (int a = 0; a < 3; a++)
        out.p[a] = (double)(float)out.p[a];
    out.value = (double)(float)out.value;
    return out;
}

static void add(cell_mix *m, cell_shape shape, const vertex *const *v) {
    cell_mix_cell *c = &m->cell[m->count++];
    c->shape = shape;
    for (int i = 0; i < cell_shape_vertices(shape); i++) {
        memcpy(c->p[i], v[i]->p, sizeof c->p[i]);
        c->value[i] = v[i]->value;
        c->sides[i] = v[i]->sides;
    }
}

/* Faces of a hexahedron and of a wedge around, each seen from inside counterclockwise or not. */
static const int hex_faces[6][4] = {{0, 1, 2, 3}, {4, 7, 6, 5}, {0, 4, 5, 1},
                                    {1, 5, 6, 2}, {2, 6, 7, 3}, {3, 7, 4, 0}};
static const int wedge_quads[3][4] = {{0, 3, 4, 1}, {1, 4, 5, 2}, {2, 5, 3, 0}};
static const int wedge_ends[2][3] = {{0, 1, 2}, {3, 5, 4}};

static void add_pyramid(cell_mix *m, const vertex *v, const int quad[4], const vertex *apex) {
    add(m, CELL_PYRAMID,
        (const vertex *const[]){&v[quad[0]], &v[quad[1]], &v[quad[2]], &v[quad[3]], apex});
}

static void add_wedge(cell_mix *m, const vertex v[6], bool cut) {
    if (!cut) {
        add(m, CELL_WEDGE, (const vertex *const[]){&v[0], &v[1], &v[2], &v[3], &v[4], &v[5]});
        return;
    }
    const vertex apex = middle_of(v, 6);
    for (int i = 0; i < 3; i++)
        add_pyramid(m, v, wedge_quads[i], &apex);
    for (int i = 0; i < 2; i++)
        add(m, CELL_TET,
            (const vertex *const[]){&v[wedge_ends[i][0]], &v[wedge_ends[i][1]],
                                    &v[wedge_ends[i][2]], &apex});
}

static void add_hexahedron(cell_mix *m, const vertex v[8], bool cut) {
    if (!cut) {
        add(m, CELL_HEXAHEDRON,
            (const vertex *const[]){&v[0], &v[1], &v[2], &v[3], &v[4], &v[5], &v[6], &v[7]});
        return;
    }
    const vertex apex = middle_of(v, 8);
    for (int i = 0; i < 6; i++)
        add_pyramid(m, v, hex_faces[i], &apex);
}

static const int around[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};

/* Add the cells at a place of the grid, whose vertices these are. */
typedef void add_place(cell_mix *m, const int at[3], const vertex v[8]);

static void each_place(cell_mix *m, add_place *add_at) {
    m->count = 0;
    for (int k = 0; k < HEX_LAB_CELLS; k++)
        for (int j = 0; j < HEX_LAB_CELLS; j++)
            for (int i = 0; i < HEX_LAB_CELLS; i++) {
                vertex v[8];
                for (int n = 0; n < 8; n++)
                    v[n] = node_of(&m->lab, i + around[n % 4][0], j + around[n % 4][1], k + n / 4);
                add_at(m, (const int[3]){i, j, k}, v);
            }
}

static void add_cut(cell_mix *m, const int at[3], const vertex v[8]) {
    static const int halves[2][3] = {{0, 1, 2}, {0, 2, 3}};
    if ((at[0] + at[1]) % 2 == 0) {
        add_hexahedron(m, v, (at[0] + at[2]) % 3 == 0);
        return;
    }
    for (int h = 0; h < 2; h++) {
        vertex w[6];
        for (int n = 0; n < 6; n++)
            w[n] = v[halves[h][n % 3] + 4 * (n / 3)];
        add_wedge(m, w, (at[2] + h) % 2 == 0);
    }
}

void cell_mix_make(cell_mix *m, int index, uint64_t seed) {
    hex_lab_make(&m->lab, index, seed);
    each_place(m, add_cut);
}

static void add_whole(cell_mix *m, const int at[3], const vertex v[8]) {
    (void)at;
    add_hexahedron(m, v, false);
}

void cell_mix_whole(cell_mix *m, const hex_lab *s) {
    m->lab = *s;
    each_place(m, add_whole);
}

/* Which corner of the shape's own hexahedron is corner c of the turned one. */
static int turned(int turn, int c) {
    const int flips = turn % 8, first = turn / 8 % 3, step = 1 + turn / 24;
    int from = 0;
    for (int a = 0; a < 3; a++)
        from |= ((c ^ flips) >> a & 1) << (first + a * step) % 3;
    return from;
}

hexahedron cell_mix_hexahedron(const cell_mix_cell *c, int turn) {
    const uint8_t *corners = cell_shape_row(c->shape);
    hexahedron h;
    for (int i = 0; i < HEX_CORNERS; i++) {
        const int v = corners[turned(turn, i)];
        memcpy(h.p[i], c->p[v], sizeof h.p[i]);
        h.value[i] = c->value[v];
    }
    return h;
}

bool cell_mix_outside(const cell_mix_cell *c, int turn, const double at[3]) {
    const uint8_t *corners = cell_shape_row(c->shape);
    for (int face = 0; face < HEX_FACES; face++) {
        int corner[4];
        unsigned sides = ~0U;
        (void)hexahedron_face(face, corner);
        for (int i = 0; i < 4; i++)
            sides &= c->sides[corners[turned(turn, corner[i])]];
        if (sides && at[face / 2] == (double)(face & 1))
            return true;
    }
    return false;
}
