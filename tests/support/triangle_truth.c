#include "tests/support/triangle_truth.h"

#include <math.h>

typedef long double real;

static real determinant(const real a[3], const real b[3], const real c[3]) {
    return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
           a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/* slack: the triangle is larger by so much. */
static real meet(const triangle_lab *s, uint32_t i, const real o[3], const real d[3], real slack) {
    real a[3][3], w[3], give[3], sum = 0.0L, t = 0.0L, square = 0.0L;
    for (int k = 0; k < 3; k++)
        for (int x = 0; x < 3; x++)
            a[k][x] = (real)s->xyz[s->corner[i][k]][x] - o[x];
    for (int k = 0; k < 3; k++) {
        w[k] = determinant(d, a[(k + 1) % 3], a[(k + 2) % 3]);
        sum += w[k];
        give[k] = 0.0L;
        for (int x = 0; x < 3; x++)
            give[k] += slack * fabsl(a[(k + 1) % 3][x] - a[(k + 2) % 3][x]);
    }
    const bool above = w[0] >= -give[0] && w[1] >= -give[1] && w[2] >= -give[2],
               below = w[0] <= give[0] && w[1] <= give[1] && w[2] <= give[2];
    if (sum == 0.0L || (above ? below && slack == 0.0L : !below))
        return INFINITY;
    for (int x = 0; x < 3; x++) {
        square += d[x] * d[x];
        for (int k = 0; k < 3; k++)
            t += w[k] / sum * a[k][x] * d[x];
    }
    return t / square;
}

/* Whether the line passes far from a triangle: by the ball about it, made larger. */
static bool passes_far(const triangle_lab *s, uint32_t i, const real o[3], const real d[3]) {
    const double *ball = s->about[i];
    double a[3], off = 0.0, far = 0.0;
    for (int k = 0; k < 3; k++) {
        a[k] = ball[k] - (double)o[k];
        far += fabs(a[k]);
    }
    for (int k = 0; k < 3; k++) {
        const double c =
            a[(k + 1) % 3] * (double)d[(k + 2) % 3] - a[(k + 2) % 3] * (double)d[(k + 1) % 3];
        off += c * c;
    }
    return sqrt(off) > 1.001 * ball[3] + 1e-5 * s->edge + 1e-12 * far;
}

static real first_of(const triangle_lab *s, const real o[3], const real d[3], real t0, real slack,
                     uint32_t *nearest) {
    real first = INFINITY;
    for (uint32_t i = 0; i < s->triangles; i++) {
        if (passes_far(s, i, o, d))
            continue;
        const real t = meet(s, i, o, d, slack);
        if (t > t0 && t < first) {
            first = t;
            if (nearest)
                *nearest = i;
        }
    }
    return first;
}

long double triangle_truth_first(const triangle_lab *s, const double o[3], const double d[3],
                                 double t0, uint32_t *nearest) {
    const real from[3] = {o[0], o[1], o[2]}, along[3] = {d[0], d[1], d[2]};
    return first_of(s, from, along, t0, 0.0L, nearest);
}

/* Two directions across the ray. */
static void across(const double d[3], real u[3], real v[3]) {
    int least = 0;
    real square = 0.0L;
    for (int a = 1; a < 3; a++)
        if (fabs(d[a]) < fabs(d[least]))
            least = a;
    for (int a = 0; a < 3; a++) {
        u[a] = (a == least) - (real)d[least] * d[a];
        square += u[a] * u[a];
    }
    for (int a = 0; a < 3; a++)
        u[a] /= sqrtl(square);
    for (int a = 0; a < 3; a++)
        v[a] = (real)d[(a + 1) % 3] * u[(a + 2) % 3] - (real)d[(a + 2) % 3] * u[(a + 1) % 3];
}

long double triangle_truth_expect(const triangle_lab *s, const double o[3], const double d[3]) {
    enum { MOVES = 6 };
    const real along[3] = {d[0], d[1], d[2]}, by = 1e-6L * s->edge;
    real u[3], v[3], least = INFINITY, most = -INFINITY, of_ray;
    across(d, u, v);
    for (int n = 0; n < MOVES; n++) {
        const real turn = 0.37L + 6.283185307179586L * n / MOVES;
        real from[3];
        for (int a = 0; a < 3; a++)
            from[a] = o[a] + by * (cosl(turn) * u[a] + sinl(turn) * v[a]);
        const real t = first_of(s, from, along, 0.0L, 0.0L, NULL);
        least = t < least ? t : least;
        most = t > most ? t : most;
    }
    of_ray = triangle_truth_first(s, o, d, 0.0, NULL);
    /* A corner may be too narrow for the moves. */
    const real at[3] = {o[0], o[1], o[2]}, wide = first_of(s, at, along, 0.0L, by, NULL);
    if (isinf(least))
        return isinf(of_ray) && isinf(wide) ? INFINITY : (real)NAN;
    if (isinf(of_ray)) /* lost between two triangles by rounding */
        of_ray = least;
    least = wide < least ? wide : least;
    least = of_ray < least ? of_ray : least;
    most = of_ray > most ? of_ray : most;
    return isinf(most) || most - least > 1e-4L * s->edge ? (real)NAN : of_ray;
}

bool triangle_truth_judge(const triangle_lab *s, const double o[3], const double d[3], double t,
                          triangle_tally *tally) {
    const real expected = triangle_truth_expect(s, o, d);
    tally->rays++;
    if (isnan(expected)) {
        tally->doubtful++;
        return true;
    }
    tally->surfaces += !isinf(expected);
    if (isinf(expected) || isinf(t)) {
        tally->missed += isinf(t) && !isinf(expected);
        tally->invented += !isinf(t) && isinf(expected);
        return isinf(t) && isinf(expected);
    }
    const double off = (double)fabsl(expected - t) / s->edge,
                 rounding = 0x1p-50 * (double)fabsl(expected) / s->edge;
    if (off > 1e-4 + rounding) {
        tally->wrong++;
        return false;
    }
    tally->worst = fmax(tally->worst, off);
    return true;
}
