#include "prep/resample/tet_value.h"

#include <math.h>
#include <string.h>

#include "formats/base/exact.h"

void tet_value_init(tet_value *t, const float *const xyz[4], const float values[4]) {
    memcpy(t->value, values, sizeof t->value);
    for (int i = 0; i < 4; i++)
        for (int a = 0; a < 3; a++)
            t->at[i][a] = (double)xyz[i][a];
    t->sign = exact_orientation((const double(*)[3])t->at);
}

/* ---- points on faces and edges ---- */

/* Twice the signed area of the triangle o, p, q, projected along an axis. */
static double area_along(int axis, const double o[3], const double p[3], const double q[3]) {
    const double along[3] = {axis == 0, axis == 1, axis == 2};
    double a[3], b[3];
    for (int k = 0; k < 3; k++) {
        a[k] = p[k] - o[k];
        b[k] = q[k] - o[k];
    }
    const exact_estimate near = exact_near(along, a, b);
    return fabs(near.value) > EXACT_ENOUGH * near.bound ? near.value
                                                        : exact_edge(o, along, p, q).value;
}

/* The axis along which the face's projection is largest. */
static int axis_of_face(const tet_value *t, const int face[3]) {
    double most = -1;
    int best = 2;
    for (int a = 0; a < 3; a++) {
        const int axis = (a + 2) % 3;
        const double area = fabs(area_along(axis, t->at[face[0]], t->at[face[1]], t->at[face[2]]));
        if (area > most) {
            most = area;
            best = axis;
        }
    }
    return best;
}

static void weigh_face(const tet_value *t, const double point[3], const int face[3],
                       double weight[4]) {
    const int axis = axis_of_face(t, face);
    for (int n = 0; n < 3; n++)
        weight[face[n]] =
            fabs(area_along(axis, point, t->at[face[(n + 1) % 3]], t->at[face[(n + 2) % 3]]));
}

static void weigh_edge(const tet_value *t, const double point[3], const int edge[2],
                       double weight[4]) {
    int axis = 0;
    double most = -1;
    for (int a = 0; a < 3; a++) {
        const double length = fabs(t->at[edge[1]][a] - t->at[edge[0]][a]);
        if (length > most) {
            most = length;
            axis = a;
        }
    }
    weight[edge[0]] = fabs(t->at[edge[1]][axis] - point[axis]);
    weight[edge[1]] = fabs(t->at[edge[0]][axis] - point[axis]);
}

/* Compute the weights again for the vertices that have one, within their face or edge alone. */
static void weigh_part(const tet_value *t, const double point[3], double weight[4]) {
    int part[4], count = 0;
    for (int i = 0; i < 4; i++)
        if (weight[i] != 0)
            part[count++] = i;
    if (count == 3)
        weigh_face(t, point, part, weight);
    else if (count == 2)
        weigh_edge(t, point, part, weight);
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
    double weight[4];
    if (!exact_weights(t->at, t->sign, point, weight))
        return false;
    weigh_part(t, point, weight);
    *out = mean(t, weight);
    return true;
}
