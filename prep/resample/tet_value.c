#include "prep/resample/tet_value.h"

#include <math.h>

#include "formats/base/expansion.h"

/* A determinant by doubles is off by less than ERROR times the sum of its products' sizes
 * (Shewchuk 1997, o3derrboundA and more). Where it is above ENOUGH times that sum its size is right
 * to 2^-26, too; else it is computed without rounding. */
static const double ERROR = 0x1p-50, ENOUGH = 0x1p-24;

typedef struct vertices {
    const double (*at)[3];
    const double *point;
    double from[4][3]; /* the point to the vertex, rounded */
} vertices;

static bool is_good(double det, double size) {
    return det > ENOUGH * size || det < -ENOUGH * size;
}

/* ---- determinants of vertices as seen from the point ---- */

static void exact_difference(const vertices *v, int i, int axis, expansion *e) {
    expansion_difference(e, v->at[i][axis], v->point[axis]);
}

/* Of vertices i and k in the plane of axes a and b. */
static void exact2(const vertices *v, int i, int k, int a, int b, expansion *e) {
    expansion p, q, other;
    exact_difference(v, i, a, &p);
    exact_difference(v, k, b, &q);
    expansion_multiply(e, &p, &q);
    exact_difference(v, k, a, &p);
    exact_difference(v, i, b, &q);
    expansion_multiply(&other, &p, &q);
    expansion_subtract(e, &other);
}

static double det2(const vertices *v, int i, int k, int a, int b) {
    const double plus = v->from[i][a] * v->from[k][b], minus = v->from[k][a] * v->from[i][b];
    const double det = plus - minus, size = fabs(plus) + fabs(minus);
    if (is_good(det, size))
        return det;
    expansion e;
    exact2(v, i, k, a, b, &e);
    return expansion_value(&e);
}

static double exact3(const vertices *v, int i, int j, int k) {
    expansion sum = {0}, minor, z, product;
    const int of[3][3] = {{i, j, k}, {j, k, i}, {k, i, j}};
    for (int n = 0; n < 3; n++) {
        exact2(v, of[n][1], of[n][2], 0, 1, &minor);
        exact_difference(v, of[n][0], 2, &z);
        expansion_multiply(&product, &minor, &z);
        expansion_add(&sum, &product);
    }
    return expansion_value(&sum);
}

/* Of vertices i, j, k; `sign` is the side that is of interest: on the other one, only the sign of
 * what is returned is right. */
static double det3(const vertices *v, int i, int j, int k, double sign) {
    const double *a = v->from[i], *b = v->from[j], *c = v->from[k];
    const double bc[2] = {b[0] * c[1], c[0] * b[1]}, ca[2] = {c[0] * a[1], a[0] * c[1]},
                 ab[2] = {a[0] * b[1], b[0] * a[1]};
    const double det = a[2] * (bc[0] - bc[1]) + b[2] * (ca[0] - ca[1]) + c[2] * (ab[0] - ab[1]);
    const double size = fabs(a[2]) * (fabs(bc[0]) + fabs(bc[1])) +
                        fabs(b[2]) * (fabs(ca[0]) + fabs(ca[1])) +
                        fabs(c[2]) * (fabs(ab[0]) + fabs(ab[1]));
    if (sign * det < -ERROR * size || is_good(det, size))
        return det;
    return exact3(v, i, j, k);
}

static void look_from(vertices *v, const double (*at)[3], int count, const double point[3]) {
    v->at = at;
    v->point = point;
    for (int i = 0; i < count; i++)
        for (int a = 0; a < 3; a++)
            v->from[i][a] = at[i][a] - point[a];
}

void tet_value_init(tet_value *t, const float *const xyz[4], const float values[4]) {
    for (int i = 0; i < 4; i++) {
        for (int a = 0; a < 3; a++)
            t->at[i][a] = (double)xyz[i][a];
        t->value[i] = values[i];
    }
    /* As seen from vertex 0. */
    vertices v;
    look_from(&v, (const double(*)[3])t->at + 1, 3, t->at[0]);
    const double volume = det3(&v, 0, 1, 2, 0);
    t->sign = (volume > 0) - (volume < 0);
}

/* ---- points of no volume ---- */

/* The axes of the plane onto which the face i, j, k is projected: its area is largest there. */
static void project(const tet_value *t, const int face[3], int axes[2]) {
    vertices v;
    const double other[2][3] = {{t->at[face[1]][0], t->at[face[1]][1], t->at[face[1]][2]},
                                {t->at[face[2]][0], t->at[face[2]][1], t->at[face[2]][2]}};
    double most = -1;
    look_from(&v, other, 2, t->at[face[0]]);
    for (int a = 0; a < 3; a++) {
        const double area = fabs(det2(&v, 0, 1, a, (a + 1) % 3));
        if (area > most) {
            most = area;
            axes[0] = a;
            axes[1] = (a + 1) % 3;
        }
    }
}

static void weigh_face(const tet_value *t, const vertices *v, const int face[3], double weight[4]) {
    int axes[2] = {0, 1};
    project(t, face, axes);
    for (int n = 0; n < 3; n++)
        weight[face[n]] = fabs(det2(v, face[(n + 1) % 3], face[(n + 2) % 3], axes[0], axes[1]));
}

static void weigh_edge(const tet_value *t, const vertices *v, const int edge[2], double weight[4]) {
    int axis = 0;
    double most = -1;
    for (int a = 0; a < 3; a++) {
        const double length = fabs(t->at[edge[1]][a] - t->at[edge[0]][a]);
        if (length > most) {
            most = length;
            axis = a;
        }
    }
    weight[edge[0]] = fabs(v->from[edge[1]][axis]);
    weight[edge[1]] = fabs(v->from[edge[0]][axis]);
}

/* The weights of those vertices that have a part, as their face or edge alone says. */
static void weigh_part(const tet_value *t, const vertices *v, double weight[4]) {
    int part[4], count = 0;
    for (int i = 0; i < 4; i++)
        if (weight[i] != 0)
            part[count++] = i;
    if (count == 3)
        weigh_face(t, v, part, weight);
    else if (count == 2)
        weigh_edge(t, v, part, weight);
}

/* ---- values ---- */

static float mean(const tet_value *t, const double weight[4]) {
    double sum = 0, all = 0;
    float lo = INFINITY, hi = -INFINITY;
    for (int i = 0; i < 4; i++) {
        if (weight[i] == 0)
            continue;
        const float value = t->value[i];
        if (!isfinite(value))
            return NAN;
        lo = value < lo ? value : lo;
        hi = value > hi ? value : hi;
        sum += weight[i] * (double)value;
        all += weight[i];
    }
    const float value = (float)(sum / all);
    return value < lo ? lo : value > hi ? hi : value;
}

bool tet_value_at(const tet_value *t, const double point[3], float *out) {
    static const int FACES[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    double weight[4];
    int zeros = 0;
    vertices v;
    look_from(&v, t->at, 4, point);
    for (int i = 0; i < 4; i++) {
        weight[i] = t->sign * det3(&v, FACES[i][0], FACES[i][1], FACES[i][2], t->sign);
        if (weight[i] < 0)
            return false;
        zeros += weight[i] == 0;
    }
    if (zeros)
        weigh_part(t, &v, weight);
    *out = mean(t, weight);
    return true;
}
