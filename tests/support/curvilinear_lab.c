#include "tests/support/curvilinear_lab.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/hexahedron.h"
#include "render/curvilinear/curvilinear_walk.h"

typedef struct shape {
    const char *name;
    uint32_t cells[3];
    void (*place)(const double at[3], field_random *r, double out[3]); /* at: each in [0, 1] */
} shape;

static void regular(const double at[3], field_random *r, double out[3]) {
    (void)r;
    out[0] = 12.0 * at[0];
    out[1] = 9.0 * at[1];
    out[2] = 7.0 * at[2];
}

static void bent(const double at[3], field_random *r, double out[3]) {
    (void)r;
    out[0] = 10.0 * at[0] + 0.6 * sin(5.0 * at[1]) + 0.3 * sin(4.0 * at[2]);
    out[1] = 8.0 * at[1] + 0.5 * sin(6.0 * at[2] + at[0]);
    out[2] = 6.0 * at[2] + 0.5 * sin(7.0 * at[0]);
}

/* The first parameter goes round an axis, on which the second one's edges are collapsed. */
static void round_axis(const double at[3], field_random *r, double out[3]) {
    (void)r;
    const double angle = 6.0 * at[0];
    out[0] = 5.0 * at[1] * cos(angle);
    out[1] = 5.0 * at[1] * sin(angle);
    out[2] = 4.0 * at[2] + 0.5 * at[1] * at[1];
}

static void flat(const double at[3], field_random *r, double out[3]) {
    bent(at, r, out);
    out[2] *= 1e-3;
}

static void shaken(const double at[3], field_random *r, double out[3]) {
    bent(at, r, out);
    for (int a = 0; a < 3; a++)
        out[a] += 0.9 * (field_random_unit(r) - 0.5); /* some cells are folded */
}

/* Left-handed, and far from the origin. */
static void mirrored(const double at[3], field_random *r, double out[3]) {
    bent(at, r, out);
    out[0] = 4000.0 - out[0];
}

static const shape shapes[] = {
    {"regular", {12, 9, 7}, regular},
    {"bent", {32, 8, 8}, bent},
    {"round an axis", {16, 6, 5}, round_axis},
    {"flat", {9, 9, 9}, flat},
    {"shaken", {11, 7, 6}, shaken},
    {"mirrored", {8, 8, 8}, mirrored},
    {"one cell", {1, 1, 1}, bent},
    {"a row", {1, 13, 1}, shaken},
};

int curvilinear_lab_count(void) {
    return sizeof shapes / sizeof *shapes;
}

static void make_nodes(curvilinear_lab *s, const shape *of, field_random *r) {
    const uint32_t *cells = of->cells;
    uint32_t n = 0;
    for (int a = 0; a < 3; a++) {
        s->box[0][a] = INFINITY;
        s->box[1][a] = -INFINITY;
    }
    for (uint32_t k = 0; k <= cells[2]; k++)
        for (uint32_t j = 0; j <= cells[1]; j++)
            for (uint32_t i = 0; i <= cells[0]; i++, n++) {
                const double at[3] = {(double)i / cells[0], (double)j / cells[1],
                                      (double)k / cells[2]};
                double p[3];
                of->place(at, r, p);
                for (int a = 0; a < 3; a++) {
                    s->p[a][n] = (float)p[a];
                    s->box[0][a] = fminf(s->box[0][a], s->p[a][n]);
                    s->box[1][a] = fmaxf(s->box[1][a], s->p[a][n]);
                }
                s->values[n] = (float)(0.6 * sin(9.0 * at[0] + 4.0 * at[1]) +
                                       0.3 * cos(11.0 * at[2] - 5.0 * at[1]) +
                                       0.1 * (2.0 * field_random_unit(r) - 1.0));
            }
    if (n > CURVILINEAR_LAB_NODES)
        abort();
    for (int a = 0; a < 3; a++)
        for (int i = 0; i < CURVILINEAR_READ; i++)
            s->p[a][n + (uint32_t)i] = NAN; /* which must not matter */
}

void curvilinear_lab_make(curvilinear_lab *s, mem *m, int index) {
    const shape *of = &shapes[index];
    field_random r = {FIELD_SEED + (uint64_t)index};
    const float *const p[3] = {s->p[0], s->p[1], s->p[2]};
    s->name = of->name;
    s->count = of->cells[0] * of->cells[1] * of->cells[2];
    make_nodes(s, of, &r);
    if (curvilinear_lattice_init(&s->lattice, m, of->cells, p, s->codes) != ST_OK)
        abort();
    curvilinear_lattice_move(&s->lattice);
    s->lattice.first = 1000;
    s->lattice.values = s->values;
    memset(s->codes, 0, sizeof s->codes);
    for (uint32_t c = 0; c < s->count; c++) {
        const hexahedron h = curvilinear_walk_cell(&s->lattice, c);
        const int sense = hexahedron_sense(h.p);
        const bool none = index > 0 && s->count > 1 && field_random_below(&r, 40) == 0;
        const unsigned code = none        ? HEX_NONE
                              : sense > 0 ? HEX_RIGHT
                              : sense < 0 ? HEX_LEFT
                                          : HEX_FOLDED;
        s->codes[c / 4] |= (uint8_t)(code << 2 * (c % 4));
    }
    for (int n = 0; n < 3 && index > 0 && s->count > 100; n++)
        s->values[field_random_below(&r, s->count)] = n < 2 ? NAN : INFINITY;
    curvilinear_lattice_fill(&s->lattice, s->values);
}

void curvilinear_lab_free(curvilinear_lab *s) {
    curvilinear_lattice_release(&s->lattice);
}

ray curvilinear_lab_ray(const curvilinear_lab *s, field_random *r) {
    ray out = {.t0 = -INFINITY, .t1 = INFINITY};
    const long what = field_random_below(r, 8);
    double to[3];
    for (int a = 0; a < 3; a++) {
        const double lo = (double)s->box[0][a], size = (double)s->box[1][a] - lo;
        out.o[a] = lo + size * field_random_in(r, -1.0, 2.0);
        to[a] = lo + size * field_random_unit(r);
    }
    if (what == 0) {
        const uint32_t *nodes = s->lattice.nodes;
        const long n = field_random_below(r, (long)(nodes[0] * nodes[1] * nodes[2]));
        const int along = (int)field_random_below(r, 3);
        for (int a = 0; a < 3; a++) {
            to[a] = (double)s->p[a][n];
            out.o[a] = a == along ? out.o[a] : to[a];
        }
    }
    for (int a = 0; a < 3; a++)
        out.d[a] = to[a] - out.o[a] + 0.0;
    if (what == 1) {
        out.t0 = field_random_in(r, -0.5, 1.0);
        out.t1 = out.t0 + 1.0;
    }
    return out;
}
