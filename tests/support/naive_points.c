#include "tests/support/naive_points.h"

#include <math.h>
#include <string.h>

/* Two answers of doubles that lie no farther apart than this share of a cell may both be right. */
static const long double DOUBT = 1e-9L;

static long double det(long double m[3][3]) {
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
           m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

/* x of m x = b, by Cramer's rule. */
static void solve(long double m[3][3], const long double b[3], long double x[3]) {
    const long double whole = det(m);
    for (int a = 0; a < 3; a++) {
        long double with[3][3];
        memcpy(with, m, sizeof with);
        for (int i = 0; i < 3; i++)
            with[i][a] = b[i];
        x[a] = det(with) / whole;
    }
}

/* ---- Grids ---- */

static long double axis_at(const naive_leaf *leaf, int a, long i) {
    return leaf->axis[a] ? (long double)leaf->axis[a][i] : i;
}

static long double node_at(const naive_leaf *leaf, int level, int a, long i) {
    const long last = leaf->dims[a] - 1, node = i << level;
    const long double end = axis_at(leaf, a, last);
    if (node <= last)
        return axis_at(leaf, a, node);
    return end + (node - last) * (end - axis_at(leaf, a, last - 1));
}

static bool find_cell(const naive_leaf *leaf, int level, int a, long double x, long *cell,
                      long double *at) {
    const long cells = leaf->level[level].cells[a];
    long double lo = node_at(leaf, level, a, 0);
    for (long i = 0; i < cells; i++) {
        const long double hi = node_at(leaf, level, a, i + 1);
        *cell = i;
        *at = (x - lo) / (hi - lo);
        if (x < hi || i + 1 == cells)
            return true;
        lo = hi;
    }
    return false;
}

static long treelet_of(const naive_leaf *leaf, int level, const long cell[3]) {
    for (long t = 0; t < leaf->treelet_count; t++) {
        bool here = leaf->treelets[t].level == level;
        for (int a = 0; a < 3; a++)
            here = here && leaf->treelets[t].at[a] == cell[a] >> leaf->cells_log2;
        if (here)
            return t;
    }
    return -1;
}

static float corner_of(const naive_leaf *leaf, int level, const long cell[3], int corner) {
    return naive_leaf_sample(leaf, level, cell[0] + (corner & 1), cell[1] + (corner >> 1 & 1),
                             cell[2] + (corner >> 2 & 1));
}

/* of: 8 corners, weighed. */
static void interpolate(const naive_leaf *leaf, int level, const long cell[3],
                        const long double at[3], naive_point *out) {
    int near = 0, second = 0;
    for (int a = 0; a < 3; a++) {
        near |= (at[a] >= 0.5L) << a;
        const bool both = fabsl(at[a] - 0.5L) < DOUBT;
        second |= ((at[a] >= 0.5L) != both) << a;
    }
    for (int corner = 0; corner < 8; corner++) {
        const long double f = corner_of(leaf, level, cell, corner);
        long double weight = 1.0L;
        for (int a = 0; a < 3; a++)
            weight *= corner >> a & 1 ? at[a] : 1.0L - at[a];
        out->linear += isfinite(f) ? weight * f : (long double)NAN;
        if (isfinite(f))
            out->magnitude = fmaxl(out->magnitude, fabsl(f));
    }
    out->nearest = corner_of(leaf, level, cell, near);
    out->second = corner_of(leaf, level, cell, second);
}

naive_point naive_points_grid(const naive_leaf *leaf, int level, const double point[3]) {
    naive_point out = {.inside = true, .treelet = -1};
    long double m[3][3], b[3], x[3], at[3];
    long cell[3];
    for (int i = 0; i < 3; i++) {
        for (int a = 0; a < 3; a++)
            m[i][a] = (long double)leaf->to_world[i][a];
        b[i] = (long double)point[i] - (long double)leaf->to_world[i][3];
    }
    solve(m, b, x);
    for (int a = 0; a < 3; a++) {
        const long last = leaf->dims[a] - 1;
        const long double lo = axis_at(leaf, a, 0), hi = axis_at(leaf, a, last);
        const long double near = fminl(fabsl(x[a] - lo), fabsl(x[a] - hi)) / (hi - lo);
        out.doubtful = out.doubtful || near < DOUBT;
        out.inside = out.inside && x[a] >= lo && x[a] <= hi &&
                     find_cell(leaf, level, a, x[a], &cell[a], &at[a]);
    }
    if (!out.inside)
        return out;
    out.treelet = treelet_of(leaf, level, cell);
    interpolate(leaf, level, cell, at, &out);
    if (!isfinite(out.nearest))
        out.nearest = (long double)NAN;
    return out;
}

/* ---- Meshes ---- */

/* The share of each vertex; false: a flat tet. */
static bool weigh(const naive_part *part, long place, const long tet[4], const double point[3],
                  long double weight[4]) {
    const float(*p)[3] = (const float(*)[3])part->positions + place * part->vertices;
    long double m[3][3], b[3], x[3];
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++)
            m[i][k] = (long double)p[tet[k + 1]][i] - p[tet[0]][i];
        b[i] = (long double)point[i] - p[tet[0]][i];
    }
    if (det(m) == 0.0L)
        return false;
    solve(m, b, x);
    weight[0] = 1.0L - x[0] - x[1] - x[2];
    for (int k = 0; k < 3; k++)
        weight[k + 1] = x[k];
    return true;
}

static long double distance_to(const naive_part *part, long place, long vertex,
                               const double point[3]) {
    const float *p = part->positions[place * part->vertices + vertex];
    long double sum = 0.0L;
    for (int a = 0; a < 3; a++)
        sum += ((long double)p[a] - point[a]) * ((long double)p[a] - point[a]);
    return sum;
}

static void fill(const naive_part *part, long set, long place, const long tet[4],
                 const double point[3], const long double weight[4], naive_point *out) {
    const float *f = part->values + set * part->vertices;
    long double nearest = INFINITY, next = INFINITY;
    out->linear = out->magnitude = 0.0L;
    for (int k = 0; k < 4; k++) {
        const long double away = distance_to(part, place, tet[k], point);
        out->linear +=
            weight[k] * (isfinite(f[tet[k]]) ? (long double)f[tet[k]] : (long double)NAN);
        if (isfinite(f[tet[k]]))
            out->magnitude = fmaxl(out->magnitude, fabsl((long double)f[tet[k]]));
        if (away < nearest) {
            next = nearest;
            nearest = away;
            out->nearest = f[tet[k]];
        } else {
            next = fminl(next, away);
        }
    }
    out->doubtful = out->doubtful || next - nearest < DOUBT * next;
    out->second = out->nearest;
    if (!isfinite(out->nearest))
        out->nearest = out->second = (long double)NAN;
}

naive_point naive_points_mesh(const naive_mesh *mesh, long set, const double point[3]) {
    naive_point out = {.treelet = -1};
    const long place = mesh->places > 1 ? set % mesh->steps : 0;
    for (long t = 0; t < mesh->treelets && !out.inside; t++) {
        const naive_part *part = &mesh->part[t];
        for (long i = 0; i < part->tets && !out.inside; i++) {
            long double weight[4], least = INFINITY;
            if (!weigh(part, place, part->tet[i], point, weight))
                continue;
            for (int k = 0; k < 4; k++)
                least = fminl(least, weight[k]);
            out.doubtful = out.doubtful || fabsl(least) < DOUBT;
            out.inside = least >= 0.0L;
            if (!out.inside)
                continue;
            out.treelet = t;
            fill(part, set, place, part->tet[i], point, weight, &out);
        }
    }
    return out;
}
