#include "formats/base/quadratic_tet.h"

#include <math.h>
#include <string.h>

#include "formats/base/vec3.h"

static const int edges[QUADRATIC_EDGES][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};

const int *quadratic_edge(int edge) {
    return edges[edge];
}

const int *quadratic_face(int face) {
    static const int nodes[QUADRATIC_FACES][6] = {
        {1, 2, 3, 5, 9, 8}, {0, 3, 2, 7, 9, 6}, {0, 1, 3, 4, 8, 7}, {0, 2, 1, 6, 5, 4}};
    return nodes[face];
}

const int *quadratic_part(int part) {
    static const int nodes[QUADRATIC_PARTS][QUADRATIC_CORNERS] = {
        {0, 4, 6, 7}, {4, 1, 5, 8}, {6, 5, 2, 9}, {7, 8, 9, 3},
        {6, 8, 4, 5}, {6, 8, 5, 9}, {6, 8, 9, 7}, {6, 8, 7, 4}};
    return nodes[part];
}

bool quadratic_is_straight(const double end[3], const double other[3], const double middle[3]) {
    for (int a = 0; a < 3; a++) {
        const double size = real_max(real_max(fabs(end[a]), fabs(other[a])), fabs(middle[a]));
        if (!(fabs(2.0 * middle[a] - (end[a] + other[a])) <= 0x1p-21 * size))
            return false;
    }
    return true;
}

unsigned quadratic_straight_edges(const quadratic_tet *c) {
    unsigned straight = 0;
    for (int e = 0; e < QUADRATIC_EDGES; e++)
        if (quadratic_is_straight(c->p[edges[e][0]], c->p[edges[e][1]],
                                  c->p[QUADRATIC_CORNERS + e]))
            straight |= 1u << e;
    return straight;
}

void quadratic_form(const double v[QUADRATIC_NODES], unsigned straight,
                    double form[QUADRATIC_NODES]) {
    for (int c = 0; c < QUADRATIC_CORNERS; c++)
        form[c] = v[c];
    for (int e = 0; e < QUADRATIC_EDGES; e++) {
        const double end = v[edges[e][0]], other = v[edges[e][1]];
        form[QUADRATIC_CORNERS + e] = straight >> e & 1
                                          ? 0.5 * (end + other)
                                          : quadratic_control(end, other, v[QUADRATIC_CORNERS + e]);
    }
}

static void shares_of(const double at[3], double share[QUADRATIC_CORNERS]) {
    share[0] = 1.0 - at[0] - at[1] - at[2];
    for (int k = 0; k < 3; k++)
        share[k + 1] = at[k];
}

/* The form with one of its two factors left open, at a corner (de Casteljau's step). */
static double half_at(const double form[QUADRATIC_NODES], const double share[QUADRATIC_CORNERS],
                      int corner) {
    double sum = 0.0;
    for (int c = 0; c < QUADRATIC_CORNERS; c++)
        sum += share[c] * form[quadratic_coefficient(corner, c)];
    return sum;
}

double quadratic_at(const double form[QUADRATIC_NODES], const double at[3]) {
    double share[QUADRATIC_CORNERS], sum = 0.0;
    shares_of(at, share);
    for (int c = 0; c < QUADRATIC_CORNERS; c++)
        sum += share[c] * half_at(form, share, c);
    return sum;
}

void quadratic_slope(const double form[QUADRATIC_NODES], const double at[3], double slope[3]) {
    double share[QUADRATIC_CORNERS];
    shares_of(at, share);
    const double base = half_at(form, share, 0);
    for (int k = 0; k < 3; k++)
        slope[k] = 2.0 * (half_at(form, share, k + 1) - base);
}

void quadratic_twist(const double form[QUADRATIC_NODES], double twist[3], double square[3]) {
    for (int a = 0; a < 3; a++) {
        const int b = 1 + (a + 1) % 3, c = 1 + (a + 2) % 3;
        twist[a] = 2.0 * ((form[quadratic_coefficient(b, c)] - form[quadratic_coefficient(0, b)]) -
                          (form[quadratic_coefficient(0, c)] - form[0]));
        square[a] = (form[a + 1] - form[quadratic_coefficient(0, a + 1)]) -
                    (form[quadratic_coefficient(0, a + 1)] - form[0]);
    }
}

void quadratic_range(const double value[QUADRATIC_NODES], double range[2]) {
    double form[QUADRATIC_NODES];
    quadratic_form(value, 0, form);
    range[0] = range[1] = form[0];
    for (int i = 1; i < QUADRATIC_NODES; i++) {
        range[0] = real_min(range[0], form[i]);
        range[1] = real_max(range[1], form[i]);
    }
}

/* ---- Sense ---- */

/* The map's coefficients: ten points. */
typedef struct control_net {
    double p[QUADRATIC_NODES][3];
} control_net;

/* The Jacobian's columns are linear, and its determinant is cubic in the shares. A Bernstein
 * coefficient is the mean of the determinants of columns at three corners, in all orders. */
static int sign_of(const control_net *n) {
    double column[3][QUADRATIC_CORNERS][3], sum[64] = {0.0}, most[3] = {0.0};
    int count[64] = {0};
    for (int k = 0; k < 3; k++)
        for (int c = 0; c < QUADRATIC_CORNERS; c++) {
            vec3_sub(n->p[quadratic_coefficient(c, k + 1)], n->p[quadratic_coefficient(c, 0)],
                     column[k][c]);
            most[k] = real_max(most[k], vec3_size(column[k][c]));
        }
    for (int x = 0; x < QUADRATIC_CORNERS; x++)
        for (int y = 0; y < QUADRATIC_CORNERS; y++)
            for (int z = 0; z < QUADRATIC_CORNERS; z++) {
                /* How often each corner is among the three says which coefficient it is. */
                const int at = (1 << 2 * x) / 4 + (1 << 2 * y) / 4 + (1 << 2 * z) / 4;
                sum[at] += vec3_det(column[0][x], column[1][y], column[2][z]);
                count[at]++;
            }
    const double rounding = 0x1p-48 * most[0] * most[1] * most[2];
    double least = INFINITY, greatest = -INFINITY;
    for (int i = 0; i < 64; i++) {
        if (count[i] == 0)
            continue;
        least = real_min(least, sum[i] / count[i]);
        greatest = real_max(greatest, sum[i] / count[i]);
    }
    if (least >= -rounding && greatest > rounding)
        return 1;
    if (greatest <= rounding && least < -rounding)
        return -1;
    return 0;
}

/* The part of a tet whose corner `from` is moved to the middle of its edge to `to`. */
static void halve(control_net *n, int from, int to) {
    double middle[3];
    for (int a = 0; a < 3; a++) {
        const double end = n->p[from][a], other = n->p[to][a],
                     between = n->p[quadratic_coefficient(from, to)][a];
        middle[a] = 0.25 * (end + other) + 0.5 * between;
    }
    for (int c = 0; c < QUADRATIC_CORNERS; c++)
        for (int a = 0; a < 3 && c != from; a++) {
            double *mine = &n->p[quadratic_coefficient(from, c)][a];
            *mine = 0.5 * (*mine + n->p[quadratic_coefficient(to, c)][a]);
        }
    memcpy(n->p[from], middle, sizeof middle);
}

/* 1, -1, 0 as quadratic_sense(). left: how many more parts may be looked at. */
static int sense_of(const control_net *n, int depth, int *left) {
    const int sign = sign_of(n);
    if (sign || depth == 0 || *left <= 0)
        return sign;
    const int *edge = edges[depth % QUADRATIC_EDGES];
    int sense = 0;
    *left -= 2;
    for (int side = 0; side < 2; side++) {
        control_net half = *n;
        halve(&half, edge[side], edge[!side]);
        const int own = sense_of(&half, depth - 1, left);
        if (own == 0 || (side == 1 && own != sense))
            return 0;
        sense = own;
    }
    return sense;
}

int quadratic_sense(const quadratic_tet *c) {
    enum { DEPTH = 18, PARTS = 1024 };
    const unsigned straight = quadratic_straight_edges(c);
    control_net n;
    for (int a = 0; a < 3; a++) {
        double v[QUADRATIC_NODES], form[QUADRATIC_NODES];
        for (int i = 0; i < QUADRATIC_NODES; i++)
            v[i] = c->p[i][a];
        quadratic_form(v, straight, form);
        for (int i = 0; i < QUADRATIC_NODES; i++)
            n.p[i][a] = form[i];
    }
    int left = PARTS;
    return sense_of(&n, DEPTH, &left);
}
