/* reference.c - brute force: every plane the ray crosses, in order; every cell between two
 * crossings; every surface in it.
 *
 * Per cell, f along the ray is a cubic about the cell's entry. Its extrema cut the way through the
 * cell into at most three monotone pieces; a piece whose ends lie on different sides holds one
 * surface, found by bisection.
 */
#include "tests/support/reference.h"

#include <float.h>
#include <math.h>
#include <string.h>

_Static_assert(LDBL_MANT_DIG >= 64, "the reference needs a long double that is longer than double");

typedef long double real;

/* A ray in node coordinates. */
typedef struct line {
    real o[3], d[3];
} line;

/* One visit of the walk: the cell, and where the ray enters and leaves it. The axis of the plane
 * crossed there, or NONE where the ray begins or ends inside. */
enum { NONE = -1 };
typedef struct visit {
    long cell[3];
    real t_in, t_out;
    int in_axis, out_axis;
} visit;

/* What is asked of a walk. */
typedef struct query {
    const ref_volume *v;
    line ray;
    const double *isos;
    int iso_count;
    ref_hit *hits; /* sorted, the first `capacity` of those found */
    size_t capacity, found;
    bool only_first;   /* stop when hits[0] can no longer change */
    visit *last_visit; /* or NULL */
    ref_visit *visits; /* or NULL */
    size_t visit_capacity, visit_count;
} query;

/* ---- the volume ---- */

ref_volume ref_volume_regular(const long dims[3], const float *samples, const double spacing[3],
                              const double origin[3]) {
    ref_volume v = {.samples = samples};
    for (int a = 0; a < 3; a++) {
        v.dims[a] = dims[a];
        v.to_world[a][a] = spacing ? spacing[a] : 1;
        v.to_world[a][3] = origin ? origin[a] : 0;
    }
    return v;
}

static real plane_at(const ref_volume *v, int a, long i) {
    return v->axis[a] ? (real)v->axis[a][i] : (real)i;
}

static void cell_samples(const ref_volume *v, const long cell[3], float f[8]) {
    size_t nx = (size_t)v->dims[0], nxy = nx * (size_t)v->dims[1];
    const float *base = v->samples + (size_t)cell[0] + nx * (size_t)cell[1] + nxy * (size_t)cell[2];
    for (int n = 0; n < 8; n++)
        f[n] = base[(size_t)(n & 1) + nx * (size_t)(n >> 1 & 1) + nxy * (size_t)(n >> 2)];
}

static int64_t cell_index(const ref_volume *v, const long cell[3]) {
    int64_t cx = v->dims[0] - 1, cy = v->dims[1] - 1;
    return cell[0] + cx * (cell[1] + cy * cell[2]);
}

/* Solve M x = r by Gaussian elimination with pivoting; a diagonal M divides and rounds once. */
static void solve3(const double m[3][4], const real r[3], real x[3]) {
    real a[3][4];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            a[i][j] = j < 3 ? (real)m[i][j] : r[i];
    for (int c = 0; c < 3; c++) {
        int p = c;
        for (int i = c + 1; i < 3; i++)
            p = fabsl(a[i][c]) > fabsl(a[p][c]) ? i : p;
        for (int j = 0; j < 4; j++) {
            real swap = a[c][j];
            a[c][j] = a[p][j];
            a[p][j] = swap;
        }
        for (int i = c + 1; i < 3; i++) {
            real factor = a[i][c] / a[c][c];
            for (int j = c; j < 4; j++)
                a[i][j] -= factor * a[c][j];
        }
    }
    for (int i = 2; i >= 0; i--) {
        x[i] = a[i][3];
        for (int j = i + 1; j < 3; j++)
            x[i] -= a[i][j] * x[j];
        x[i] /= a[i][i];
    }
}

void ref_to_grid(const ref_volume *v, const ref_ray *ray, long double o[3], long double d[3]) {
    real from_origin[3], direction[3];
    for (int a = 0; a < 3; a++) {
        from_origin[a] = (real)ray->o[a] - v->to_world[a][3];
        direction[a] = ray->d[a];
    }
    solve3(v->to_world, from_origin, o);
    solve3(v->to_world, direction, d);
    for (int a = 0; a < 3; a++)
        d[a] = d[a] == 0 ? 0 : d[a]; /* -0 counts as +0 */
}

/* ---- one cell ---- */

typedef struct cell {
    real lo[3], hi[3];
    float f[8]; /* x fastest */
} cell;

/* f - iso at a point of the unit cube, as written in M08 2.22 to 2.24: seven linear interpolations.
 */
static real trilinear(const real g[8], const real p[3]) {
    real x[4], y[2];
    for (int n = 0; n < 4; n++)
        x[n] = (1 - p[0]) * g[2 * n] + p[0] * g[2 * n + 1];
    for (int n = 0; n < 2; n++)
        y[n] = (1 - p[1]) * x[2 * n] + p[1] * x[2 * n + 1];
    return (1 - p[2]) * y[0] + p[2] * y[1];
}

static real clamp01(real x) {
    return x < 0 ? 0 : x > 1 ? 1 : x;
}

/* The ray at t in the unit cube of the cell. On a face (axis a) that coordinate is exact, so that
 * trilinear() there is the bilinear form of the face's 4 samples, the same from both cells: the
 * other two coordinates depend on t alone. */
static void local_point(const cell *c, const line *ray, real t, int face_axis, bool leaving,
                        real p[3]) {
    for (int a = 0; a < 3; a++)
        p[a] = clamp01((ray->o[a] + t * ray->d[a] - c->lo[a]) / (c->hi[a] - c->lo[a]));
    if (face_axis != NONE)
        p[face_axis] = (ray->d[face_axis] > 0) == leaving ? 1 : 0;
}

/* out = a + (b - a) * (p + m s), all polynomials in s; a and b have `degree`, out one more. */
static void poly_mix(const real *a, const real *b, int degree, real p, real m, real *out) {
    for (int i = 0; i <= degree + 1; i++)
        out[i] = i <= degree ? a[i] : 0;
    for (int i = 0; i <= degree; i++) {
        out[i] += (b[i] - a[i]) * p;
        out[i + 1] += (b[i] - a[i]) * m;
    }
}

/* The cubic k[0] + k[1] s + k[2] s^2 + k[3] s^3 that trilinear(g) is along p + m s. */
static void cubic_along(const real g[8], const real p[3], const real m[3], real k[4]) {
    real x[4][2], y[2][3];
    for (int n = 0; n < 4; n++)
        poly_mix(&g[2 * n], &g[2 * n + 1], 0, p[0], m[0], x[n]);
    for (int n = 0; n < 2; n++)
        poly_mix(x[2 * n], x[2 * n + 1], 1, p[1], m[1], y[n]);
    poly_mix(y[0], y[1], 2, p[2], m[2], k);
}

/* Where the cubic's slope is 0, strictly inside (0, length), in order. */
static int extrema(const real k[4], real length, real s[2]) {
    real a = 3 * k[3], b = k[2], c = k[1];
    real square = b * b - a * c;
    if (!(square >= 0))
        return 0;
    real q = -(b + copysignl(sqrtl(square), b));
    real candidate[2] = {q / a, c / q}; /* inf or NaN where there is none: refused below */
    if (candidate[0] > candidate[1]) {
        real swap = candidate[0];
        candidate[0] = candidate[1];
        candidate[1] = swap;
    }
    int count = 0;
    for (int i = 0; i < 2; i++)
        if (candidate[i] > 0 && candidate[i] < length)
            s[count++] = candidate[i];
    return count;
}

static real value_after(const real g[8], const real p[3], const real m[3], real s) {
    real at[3];
    for (int a = 0; a < 3; a++)
        at[a] = clamp01(p[a] + m[a] * s);
    return trilinear(g, at);
}

/* The one change of side in [a, b], where a is on side `inside`; the last point, or the first, that
 * is inside. */
static real bisect(const real g[8], const real p[3], const real m[3], real a, real b, bool inside) {
    for (int i = 0; i < 200; i++) {
        real middle = a + (b - a) / 2;
        if (middle == a || middle == b)
            break;
        if ((value_after(g, p, m, middle) >= 0) == inside)
            a = middle;
        else
            b = middle;
    }
    return inside ? a : b;
}

/* Whether the cell holds data, and the isovalue's surface may pass: some sample below it, some not.
 */
static bool is_active(const float f[8], double iso) {
    bool below = false, above = false;
    for (int n = 0; n < 8; n++) {
        if (!isfinite(f[n]))
            return false;
        below |= (double)f[n] < iso;
        above |= (double)f[n] >= iso;
    }
    return below && above;
}

/* The way from p_in to p_out, in the unit cube of an active cell, cut at the extrema: no piece can
 * change sides twice. s: from the entry on, in t. */
typedef struct way {
    real g[8], p_in[3], m[3]; /* samples minus iso; where it begins; cells per t */
    real s[4];
    bool side[4];
    int pieces;
} way;

/* The way of a visit of the ray. shift: NULL, or a step in the unit cube by which it is moved, as
 * far as the cell reaches. */
static way way_of(const cell *c, const line *ray, const visit *w, double iso, const real shift[3]) {
    way y;
    real p_out[3], k[4];
    const real length = w->t_out - w->t_in;
    for (int n = 0; n < 8; n++)
        y.g[n] = (real)c->f[n] - iso;
    local_point(c, ray, w->t_in, w->in_axis, false, y.p_in);
    local_point(c, ray, w->t_out, w->out_axis, true, p_out);
    for (int a = 0; a < 3; a++) {
        y.m[a] = ray->d[a] / (c->hi[a] - c->lo[a]);
        if (shift) {
            y.p_in[a] = clamp01(y.p_in[a] + shift[a]);
            p_out[a] = clamp01(p_out[a] + shift[a]);
        }
    }
    cubic_along(y.g, y.p_in, y.m, k);
    y.s[0] = 0;
    y.side[0] = trilinear(y.g, y.p_in) >= 0;
    y.pieces = 1 + extrema(k, length, y.s + 1);
    for (int i = 1; i < y.pieces; i++)
        y.side[i] = value_after(y.g, y.p_in, y.m, y.s[i]) >= 0;
    y.s[y.pieces] = length;
    y.side[y.pieces] = trilinear(y.g, p_out) >= 0;
    return y;
}

/* All changes of side on the way of a visit: t's in order, and the side each comes from. */
static int cell_crossings(const cell *c, const line *ray, const visit *w, double iso, real t[3],
                          bool from_inside[3]) {
    const way y = way_of(c, ray, w, iso, NULL);
    int count = 0;
    for (int i = 0; i < y.pieces; i++) {
        if (y.side[i] == y.side[i + 1])
            continue;
        from_inside[count] = y.side[i];
        t[count++] = w->t_in + bisect(y.g, y.p_in, y.m, y.s[i], y.s[i + 1], y.side[i]);
    }
    return count;
}

/* Whether the moved way changes side as often as before, and each time within `limit` of the t it
 * was. */
static bool crossings_stay(const way *y, real t_in, const real t[3], int count, real limit) {
    int n = 0;
    for (int i = 0; i < y->pieces; i++) {
        if (y->side[i] == y->side[i + 1])
            continue;
        if (n == count)
            return false;
        /* A piece changes sides once: between two points on different sides of it. */
        const real before = t[n] - limit - t_in, after = t[n] + limit - t_in;
        n++;
        if (before > y->s[i + 1] || after < y->s[i] ||
            (before > y->s[i] && (value_after(y->g, y->p_in, y->m, before) >= 0) != y->side[i]) ||
            (after < y->s[i + 1] && (value_after(y->g, y->p_in, y->m, after) >= 0) == y->side[i]))
            return false;
    }
    return n == count;
}

static double cells_per_t(const cell *c, const line *ray) {
    real sum = 0;
    for (int a = 0; a < 3; a++) {
        real m = ray->d[a] / (c->hi[a] - c->lo[a]);
        sum += m * m;
    }
    return (double)sqrtl(sum);
}

/* ---- the walk ---- */

static bool comes_before(const ref_hit *a, const ref_hit *b) {
    if (a->t != b->t)
        return a->t < b->t;
    if (a->cell != b->cell)
        return a->cell < b->cell;
    return a->iso < b->iso;
}

/* Keep the hit at its place in the list; hits of equal rank stay in the order they were found. */
static void keep(query *q, const ref_hit *hit) {
    size_t n = q->found < q->capacity ? q->found : q->capacity;
    size_t at = n;
    while (at > 0 && comes_before(hit, &q->hits[at - 1]))
        at--;
    q->found++;
    if (at >= q->capacity)
        return;
    size_t moved = (n < q->capacity ? n : q->capacity - 1) - at;
    memmove(&q->hits[at + 1], &q->hits[at], moved * sizeof q->hits[0]);
    q->hits[at] = *hit;
}

static void visit_cell(query *q, const visit *w) {
    if (q->visit_count++ < q->visit_capacity)
        q->visits[q->visit_count - 1] = (ref_visit){cell_index(q->v, w->cell), w->t_in, w->t_out};
    if (q->last_visit)
        *q->last_visit = *w;
    cell c;
    cell_samples(q->v, w->cell, c.f);
    for (int a = 0; a < 3; a++) {
        c.lo[a] = plane_at(q->v, a, w->cell[a]);
        c.hi[a] = plane_at(q->v, a, w->cell[a] + 1);
    }
    for (int i = 0; i < q->iso_count; i++) {
        if (!is_active(c.f, q->isos[i]))
            continue;
        real t[3];
        bool from_inside[3];
        int count = cell_crossings(&c, &q->ray, w, q->isos[i], t, from_inside);
        for (int n = 0; n < count; n++) {
            ref_hit hit = {
                .t = (double)t[n], .t_exact = t[n], .iso = i, .from_inside = from_inside[n]};
            hit.cell = cell_index(q->v, w->cell);
            hit.cells_per_t = cells_per_t(&c, &q->ray);
            keep(q, &hit);
        }
    }
}

/* The t at which the ray crosses plane i of axis a; d[a] is not 0. */
static real crossing(const ref_volume *v, const line *ray, int a, long i) {
    return (plane_at(v, a, i) - ray->o[a]) / ray->d[a];
}

/* The t interval of the whole box and the axis entered last; false when the ray passes by. Planes
 * of equal t are crossed x first, so a ray that leaves before it enters only touches an edge from
 * outside. */
static bool box_interval(const ref_volume *v, const line *ray, real *t0, real *t1, int *in_axis) {
    int out_axis = 3;
    *t0 = -INFINITY;
    *t1 = INFINITY;
    *in_axis = NONE;
    for (int a = 0; a < 3; a++) {
        long last = v->dims[a] - 1;
        if (ray->d[a] == 0) {
            if (!(ray->o[a] >= plane_at(v, a, 0) && ray->o[a] <= plane_at(v, a, last)))
                return false;
            continue;
        }
        real in = crossing(v, ray, a, ray->d[a] > 0 ? 0 : last);
        real out = crossing(v, ray, a, ray->d[a] > 0 ? last : 0);
        if (in >= *t0) {
            *t0 = in;
            *in_axis = a;
        }
        if (out < *t1) {
            *t1 = out;
            out_axis = a;
        }
    }
    return *t0 < *t1 || (*t0 == *t1 && *in_axis < out_axis);
}

/* Whether the ray has crossed plane i of axis a (d[a] is not 0) once it has crossed a plane of
 * in_axis at t; of equal t, x comes before y before z. Where it begins at t (in_axis NONE) it lies
 * in the cell that owns [i, i + 1): planes at t are crossed already on the way up, not yet on the
 * way down. */
static bool has_crossed(const ref_volume *v, const line *ray, int a, long i, real t, int in_axis) {
    real plane_t = crossing(v, ray, a, i);
    if (plane_t != t)
        return plane_t < t;
    return in_axis == NONE ? ray->d[a] > 0 : a <= in_axis;
}

/* The index on axis a of the cell the ray is in, then: the last whose lower plane lies at or below
 * the ray. */
static long first_cell(const ref_volume *v, const line *ray, int a, real t, int in_axis) {
    long i = 0, end = v->dims[a] - 1; /* it lies in [i, end) */
    while (end - i > 1) {
        long middle = i + (end - i) / 2;
        bool below;
        if (ray->d[a] == 0)
            below = plane_at(v, a, middle) <= ray->o[a];
        else
            below = has_crossed(v, ray, a, middle, t, in_axis) == (ray->d[a] > 0);
        if (below)
            i = middle;
        else
            end = middle;
    }
    return i;
}

/* The next plane crossed after this visit began: of equal t the lowest axis. */
static void find_exit(const ref_volume *v, const line *ray, visit *w) {
    w->t_out = INFINITY;
    w->out_axis = NONE;
    for (int a = 0; a < 3; a++) {
        if (ray->d[a] == 0)
            continue;
        real t = crossing(v, ray, a, w->cell[a] + (ray->d[a] > 0));
        if (t < w->t_out) {
            w->t_out = t;
            w->out_axis = a;
        }
    }
}

static void walk(query *q, real t0, real t1) {
    const ref_volume *v = q->v;
    real box0, box1;
    int box_axis;
    if (!box_interval(v, &q->ray, &box0, &box1, &box_axis))
        return;
    bool from_outside = box0 > t0;
    visit w = {.t_in = from_outside ? box0 : t0, .in_axis = from_outside ? box_axis : NONE};
    if (!(w.t_in <= t1 && w.t_in <= box1))
        return;
    for (int a = 0; a < 3; a++)
        w.cell[a] = first_cell(v, &q->ray, a, w.t_in, w.in_axis);

    for (;;) {
        if (q->only_first && q->found > 0 && (double)w.t_in > q->hits[0].t)
            return;
        find_exit(v, &q->ray, &w);
        bool ends = w.t_out > t1 || w.out_axis == NONE;
        if (ends) {
            w.t_out = t1;
            w.out_axis = NONE;
        }
        visit_cell(q, &w);
        if (ends)
            return;
        int a = w.out_axis;
        w.cell[a] += q->ray.d[a] > 0 ? 1 : -1;
        if (w.cell[a] < 0 || w.cell[a] > v->dims[a] - 2)
            return;
        w.t_in = w.t_out;
        w.in_axis = a;
    }
}

/* ---- asking ---- */

/* Keep of [t0, t1] what has n . (o + t d) + w >= 0. */
static void clip_plane(const ref_ray *ray, const double plane[4], real *t0, real *t1) {
    real at_origin = plane[3], slope = 0;
    for (int a = 0; a < 3; a++) {
        at_origin += (real)plane[a] * ray->o[a];
        slope += (real)plane[a] * ray->d[a];
    }
    if (slope == 0) {
        if (at_origin < 0)
            *t1 = -INFINITY;
        return;
    }
    real t = -at_origin / slope;
    if (slope > 0)
        *t0 = t > *t0 ? t : *t0;
    else
        *t1 = t < *t1 ? t : *t1;
}

void ref_clip_interval(const ref_clip *clip, const ref_ray *ray, long double *t0, long double *t1) {
    *t0 = clip ? clip->t0 : 0;
    *t1 = clip ? clip->t1 : INFINITY;
    for (int i = 0; clip && i < clip->plane_count; i++)
        clip_plane(ray, clip->planes[i], t0, t1);
    for (int a = 0; clip && clip->box && a < 3; a++) {
        double lower[4] = {0, 0, 0, -clip->box[0][a]}, upper[4] = {0, 0, 0, clip->box[1][a]};
        lower[a] = 1;
        upper[a] = -1;
        clip_plane(ray, lower, t0, t1);
        clip_plane(ray, upper, t0, t1);
    }
}

static void run(query *q, const ref_ray *ray, const long double shift[3], const ref_clip *clip) {
    ref_to_grid(q->v, ray, q->ray.o, q->ray.d);
    for (int a = 0; a < 3; a++)
        q->ray.o[a] += shift ? shift[a] : 0;
    real t0, t1;
    ref_clip_interval(clip, ray, &t0, &t1);
    if (t0 <= t1)
        walk(q, t0, t1);
}

size_t ref_trace_shifted(const ref_volume *v, const ref_ray *ray, const long double shift[3],
                         const double *isos, int iso_count, const ref_clip *clip, ref_hit *hits,
                         size_t capacity) {
    query q = {.v = v, .isos = isos, .iso_count = iso_count, .hits = hits, .capacity = capacity};
    q.only_first = capacity == 1;
    run(&q, ray, shift, clip);
    return q.found;
}

size_t ref_visits(const ref_volume *v, const ref_ray *ray, const ref_clip *clip, ref_visit *visits,
                  size_t capacity) {
    query q = {.v = v, .visits = visits, .visit_capacity = capacity};
    run(&q, ray, NULL, clip);
    return q.visit_count;
}

size_t ref_trace(const ref_volume *v, const ref_ray *ray, const double *isos, int iso_count,
                 const ref_clip *clip, ref_hit *hits, size_t capacity) {
    return ref_trace_shifted(v, ray, NULL, isos, iso_count, clip, hits, capacity);
}

long double ref_value(const ref_volume *v, const long double p[3], double iso) {
    line still = {.o = {p[0], p[1], p[2]}};
    real t0, t1, g[8], at[3];
    int in_axis;
    if (!box_interval(v, &still, &t0, &t1, &in_axis))
        return NAN;
    long owned[3];
    cell c;
    for (int a = 0; a < 3; a++) {
        owned[a] = first_cell(v, &still, a, 0, NONE);
        c.lo[a] = plane_at(v, a, owned[a]);
        c.hi[a] = plane_at(v, a, owned[a] + 1);
    }
    cell_samples(v, owned, c.f);
    for (int n = 0; n < 8; n++) {
        if (!isfinite(c.f[n]))
            return NAN;
        g[n] = (real)c.f[n] - iso;
    }
    local_point(&c, &still, 0, NONE, false, at);
    return trilinear(g, at);
}

/* A volume of one cell; axes and ray are the caller's to keep. */
static ref_volume one_cell(const double o[3], const double d[3], const double lo[3],
                           const double hi[3], const float samples[8], double axes[3][2],
                           ref_ray *ray) {
    const long dims[3] = {2, 2, 2};
    ref_volume v = ref_volume_regular(dims, samples, NULL, NULL);
    for (int a = 0; a < 3; a++) {
        axes[a][0] = lo[a];
        axes[a][1] = hi[a];
        v.axis[a] = axes[a];
        ray->o[a] = o[a];
        ray->d[a] = d[a];
    }
    return v;
}

int ref_cell_roots(const double o[3], const double d[3], const double lo[3], const double hi[3],
                   const float samples[8], double iso, ref_hit hits[REF_CELL_ROOTS_MAX]) {
    double axes[3][2];
    ref_ray ray;
    ref_volume v = one_cell(o, d, lo, hi, samples, axes, &ray);
    return (int)ref_trace(&v, &ray, &iso, 1, NULL, hits, REF_CELL_ROOTS_MAX);
}

void ref_sideways(const long double d[3], int direction, long double shift[3]) {
    /* Two unit vectors perpendicular to d and to each other. */
    real u[3], w[3], dd = d[0] * d[0] + d[1] * d[1] + d[2] * d[2], length = 0;
    int least = 0;
    for (int a = 1; a < 3; a++)
        least = fabsl(d[a]) < fabsl(d[least]) ? a : least;
    for (int a = 0; a < 3; a++) {
        u[a] = (a == least ? 1 : 0) - d[least] * d[a] / dd;
        length += u[a] * u[a];
    }
    for (int a = 0; a < 3; a++)
        u[a] /= sqrtl(length);
    for (int a = 0; a < 3; a++) {
        int b = (a + 1) % 3, c = (a + 2) % 3;
        w[a] = (d[b] * u[c] - d[c] * u[b]) / sqrtl(dd);
    }
    static const int steps[REF_SIDEWAYS][2] = {{1, 0}, {-1, 0}, {0, 1},  {0, -1},
                                               {1, 1}, {1, -1}, {-1, 1}, {-1, -1}};
    const int *step = steps[direction];
    for (int a = 0; a < 3; a++)
        shift[a] = (step[0] * u[a] + step[1] * w[a]) / (step[0] && step[1] ? sqrtl(2) : 1);
}

bool ref_cell_grazing(const double o[3], const double d[3], const double lo[3], const double hi[3],
                      const float samples[8], double iso, double shift, double change) {
    double axes[3][2];
    ref_ray world;
    ref_volume v = one_cell(o, d, lo, hi, samples, axes, &world);
    visit w;
    query q = {.v = &v, .last_visit = &w};
    run(&q, &world, NULL, NULL);
    cell c = {.lo = {lo[0], lo[1], lo[2]}, .hi = {hi[0], hi[1], hi[2]}};
    cell_samples(&v, (const long[3]){0, 0, 0}, c.f);
    if (q.visit_count == 0 || !is_active(c.f, iso))
        return false;

    real m[3], sideways[3], t[3], limit = change / cells_per_t(&c, &q.ray);
    bool from_inside[3];
    int count = cell_crossings(&c, &q.ray, &w, iso, t, from_inside);
    for (int a = 0; a < 3; a++)
        m[a] = q.ray.d[a] / (c.hi[a] - c.lo[a]);
    for (int n = 0; n < REF_SIDEWAYS; n++) {
        ref_sideways(m, n, sideways);
        for (int a = 0; a < 3; a++)
            sideways[a] *= shift;
        const way moved = way_of(&c, &q.ray, &w, iso, sideways);
        if (!crossings_stay(&moved, w.t_in, t, count, limit))
            return true;
    }
    return false;
}
