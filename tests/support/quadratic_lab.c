#include "tests/support/quadratic_lab.h"

#include <math.h>
#include <stddef.h>

enum { N = QUADRATIC_LAB_NODES };

typedef void (*shape)(const double u[3], const bool corner[3], field_random *r, double p[3]);

static bool is_corner(const bool even[3]) {
    return even[0] && even[1] && even[2];
}

static void regular(const double u[3], const bool even[3], field_random *r, double p[3]) {
    (void)even;
    (void)r;
    for (int a = 0; a < 3; a++)
        p[a] = u[a];
}

/* Corners anywhere; quadratic_lab_make() puts the others in the middle. */
static void jittered(const double u[3], const bool even[3], field_random *r, double p[3]) {
    (void)even;
    for (int a = 0; a < 3; a++)
        p[a] = u[a] + field_random_in(r, -0.1, 0.1) / QUADRATIC_LAB_CUBES;
}

static void bent(const double u[3], const bool even[3], field_random *r, double p[3]) {
    (void)even;
    (void)r;
    for (int a = 0; a < 3; a++)
        p[a] = u[a] + 0.07 * sin(4.0 * u[(a + 1) % 3] + (double)a) * cos(3.0 * u[(a + 2) % 3]);
}

/* Edges' nodes beside the middle, each by itself. */
static void wild(const double u[3], const bool even[3], field_random *r, double p[3]) {
    const double by = is_corner(even) ? 0.0 : 0.08;
    for (int a = 0; a < 3; a++)
        p[a] = u[a] + field_random_in(r, -by, by) / QUADRATIC_LAB_CUBES;
}

/* The same, of one edge in eight. */
static void a_few(const double u[3], const bool even[3], field_random *r, double p[3]) {
    const double by = field_random_below(r, 8) == 0 && !is_corner(even) ? 0.1 : 0.0;
    for (int a = 0; a < 3; a++)
        p[a] = u[a] + field_random_in(r, -by, by) / QUADRATIC_LAB_CUBES;
}

static void flat(const double u[3], const bool even[3], field_random *r, double p[3]) {
    bent(u, even, r, p);
    p[2] *= 1e-3;
}

static void mirrored(const double u[3], const bool even[3], field_random *r, double p[3]) {
    bent(u, even, r, p);
    p[1] = 1.0 - p[1];
}

static void far_away(const double u[3], const bool even[3], field_random *r, double p[3]) {
    wild(u, even, r, p);
    for (int a = 0; a < 3; a++)
        p[a] += 300.0;
}

static void folded(const double u[3], const bool even[3], field_random *r, double p[3]) {
    const double by = is_corner(even) ? 0.0 : 0.2;
    for (int a = 0; a < 3; a++)
        p[a] = u[a] + field_random_in(r, -by, by) / QUADRATIC_LAB_CUBES;
}

/* Most cells of it are folded; quadratic_lab_make() unbends these until they hardly are. */
static void strong(const double u[3], const bool even[3], field_random *r, double p[3]) {
    const double by = is_corner(even) ? 0.0 : 0.3;
    for (int a = 0; a < 3; a++)
        p[a] = u[a] + field_random_in(r, -by, by) / QUADRATIC_LAB_CUBES;
}

static const struct {
    const char *name;
    shape make;
    bool straight, may_be_folded, left, unbent;
} shapes[] = {
    {.name = "regular", .make = regular, .straight = true},
    {.name = "jittered", .make = jittered, .straight = true},
    {.name = "bent", .make = bent},
    {.name = "wild", .make = wild, .may_be_folded = true},
    {.name = "a few", .make = a_few, .may_be_folded = true},
    {.name = "flat", .make = flat},
    {.name = "mirrored", .make = mirrored, .left = true},
    {.name = "far away", .make = far_away, .may_be_folded = true},
    {.name = "strong", .make = strong, .unbent = true},
    {.name = "folded", .make = folded, .may_be_folded = true},
};

int quadratic_lab_count(void) {
    return (int)(sizeof shapes / sizeof *shapes);
}

/* The middles of edges, whose directions are those of the lattice, or diagonals. */
static void straighten(quadratic_lab *s) {
    for (int k = 0; k < N; k++)
        for (int j = 0; j < N; j++)
            for (int i = 0; i < N; i++)
                for (int a = 0; a < 3; a++)
                    s->p[k][j][i][a] = 0.5f * (s->p[k - k % 2][j - j % 2][i - i % 2][a] +
                                               s->p[k + k % 2][j + j % 2][i + i % 2][a]);
}

/* Move the nodes of a cell's edges a tenth of the way to their middles. */
static void unbend_cell(quadratic_lab *s, int cell) {
    int at[QUADRATIC_NODES][3];
    const quadratic_tet t = quadratic_lab_cell(s, cell, at);
    for (int e = 0; e < QUADRATIC_EDGES; e++) {
        const int *edge = quadratic_edge(e), n = QUADRATIC_CORNERS + e;
        for (int a = 0; a < 3; a++) {
            const double middle = 0.5 * (t.p[edge[0]][a] + t.p[edge[1]][a]);
            s->p[at[n][2]][at[n][1]][at[n][0]][a] = (float)(0.9 * t.p[n][a] + 0.1 * middle);
        }
    }
}

/* Unbend cells until none is folded. */
static void unbend(quadratic_lab *s) {
    for (int folds = 1; folds > 0;) {
        folds = 0;
        for (int c = 0; c < QUADRATIC_LAB_CELLS; c++) {
            const quadratic_tet t = quadratic_lab_cell(s, c, NULL);
            if (quadratic_sense(&t) > 0)
                continue;
            folds++;
            unbend_cell(s, c);
        }
    }
}

void quadratic_lab_make(quadratic_lab *s, int index, uint64_t seed) {
    field_random r = {seed};
    s->name = shapes[index].name;
    s->straight = shapes[index].straight;
    s->may_be_folded = shapes[index].may_be_folded;
    s->left = shapes[index].left;
    s->iso = 0.1;
    double box[2][3] = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    for (int k = 0; k < N; k++)
        for (int j = 0; j < N; j++)
            for (int i = 0; i < N; i++) {
                const double u[3] = {(double)i / (N - 1), (double)j / (N - 1), (double)k / (N - 1)};
                const bool even[3] = {i % 2 == 0, j % 2 == 0, k % 2 == 0};
                double p[3];
                shapes[index].make(u, even, &r, p);
                for (int a = 0; a < 3; a++) {
                    s->p[k][j][i][a] = (float)p[a];
                    box[0][a] = fmin(box[0][a], p[a]);
                    box[1][a] = fmax(box[1][a], p[a]);
                }
                s->value[k][j][i] = (float)(sin(7.0 * u[1] + 5.0 * u[2]) * cos(6.0 * u[0]) +
                                            field_random_in(&r, -0.4, 0.4));
            }
    if (s->straight)
        straighten(s);
    if (shapes[index].unbent)
        unbend(s);
    s->size = 0.0;
    for (int a = 0; a < 3; a++)
        s->size = fmax(s->size, box[1][a] - box[0][a]);
}

quadratic_tet quadratic_lab_cell(const quadratic_lab *s, int cell, int nodes[QUADRATIC_NODES][3]) {
    static const int orders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1},
                                     {1, 0, 2}, {0, 2, 1}, {2, 1, 0}};
    const int cube = cell / 6, *order = orders[cell % 6], odd = cell % 6 > 2;
    int corner[QUADRATIC_CORNERS][3];
    for (int n = 0; n < QUADRATIC_CORNERS; n++) {
        const int c = odd && n > 1 ? 5 - n : n; /* so that all have one sense */
        for (int a = 0; a < 3; a++)
            corner[n][a] = a == 0   ? cube % QUADRATIC_LAB_CUBES
                           : a == 1 ? cube / QUADRATIC_LAB_CUBES % QUADRATIC_LAB_CUBES
                                    : cube / (QUADRATIC_LAB_CUBES * QUADRATIC_LAB_CUBES);
        for (int k = 0; k < c; k++)
            corner[n][order[k]]++;
    }
    quadratic_tet t;
    for (int n = 0; n < QUADRATIC_NODES; n++) {
        const int *edge = n < QUADRATIC_CORNERS ? NULL : quadratic_edge(n - QUADRATIC_CORNERS);
        int at[3];
        for (int a = 0; a < 3; a++) {
            at[a] = edge ? corner[edge[0]][a] + corner[edge[1]][a] : 2 * corner[n][a];
            if (nodes)
                nodes[n][a] = at[a];
        }
        for (int a = 0; a < 3; a++)
            t.p[n][a] = (double)s->p[at[2]][at[1]][at[0]][a];
        t.value[n] = (double)s->value[at[2]][at[1]][at[0]];
    }
    return t;
}

void quadratic_lab_at(const quadratic_tet *c, const double at[3], double p[3], double *value) {
    const unsigned straight = quadratic_straight_edges(c);
    double form[QUADRATIC_NODES];
    for (int a = 0; a < 3; a++) {
        double v[QUADRATIC_NODES];
        for (int n = 0; n < QUADRATIC_NODES; n++)
            v[n] = c->p[n][a];
        quadratic_form(v, straight, form);
        p[a] = quadratic_at(form, at);
    }
    quadratic_form(c->value, 0, form);
    *value = quadratic_at(form, at);
}

ray quadratic_lab_ray(const quadratic_lab *s, field_random *r, bool *special) {
    const bool node = field_random_below(r, 8) == 0, edge = field_random_below(r, 16) == 0;
    const quadratic_tet c =
        quadratic_lab_cell(s, (int)field_random_below(r, QUADRATIC_LAB_CELLS), NULL);
    ray out = {.t0 = -INFINITY, .t1 = INFINITY};
    double to[3], share[QUADRATIC_CORNERS], sum = 0.0, length = 0.0, value;
    for (int k = 0; k < QUADRATIC_CORNERS; k++)
        sum += share[k] = field_random_unit(r) + 0.01;
    for (int k = 0; k < QUADRATIC_CORNERS; k++)
        share[k] /= sum;
    quadratic_lab_at(&c, share + 1, to, &value);
    const int at = (int)field_random_below(r, QUADRATIC_NODES);
    for (int a = 0; a < 3; a++) {
        if (node)
            to[a] = c.p[at][a];
        out.d[a] = field_random_in(r, -1.0, 1.0);
        if (edge)
            out.d[a] = c.p[1][a] - c.p[0][a];
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
