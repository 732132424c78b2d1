#include "tests/support/hex_truth.h"

#include <math.h>
#include <string.h>

typedef long double real;

enum { ALONG_T = 3, FORMS = 4, DEEPEST = 40, GRAZING = 14 };

/* A part of the cube, and four forms at its corners: two planes, value, t. */
typedef struct part {
    real v[FORMS][8], lo[3], size;
    int level;
} part;

static real at(const real v[8], const real u[3]) {
    real sum = 0.0L;
    for (int c = 0; c < 8; c++) {
        real w = v[c];
        for (int a = 0; a < 3; a++)
            w *= c >> a & 1 ? u[a] : 1.0L - u[a];
        sum += w;
    }
    return sum;
}

static real slope(const real v[8], const real u[3], int a) {
    real up[3] = {u[0], u[1], u[2]}, down[3] = {u[0], u[1], u[2]};
    up[a] = 1.0L;
    down[a] = 0.0L;
    return at(v, up) - at(v, down);
}

static real det3(real m[3][3]) {
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
           m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

/* Cramer's rule: x such that m x = y. */
static bool solve(real m[3][3], const real y[3], real x[3]) {
    const real d = det3(m);
    if (d == 0.0L)
        return false;
    for (int k = 0; k < 3; k++) {
        real n[3][3];
        memcpy(n, m, sizeof n);
        for (int i = 0; i < 3; i++)
            n[i][k] = y[i];
        x[k] = det3(n) / d;
    }
    return true;
}

static bool one_sign(const real v[8], real margin) {
    bool above = true, below = true;
    for (int c = 0; c < 8; c++) {
        above = above && v[c] > margin;
        below = below && v[c] < -margin;
    }
    return above || below;
}

static void keep(hex_truth *out, const part *p, const real u[3]) {
    real whole[3], m[3][3];
    for (int a = 0; a < 3; a++) {
        whole[a] = p->lo[a] + p->size * u[a];
        if (whole[a] < -1e-9L || whole[a] > 1.0L + 1e-9L)
            return;
        if (whole[a] < 1e-9L || whole[a] > 1.0L - 1e-9L)
            out->doubtful = true;
    }
    const real t = at(p->v[ALONG_T], u);
    for (int i = 0; i < out->count; i++)
        if (fabsl(out->t[i] - t) <= 1e-13L * (1.0L + fabsl(t)))
            return;
    out->doubtful = out->doubtful || p->level > GRAZING;
    if (out->count == HEX_TRUTH_ROOTS) {
        out->doubtful = true;
        return;
    }
    /* d value / d t is a quotient of two determinants. */
    for (int k = 0; k < 3; k++)
        for (int a = 0; a < 3; a++)
            m[k][a] = slope(p->v[k], u, a);
    const real rise = det3(m);
    for (int a = 0; a < 3; a++)
        m[2][a] = slope(p->v[ALONG_T], u, a);
    int i = out->count++;
    for (; i > 0 && out->t[i - 1] > t; i--) {
        out->t[i] = out->t[i - 1];
        out->entering[i] = out->entering[i - 1];
    }
    out->t[i] = t;
    out->entering[i] = rise * det3(m) > 0.0L;
}

/* 0: no root; 1: one at most, and it was looked for; 2: cut on. */
static int look(const part *p, hex_truth *out) {
    real m[3][3], u[3] = {0.5L, 0.5L, 0.5L}, g[3][8], uneven = 0.0L;
    for (int k = 0; k < 3; k++) {
        real most = 0.0L;
        for (int c = 0; c < 8; c++)
            most = fmaxl(most, fabsl(p->v[k][c]));
        if (one_sign(p->v[k], 1e-17L * most))
            return 0;
        for (int a = 0; a < 3; a++)
            m[k][a] = slope(p->v[k], u, a);
    }
    for (int c = 0; c < 8; c++) {
        real x[3];
        if (!solve(m, (real[3]){p->v[0][c], p->v[1][c], p->v[2][c]}, x))
            return 2;
        for (int k = 0; k < 3; k++)
            g[k][c] = x[k];
    }
    for (int k = 0; k < 3; k++)
        if (one_sign(g[k], 1e-12L))
            return 0;
    for (int c = 0; c < 8; c++)
        for (int k = 0; k < 3; k++) {
            const real corner[3] = {c & 1, c >> 1 & 1, c >> 2 & 1};
            real off = 0.0L;
            for (int a = 0; a < 3; a++)
                off += fabsl(slope(g[k], corner, a) - (a == k ? 1.0L : 0.0L));
            uneven = fmaxl(uneven, off);
        }
    if (!(uneven < 0.5L))
        return 2;
    for (int n = 0; n < 60; n++) {
        real x[3], y[3], step = 0.0L;
        for (int k = 0; k < 3; k++) {
            y[k] = at(p->v[k], u);
            for (int a = 0; a < 3; a++)
                m[k][a] = slope(p->v[k], u, a);
        }
        if (!solve(m, y, x))
            return 2;
        for (int a = 0; a < 3; a++) {
            u[a] -= x[a];
            step = fmaxl(step, fabsl(x[a]));
        }
        if (!(step < 100.0L))
            return 1;
        if (step < 1e-17L)
            break;
    }
    for (int a = 0; a < 3; a++)
        if (u[a] < -1e-9L || u[a] > 1.0L + 1e-9L)
            return 1;
    keep(out, p, u);
    return 1;
}

void hex_truth_of(const double p[8][3], const double value[8], double isovalue, const double o[3],
                  const double d[3], hex_truth *out) {
    static part stack[8 * DEEPEST]; /* of one thread: threads that draw have small stacks */
    int count = 1, looked = 0;
    real n[2][3], size = 0.0L;
    int least = 0;
    *out = (hex_truth){0};
    for (int a = 1; a < 3; a++)
        least = fabs(d[a]) < fabs(d[least]) ? a : least;
    /* d x axis, and d x that. */
    for (int k = 0; k < 2; k++) {
        const real e[3] = {k ? n[0][0] : least == 0, k ? n[0][1] : least == 1,
                           k ? n[0][2] : least == 2};
        for (int a = 0; a < 3; a++)
            n[k][a] = (real)d[(a + 1) % 3] * e[(a + 2) % 3] - (real)d[(a + 2) % 3] * e[(a + 1) % 3];
    }
    for (int a = 0; a < 3; a++)
        size += (real)d[a] * (real)d[a];
    for (int c = 0; c < 8; c++) {
        stack[0].v[0][c] = stack[0].v[1][c] = stack[0].v[ALONG_T][c] = 0.0L;
        for (int a = 0; a < 3; a++) {
            const real away = (real)p[c][a] - (real)o[a];
            stack[0].v[0][c] += n[0][a] * away;
            stack[0].v[1][c] += n[1][a] * away;
            stack[0].v[ALONG_T][c] += (real)d[a] * away / size;
        }
        stack[0].v[2][c] = (real)value[c] - (real)isovalue;
    }
    stack[0].size = 1.0L;
    stack[0].lo[0] = stack[0].lo[1] = stack[0].lo[2] = 0.0L;
    stack[0].level = 0;
    while (count > 0) {
        const part s = stack[--count];
        if (look(&s, out) < 2)
            continue;
        if (s.level == DEEPEST - 1 || ++looked > 4000) {
            out->doubtful = true;
            return;
        }
        for (int c = 0; c < 8; c++) {
            part *child = &stack[count++];
            child->level = s.level + 1;
            child->size = 0.5L * s.size;
            for (int a = 0; a < 3; a++)
                child->lo[a] = s.lo[a] + (c >> a & 1 ? child->size : 0.0L);
            for (int k = 0; k < FORMS; k++)
                for (int i = 0; i < 8; i++) {
                    real u[3];
                    for (int a = 0; a < 3; a++)
                        u[a] = 0.5L * (real)((c >> a & 1) + (i >> a & 1));
                    child->v[k][i] = at(s.v[k], u);
                }
        }
    }
}

bool hex_truth_value(const double p[8][3], const double value[8], const double o[3],
                     const double d[3], double t, long double u[3], long double *out) {
    real v[4][8];
    for (int c = 0; c < 8; c++) {
        for (int a = 0; a < 3; a++)
            v[a][c] = (real)p[c][a] - ((real)o[a] + (real)t * (real)d[a]);
        v[3][c] = (real)value[c];
    }
    for (int n = 0; n < 60; n++) {
        real m[3][3], y[3], x[3], step = 0.0L;
        for (int k = 0; k < 3; k++) {
            y[k] = at(v[k], u);
            for (int a = 0; a < 3; a++)
                m[k][a] = slope(v[k], u, a);
        }
        if (!solve(m, y, x))
            return false;
        for (int a = 0; a < 3; a++) {
            u[a] -= x[a];
            step = fmaxl(step, fabsl(x[a]));
        }
        if (!(step < 10.0L))
            return false;
        if (step < 1e-15L) {
            *out = at(v[3], u);
            return true;
        }
    }
    return false;
}
