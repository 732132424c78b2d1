#include "tests/support/quadratic_truth.h"

#include <math.h>
#include <string.h>

typedef long double real;

enum { ALONG_T = 3, FORMS = 4, DEEPEST = 40, GRAZING = 14, TERMS = 10 };

/* c + sum g[a] x[a] + sum h[a][b] x[a] x[b], h symmetric. */
typedef struct polynomial {
    real c, g[3], h[3][3];
} polynomial;

/* Of node values, by the shape functions of the ten nodes. */
static polynomial polynomial_of(const real v[TERMS]) {
    static const int ends[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};
    /* Each share is constant + slope . x. */
    static const real constant[4] = {1.0L, 0.0L, 0.0L, 0.0L};
    static const real slope[4][3] = {
        {-1.0L, -1.0L, -1.0L}, {1.0L, 0.0L, 0.0L}, {0.0L, 1.0L, 0.0L}, {0.0L, 0.0L, 1.0L}};
    polynomial p = {0};
    for (int n = 0; n < TERMS; n++) {
        /* s (2 s - 1) at a corner, 4 s t on an edge. */
        const int i = n < 4 ? n : ends[n - 4][0], j = n < 4 ? n : ends[n - 4][1];
        const real scale = n < 4 ? 2.0L : 4.0L, less = n < 4 ? 1.0L : 0.0L;
        p.c += v[n] * (scale * constant[i] * constant[j] - less * constant[i]);
        for (int a = 0; a < 3; a++) {
            p.g[a] += v[n] * (scale * (constant[i] * slope[j][a] + constant[j] * slope[i][a]) -
                              less * slope[i][a]);
            for (int b = 0; b < 3; b++)
                p.h[a][b] +=
                    v[n] * scale * 0.5L * (slope[i][a] * slope[j][b] + slope[j][a] * slope[i][b]);
        }
    }
    return p;
}

static real at(const polynomial *p, const real u[3]) {
    real sum = p->c;
    for (int a = 0; a < 3; a++) {
        sum += p->g[a] * u[a];
        for (int b = 0; b < 3; b++)
            sum += p->h[a][b] * u[a] * u[b];
    }
    return sum;
}

static void slope_at(const polynomial *p, const real u[3], real slope[3]) {
    for (int a = 0; a < 3; a++) {
        slope[a] = p->g[a];
        for (int b = 0; b < 3; b++)
            slope[a] += 2.0L * p->h[a][b] * u[b];
    }
}

/* The greatest size of what bends, at a distance of r at most on each axis. */
static real bent(const polynomial *p, real r) {
    real sum = 0.0L;
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++)
            sum += fabsl(p->h[a][b]);
    return sum * r * r;
}

static real det3(real m[3][3]) {
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
           m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

/* Gauss with pivots: x such that m x = y. */
static bool solve(real m[3][3], const real y[3], real x[3]) {
    real w[3][4];
    for (int i = 0; i < 3; i++) {
        memcpy(w[i], m[i], sizeof m[i]);
        w[i][3] = y[i];
    }
    for (int k = 0; k < 3; k++) {
        int best = k;
        for (int i = k + 1; i < 3; i++)
            best = fabsl(w[i][k]) > fabsl(w[best][k]) ? i : best;
        if (w[best][k] == 0.0L)
            return false;
        for (int n = 0; n < 4; n++) {
            const real swap = w[k][n];
            w[k][n] = w[best][n];
            w[best][n] = swap;
        }
        for (int i = 0; i < 3; i++) {
            const real share = w[i][k] / w[k][k];
            for (int n = k; n < 4 && i != k; n++)
                w[i][n] -= share * w[k][n];
        }
    }
    for (int k = 0; k < 3; k++)
        x[k] = w[k][3] / w[k][k];
    return true;
}

typedef struct part {
    real middle[3], half;
    int level;
} part;

typedef struct search {
    polynomial form[FORMS]; /* two planes, value, t */
    quadratic_truth *out;
} search;

static void keep(search *s, const real u[3], int level) {
    quadratic_truth *out = s->out;
    const real shares[4] = {1.0L - u[0] - u[1] - u[2], u[0], u[1], u[2]};
    for (int k = 0; k < 4; k++) {
        if (shares[k] < -1e-9L)
            return;
        if (shares[k] < 1e-9L)
            out->doubtful = true;
    }
    const real t = at(&s->form[ALONG_T], u);
    for (int i = 0; i < out->count; i++)
        if (fabsl(out->t[i] - t) <= 1e-13L * (1.0L + fabsl(t)))
            return;
    out->doubtful = out->doubtful || level > GRAZING || out->count == QUADRATIC_TRUTH_ROOTS;
    if (out->count == QUADRATIC_TRUTH_ROOTS)
        return;
    /* d value / d t is a quotient of two determinants. */
    real m[3][3];
    for (int k = 0; k < 3; k++)
        slope_at(&s->form[k], u, m[k]);
    const real rise = det3(m);
    slope_at(&s->form[ALONG_T], u, m[2]);
    int i = out->count++;
    for (; i > 0 && out->t[i - 1] > t; i--) {
        out->t[i] = out->t[i - 1];
        out->entering[i] = out->entering[i - 1];
    }
    out->t[i] = t;
    out->entering[i] = rise * det3(m) > 0.0L;
}

/* Newton's method. False: it goes nowhere. */
static bool newton(const polynomial form[3], const real aim[3], real u[3]) {
    for (int n = 0; n < 60; n++) {
        real m[3][3], y[3], x[3], step = 0.0L;
        for (int k = 0; k < 3; k++) {
            y[k] = at(&form[k], u) - aim[k];
            slope_at(&form[k], u, m[k]);
        }
        if (!solve(m, y, x))
            return false;
        for (int a = 0; a < 3; a++) {
            u[a] -= x[a];
            step = fmaxl(step, fabsl(x[a]));
        }
        if (!(step < 100.0L))
            return false;
        if (step < 1e-17L)
            return true;
    }
    return true;
}

/* False: nothing more is to be done here; true: cut on. */
static bool look(search *s, const part *p) {
    real m[3][3], y[3], x[3], most = 0.0L;
    if (p->middle[0] + p->middle[1] + p->middle[2] - 3.0L * p->half > 1.0L + 1e-6L)
        return false;
    for (int k = 0; k < 3; k++) {
        y[k] = at(&s->form[k], p->middle);
        slope_at(&s->form[k], p->middle, m[k]);
        const real reach = (fabsl(m[k][0]) + fabsl(m[k][1]) + fabsl(m[k][2])) * p->half;
        if (fabsl(y[k]) > (reach + bent(&s->form[k], p->half)) * (1.0L + 1e-12L))
            return false;
    }
    if (!solve(m, y, x))
        return true;
    real bends[3] = {0.0L, 0.0L, 0.0L};
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) {
            real by[3];
            if (!solve(m, (real[3]){s->form[0].h[a][b], s->form[1].h[a][b], s->form[2].h[a][b]},
                       by))
                return true;
            for (int k = 0; k < 3; k++)
                bends[k] += fabsl(by[k]);
        }
    for (int k = 0; k < 3; k++) {
        if (fabsl(x[k]) > (p->half + bends[k] * p->half * p->half) * (1.0L + 1e-9L))
            return false;
        most = fmaxl(most, bends[k]);
    }
    if (!(2.0L * most * p->half < 0.5L))
        return true;
    real u[3];
    for (int k = 0; k < 3; k++)
        u[k] = p->middle[k] - x[k];
    if (!newton(s->form, (const real[3]){0.0L, 0.0L, 0.0L}, u))
        return false;
    for (int k = 0; k < 3; k++)
        if (fabsl(u[k] - p->middle[k]) > p->half * (1.0L + 1e-9L))
            return false;
    keep(s, u, p->level);
    return false;
}

/* The polynomials of position less the origin, and of the value. */
static void forms_of(const quadratic_tet *c, unsigned straight, const double o[3],
                     polynomial place[3], polynomial *value) {
    static const int ends[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};
    real v[TERMS];
    for (int a = 0; a < 3; a++) {
        for (int n = 0; n < TERMS; n++)
            v[n] = (real)c->p[n][a] - (real)o[a];
        for (int e = 0; e < 6; e++)
            if (straight >> e & 1)
                v[4 + e] = 0.5L * (v[ends[e][0]] + v[ends[e][1]]);
        place[a] = polynomial_of(v);
    }
    for (int n = 0; n < TERMS; n++)
        v[n] = (real)c->value[n];
    *value = polynomial_of(v);
}

/* out += scale p. */
static void add(polynomial *out, const polynomial *p, real scale) {
    out->c += scale * p->c;
    for (int a = 0; a < 3; a++) {
        out->g[a] += scale * p->g[a];
        for (int b = 0; b < 3; b++)
            out->h[a][b] += scale * p->h[a][b];
    }
}

void quadratic_truth_of(const quadratic_tet *c, unsigned straight, double isovalue,
                        const double o[3], const double d[3], quadratic_truth *out) {
    static part stack[8 * DEEPEST]; /* of one thread: threads that draw have small stacks */
    polynomial place[3];
    search s = {.out = out};
    int count = 1, looked = 0, least = 0;
    real n[2][3], size = 0.0L;
    *out = (quadratic_truth){0};
    forms_of(c, straight, o, place, &s.form[2]);
    s.form[2].c -= (real)isovalue;
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
    for (int a = 0; a < 3; a++) {
        add(&s.form[0], &place[a], n[0][a]);
        add(&s.form[1], &place[a], n[1][a]);
        add(&s.form[ALONG_T], &place[a], (real)d[a] / size);
    }
    stack[0] = (part){{0.5L, 0.5L, 0.5L}, 0.5L, 0};
    while (count > 0) {
        const part p = stack[--count];
        if (!look(&s, &p))
            continue;
        if (p.level == DEEPEST - 1 || ++looked > 4000) {
            out->doubtful = true;
            return;
        }
        for (int k = 0; k < 8; k++) {
            part *child = &stack[count++];
            child->level = p.level + 1;
            child->half = 0.5L * p.half;
            for (int a = 0; a < 3; a++)
                child->middle[a] = p.middle[a] + (k >> a & 1 ? child->half : -child->half);
        }
    }
}

bool quadratic_truth_value(const quadratic_tet *c, unsigned straight, const double o[3],
                           const double d[3], double t, long double u[3], long double *out) {
    polynomial place[3], value;
    real aim[3];
    forms_of(c, straight, o, place, &value);
    for (int a = 0; a < 3; a++)
        aim[a] = (real)t * (real)d[a];
    if (!newton(place, aim, u))
        return false;
    for (int a = 0; a < 3; a++)
        if (fabsl(at(&place[a], u) - aim[a]) > 1e-14L * (1.0L + fabsl(aim[a])))
            return false;
    *out = at(&value, u);
    return true;
}
