#include "tests/support/ref_pieces.h"

#include <math.h>
#include <stdlib.h>

typedef long double real;

enum { VISITS_MAX = 8192 };

long double ref_piece_at(const long double k[4], long double x) {
    return k[0] + x * (k[1] + x * (k[2] + x * k[3]));
}

int ref_cubic_turns(const long double k[4], long double length, long double x[2]) {
    const real a = 3 * k[3], b = k[2], c = k[1], square = b * b - a * c;
    int count = 0;
    if (!(square >= 0))
        return 0;
    const real q = -(b + copysignl(sqrtl(square), b));
    /* inf or NaN where there is none: refused below */
    const real one = q / a, other = c / q, in_order[2] = {fminl(one, other), fmaxl(one, other)};
    for (int i = 0; i < 2; i++)
        if (in_order[i] > 0 && in_order[i] < length && (count == 0 || in_order[i] > x[0]))
            x[count++] = in_order[i];
    return count;
}

/* ---- Grids ---- */

/* out = a + (b - a) (p + m x), polynomials in x; a and b have `degree`, out one more. */
static void mix(const real *a, const real *b, int degree, real p, real m, real *out) {
    real last = 0;
    for (int i = 0; i <= degree; i++) {
        const real step = b[i] - a[i];
        out[i] = a[i] + step * p + last * m;
        last = step;
    }
    out[degree + 1] = last * m;
}

/* The trilinear form of the samples along p + m x, of the unit cube. */
static void along(const float f[8], const real p[3], const real m[3], real k[4]) {
    real node[8], x[4][2], y[2][3];
    for (int n = 0; n < 8; n++)
        node[n] = f[n];
    for (int n = 0; n < 4; n++)
        mix(&node[2 * n], &node[2 * n + 1], 0, p[0], m[0], x[n]);
    for (int n = 0; n < 2; n++)
        mix(x[2 * n], x[2 * n + 1], 1, p[1], m[1], y[n]);
    mix(y[0], y[1], 2, p[2], m[2], k);
}

static bool cell_samples(const ref_volume *v, const long cell[3], float f[8]) {
    bool finite = true;
    for (int n = 0; n < 8; n++) {
        const long x = cell[0] + (n & 1), y = cell[1] + (n >> 1 & 1), z = cell[2] + (n >> 2);
        f[n] = v->samples[x + v->dims[0] * (y + v->dims[1] * z)];
        finite = finite && isfinite(f[n]);
    }
    return finite;
}

static bool grid_piece(const ref_volume *v, const real o[3], const real d[3], const ref_visit *w,
                       ref_piece *out) {
    const long cx = v->dims[0] - 1, cy = v->dims[1] - 1, n = (long)w->cell;
    const long cell[3] = {n % cx, n / cx % cy, n / cx / cy};
    float f[8];
    real p[3], m[3];
    if (!(w->t_in < w->t_out) || !cell_samples(v, cell, f))
        return false;
    for (int a = 0; a < 3; a++) {
        const real lo = v->axis[a] ? (real)v->axis[a][cell[a]] : (real)cell[a];
        const real hi = v->axis[a] ? (real)v->axis[a][cell[a] + 1] : (real)cell[a] + 1;
        p[a] = fminl(fmaxl((o[a] + w->t_in * d[a] - lo) / (hi - lo), 0), 1);
        m[a] = d[a] / (hi - lo);
    }
    *out = (ref_piece){.t0 = w->t_in, .t1 = w->t_out, .cell = (uint64_t)w->cell};
    along(f, p, m, out->k);
    return true;
}

size_t ref_grid_pieces(const ref_volume *v, const ref_ray *ray, const ref_clip *clip,
                       ref_piece *out, size_t room) {
    static ref_visit visits[VISITS_MAX];
    const size_t n = ref_visits(v, ray, clip, visits, VISITS_MAX);
    real o[3], d[3];
    size_t count = 0;
    if (n > VISITS_MAX)
        abort(); /* a test of larger volumes needs more room */
    ref_to_grid(v, ray, o, d);
    for (size_t i = 0; i < n && count < room; i++)
        count += grid_piece(v, o, d, &visits[i], &out[count]);
    return count;
}

/* ---- Meshes ---- */

static int by_start(const void *a, const void *b) {
    const ref_piece *p = a, *q = b;
    if (p->t0 != q->t0)
        return p->t0 < q->t0 ? -1 : 1;
    return (p->cell > q->cell) - (p->cell < q->cell);
}

static bool mesh_piece(const tet_ref_mesh *m, size_t tet, const ref_ray *ray, real t0, real t1,
                       ref_piece *out) {
    real t[2], f[2];
    if (!tet_ref_exact_crossings(m, tet, ray, t, f))
        return false;
    const real slope = (f[1] - f[0]) / (t[1] - t[0]), from = fmaxl(t[0], t0);
    *out = (ref_piece){from, fminl(t[1], t1), {f[0] + slope * (from - t[0]), slope}, tet};
    return out->t0 < out->t1;
}

size_t ref_mesh_pieces(const tet_ref_mesh *m, const ref_ray *ray, const ref_clip *clip,
                       ref_piece *out, size_t room) {
    real t0, t1;
    size_t count = 0;
    ref_clip_interval(clip, ray, &t0, &t1);
    for (size_t i = 0; i < m->tet_count && count < room; i++)
        count += mesh_piece(m, i, ray, t0, t1, &out[count]);
    qsort(out, count, sizeof *out, by_start);
    return count;
}
