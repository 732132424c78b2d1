#include "tests/support/hex_lab.h"

#include <math.h>

static const double PI = 3.14159265358979323846;

typedef void (*shape)(const double u[3], field_random *r, double p[3]);

static void bent(const double u[3], field_random *r, double p[3]) {
    (void)r;
    for (int a = 0; a < 3; a++)
        p[a] = u[a] + 0.08 * sin(4.0 * u[(a + 1) % 3] + (double)a) * cos(3.0 * u[(a + 2) % 3]);
}

static void twisted(const double u[3], field_random *r, double p[3]) {
    const double angle = 2.5 * u[2], x = u[0] - 0.5, y = u[1] - 0.5;
    (void)r;
    p[0] = cos(angle) * x - sin(angle) * y;
    p[1] = sin(angle) * x + cos(angle) * y;
    p[2] = u[2];
}

static void jittered(const double u[3], field_random *r, double p[3]) {
    for (int a = 0; a < 3; a++)
        p[a] = u[a] + field_random_in(r, -0.17, 0.17) / HEX_LAB_CELLS;
}

static void folded(const double u[3], field_random *r, double p[3]) {
    for (int a = 0; a < 3; a++)
        p[a] = u[a] + field_random_in(r, -0.45, 0.45) / HEX_LAB_CELLS;
}

static void regular(const double u[3], field_random *r, double p[3]) {
    (void)r;
    for (int a = 0; a < 3; a++)
        p[a] = HEX_LAB_CELLS * u[a];
}

/* Round the z axis; with a collapsed axis: the radius begins at 0. */
static void pie(const double u[3], field_random *r, double p[3]) {
    (void)r;
    p[0] = u[1] * cos(2.0 * PI * u[0]);
    p[1] = u[1] * sin(2.0 * PI * u[0]);
    p[2] = u[2];
}

static void ball(const double u[3], field_random *r, double p[3]) {
    const double radius = 0.5 + 0.5 * u[2], pole = sin(PI * u[1]);
    (void)r;
    p[0] = radius * (u[1] == 1.0 ? 0.0 : pole) * cos(2.0 * PI * u[0]);
    p[1] = radius * (u[1] == 1.0 ? 0.0 : pole) * sin(2.0 * PI * u[0]);
    p[2] = -radius * cos(PI * u[1]);
}

static void flat(const double u[3], field_random *r, double p[3]) {
    bent(u, r, p);
    p[2] *= 1e-3;
}

static void flatter(const double u[3], field_random *r, double p[3]) {
    bent(u, r, p);
    p[0] *= 1e-5;
}

static void mirrored(const double u[3], field_random *r, double p[3]) {
    bent(u, r, p);
    p[1] = 1.0 - p[1];
}

static void far_away(const double u[3], field_random *r, double p[3]) {
    jittered(u, r, p);
    for (int a = 0; a < 3; a++)
        p[a] += 300.0;
}

static const struct {
    const char *name;
    shape make;
    bool closed, may_be_folded;
} shapes[] = {
    {"bent", bent, false, false},        {"twisted", twisted, false, false},
    {"jittered", jittered, false, true}, {"pie", pie, true, false},
    {"ball", ball, true, false},         {"flat", flat, false, false},
    {"flatter", flatter, false, false},  {"mirrored", mirrored, false, false},
    {"far away", far_away, false, true}, {"regular", regular, false, false},
    {"folded", folded, false, true},
};

int hex_lab_count(void) {
    return (int)(sizeof shapes / sizeof *shapes);
}

void hex_lab_make(hex_lab *s, int index, uint64_t seed) {
    field_random r = {seed};
    s->name = shapes[index].name;
    s->closed = shapes[index].closed;
    s->may_be_folded = shapes[index].may_be_folded;
    s->regular = shapes[index].make == regular;
    s->iso = 0.1;
    double box[2][3] = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    for (int k = 0; k < HEX_LAB_NODES; k++)
        for (int j = 0; j < HEX_LAB_NODES; j++)
            for (int i = 0; i < HEX_LAB_NODES; i++) {
                const int first = s->closed && i == HEX_LAB_CELLS ? 0 : i;
                const double u[3] = {(double)first / HEX_LAB_CELLS, (double)j / HEX_LAB_CELLS,
                                     (double)k / HEX_LAB_CELLS};
                double p[3];
                shapes[index].make(u, &r, p);
                for (int a = 0; a < 3; a++) {
                    s->p[k][j][i][a] = (float)p[a];
                    box[0][a] = fmin(box[0][a], p[a]);
                    box[1][a] = fmax(box[1][a], p[a]);
                }
                s->value[k][j][i] = (float)(sin(7.0 * u[1] + 5.0 * u[2]) * cos(2.0 * PI * u[0]) +
                                            field_random_in(&r, -0.4, 0.4));
            }
    s->size = 0.0;
    for (int a = 0; a < 3; a++)
        s->size = fmax(s->size, box[1][a] - box[0][a]);
    /* What collapses or closes has one value there. */
    for (int k = 0; k < HEX_LAB_NODES; k++)
        for (int j = 0; j < HEX_LAB_NODES; j++)
            for (int i = 0; i < HEX_LAB_NODES; i++)
                for (int b = 0; b < j + 1; b++)
                    for (int a = 0; a < HEX_LAB_NODES; a++)
                        if (s->p[k][j][i][0] == s->p[k][b][a][0] &&
                            s->p[k][j][i][1] == s->p[k][b][a][1] &&
                            s->p[k][j][i][2] == s->p[k][b][a][2]) {
                            s->value[k][j][i] = s->value[k][b][a];
                            b = j;
                            break;
                        }
}

hexahedron hex_lab_cell(const hex_lab *s, const int at[3]) {
    hexahedron h;
    for (int c = 0; c < HEX_CORNERS; c++) {
        const int i = at[0] + (c & 1), j = at[1] + (c >> 1 & 1), k = at[2] + (c >> 2);
        for (int a = 0; a < 3; a++)
            h.p[c][a] = (double)s->p[k][j][i][a];
        h.value[c] = (double)s->value[k][j][i];
    }
    return h;
}

ray hex_lab_ray(const hex_lab *s, field_random *r, bool *special) {
    const bool node = field_random_below(r, 8) == 0, edge = field_random_below(r, 16) == 0;
    const int at[3] = {(int)field_random_below(r, HEX_LAB_CELLS),
                       (int)field_random_below(r, HEX_LAB_CELLS),
                       (int)field_random_below(r, HEX_LAB_CELLS)};
    const hexahedron h = hex_lab_cell(s, at);
    ray out = {.t0 = -INFINITY, .t1 = INFINITY};
    double to[3], u[3], length = 0.0;
    for (int a = 0; a < 3; a++)
        u[a] = node ? (double)field_random_below(r, 2) : field_random_unit(r);
    for (int a = 0; a < 3; a++) {
        double p[HEX_CORNERS];
        for (int c = 0; c < HEX_CORNERS; c++)
            p[c] = h.p[c][a];
        to[a] = hexahedron_at(p, u);
        out.d[a] = field_random_in(r, -1.0, 1.0);
        if (edge)
            out.d[a] = p[1] - p[0];
        if (!node && !edge && field_random_below(r, 16) == 0)
            out.d[a] = 0.0;
        length += out.d[a] * out.d[a];
    }
    if (length == 0.0)
        out.d[0] = length = 1.0;
    for (int a = 0; a < 3; a++) {
        out.d[a] = out.d[a] / sqrt(length) + 0.0; /* no -0 */
        out.o[a] = to[a] - 3.0 * s->size * out.d[a];
    }
    *special = node || edge;
    return out;
}
