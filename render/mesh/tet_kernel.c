#include "render/mesh/tet_kernel.h"

#include <float.h>
#include <string.h>

#include "formats/base/exact.h"
#include "formats/base/vec3.h"
#include "render/surface/shade.h"

const uint8_t tet_edge_ends[TET_EDGES][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

const tet_cut tet_cuts[16] = {
    {0, {0, 0, 0, 0}}, /* none */
    {3, {0, 2, 1, 1}}, /* 0 */
    {3, {0, 3, 4, 4}}, /* 1 */
    {4, {1, 3, 4, 2}}, /* 0 1 */
    {3, {1, 5, 3, 3}}, /* 2 */
    {4, {0, 2, 5, 3}}, /* 0 2 */
    {4, {0, 1, 5, 4}}, /* 1 2 */
    {3, {2, 5, 4, 4}}, /* 0 1 2 */
    {3, {2, 4, 5, 5}}, /* 3 */
    {4, {0, 4, 5, 1}}, /* 0 3 */
    {4, {0, 3, 5, 2}}, /* 1 3 */
    {3, {1, 3, 5, 5}}, /* 0 1 3 */
    {4, {1, 2, 4, 3}}, /* 2 3 */
    {3, {0, 4, 3, 3}}, /* 0 2 3 */
    {3, {0, 1, 2, 2}}, /* 1 2 3 */
    {0, {0, 0, 0, 0}}, /* all */
};

/* The triangles of a polygon, by its points. All edges but the diagonal are the polygon's own. */
static const uint8_t corners_of[2][3] = {{0, 1, 2}, {0, 2, 3}};

static double least(double a, double b) {
    return a < b ? a : b;
}

static double most(double a, double b) {
    return a > b ? a : b;
}

static double kept_within(double x, double lo, double hi) {
    return most(lo, least(x, hi));
}

/* ---- the polygon ----------------------------------------------------------------------------- */

/* Returns which vertices are inside, a bit each; 0: the tet is not active. */
static unsigned inside_of(const float f[4], double iso) {
    /* Four floats add up in double without overflow. */
    if (!isfinite((double)f[0] + (double)f[1] + (double)f[2] + (double)f[3]))
        return 0;
    unsigned inside = 0;
    for (unsigned i = 0; i < 4; i++)
        inside |= (unsigned)((double)f[i] >= iso) << i;
    return inside == 15 ? 0 : inside;
}

/* The point never lies beyond a or b. Proof: if s < 1, the product is at least an ulp less than the
 * rounded difference b - a, which errs by half an ulp at most. So a plus the product lies between a
 * and b before it is rounded, and hence after. */
static void cut_edge(const double p[4][3], const float f[4], int edge, double iso,
                     double point[3]) {
    const int i = tet_edge_ends[edge][0], j = tet_edge_ends[edge][1];
    const double fa = (double)f[i], fb = (double)f[j];
    const double s = (iso - fa) / (fb - fa);
    const bool whole = s >= 1.0;
    for (int k = 0; k < 3; k++)
        point[k] = whole ? p[j][k] : p[i][k] + s * (p[j][k] - p[i][k]);
}

void tet_turn_over(uint8_t edge[4], int count) {
    const int i = count == 3 ? 0 : 1, j = count == 3 ? 1 : 3;
    const uint8_t kept = edge[i];
    edge[i] = edge[j];
    edge[j] = kept;
}

bool isopolygon_of(const tet *x, double iso, isopolygon *out) {
    const unsigned inside = inside_of(x->f, iso);
    if (inside == 0)
        return false;
    double p[4][3];
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++)
            p[i][k] = (double)x->p[i][k];
    out->count = tet_cuts[inside].count;
    memcpy(out->edge, tet_cuts[inside].edge, sizeof out->edge);
    if (exact_orientation((const double(*)[3])p) < 0)
        tet_turn_over(out->edge, out->count);
    for (int i = 0; i < out->count; i++)
        cut_edge((const double(*)[3])p, x->f, out->edge[i], iso, out->p[i]);
    if (out->count == 3)
        memcpy(out->p[3], out->p[2], sizeof out->p[3]);
    return true;
}

/* ---- the ray --------------------------------------------------------------------------------- */

/* A polygon, with its points relative to a ray's origin. */
typedef struct seen_polygon {
    const isopolygon *g;
    const ray *r;
    double a[4][3];
} seen_polygon;

/* Where the ray's line crosses a triangle. */
typedef struct crossing {
    double t;
    bool entering; /* along the polygon's normal */
} crossing;

static void see_polygon(const isopolygon *g, const ray *r, seen_polygon *s) {
    s->g = g;
    s->r = r;
    for (int i = 0; i < g->count; i++)
        for (int k = 0; k < 3; k++)
            s->a[i][k] = g->p[i][k] - r->o[k];
}

/* Returns the edge function of points i -> j of the polygon. It is always computed from the lower
 * tet edge to the higher, as for the tet beyond the face. */
static exact_estimate weight_of(const seen_polygon *s, int i, int j, bool exact) {
    const bool swap = s->g->edge[i] > s->g->edge[j];
    const int from = swap ? j : i, to = swap ? i : j;
    const double *p = s->g->p[from], *q = s->g->p[to];
    exact_estimate w;
    if (exact) {
        w = exact_edge(s->r->o, s->r->d, p, q);
    } else {
        const double e[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]};
        w = exact_near(s->r->d, s->a[from], e);
    }
    w.value = swap ? -w.value : w.value;
    return w;
}

/* Returns how far along the ray a point lies, as t times d . d, which keeps the order. */
static double along_of(const seen_polygon *s, int i) {
    return vec3_dot(s->r->d, s->a[i]);
}

/* Find t on the edge from i to j, by the distances of its ends from the ray. Symmetric in i and j
 * to the bit. */
static void cross_edge(const seen_polygon *s, int i, int j, crossing *out) {
    double off[2][3], far[2];
    const double ti = along_of(s, i), tj = along_of(s, j);
    vec3_cross(s->r->d, s->a[i], off[0]);
    vec3_cross(s->r->d, s->a[j], off[1]);
    for (int k = 0; k < 2; k++)
        far[k] = vec3_size(off[k]);
    const double sum = far[0] + far[1];
    out->t = kept_within(sum > 0.0 ? (far[1] * ti + far[0] * tj) / sum : 0.5 * (ti + tj),
                         least(ti, tj), most(ti, tj));
}

static void cross_inside(const seen_polygon *s, const uint8_t c[3], const exact_estimate w[3],
                         crossing *out) {
    const double t0 = along_of(s, c[0]), t1 = along_of(s, c[1]), t2 = along_of(s, c[2]);
    const double w0 = fabs(w[0].value), w1 = fabs(w[1].value), w2 = fabs(w[2].value);
    const double sum = w0 + w1 + w2, lo = least(t0, least(t1, t2)), hi = most(t0, most(t1, t2));
    out->t = kept_within(t0 + (w1 * (t1 - t0) + w2 * (t2 - t0)) / sum, lo, hi);
}

/* Returns whether the ray's line crosses a triangle of the polygon: all its weights have one
 * sign. */
static bool cross_triangle(const seen_polygon *s, const uint8_t c[3], crossing *out) {
    exact_estimate w[3]; /* weight of corner k: of the opposite edge */
    unsigned above = 0, below = 0;
    for (int k = 0; k < 3; k++) {
        w[k] = weight_of(s, c[(k + 1) % 3], c[(k + 2) % 3], false);
        above |= (unsigned)(w[k].value > w[k].bound) << k;
        below |= (unsigned)(w[k].value < -w[k].bound) << k;
    }
    if (above && below)
        return false;
    const unsigned doubtful = 7u & ~(above | below);
    for (int k = 0; k < 3; k++) {
        if (!(doubtful >> k & 1))
            continue;
        w[k] = weight_of(s, c[(k + 1) % 3], c[(k + 2) % 3], true);
        above |= (unsigned)(w[k].value > 0.0) << k;
        below |= (unsigned)(w[k].value < 0.0) << k;
    }
    if ((above != 0) == (below != 0))
        return false;
    out->entering = above != 0;
    const unsigned held = above | below; /* corners whose weight is not 0 */
    if (held == 7) {
        cross_inside(s, c, w, out);
    } else if ((held & (held - 1)) == 0) {
        out->t = along_of(s, c[held >> 1]);
    } else {
        const int gone = held == 6 ? 0 : held == 5 ? 1 : 2;
        cross_edge(s, c[(gone + 1) % 3], c[(gone + 2) % 3], out);
    }
    out->t /= vec3_dot(s->r->d, s->r->d);
    return true;
}

bool isopolygon_hit(const isopolygon *g, const ray *r, uint64_t cell, int32_t iso_index,
                    const hit *after, hit *found) {
    seen_polygon s;
    see_polygon(g, r, &s);
    bool any = false;
    for (int k = 0; k < g->count - 2; k++) {
        crossing x;
        if (!cross_triangle(&s, corners_of[k], &x) || !(x.t >= r->t0 && x.t <= r->t1))
            continue;
        const hit h = {x.t, cell, iso_index, x.entering};
        if (hit_less(after, &h) && (!any || hit_less(&h, found))) {
            *found = h;
            any = true;
        }
    }
    return any;
}

/* ---- what is known about a hit --------------------------------------------------------------- */

/* A direction across a surface, a unit vector or the gradient, and its error bounds. */
typedef struct across {
    double direction[3], error[3];
} across;

/* Errors, with u = half an epsilon: sides err by u of themselves, differences of two products by 4
 * u of the moduli, their products with the values by 8 u; so does the determinant, of its own
 * terms. */
static bool find_gradient(const tet *x, across *out) {
    double e[3][3], df[3], normal[3][3], moduli[3] = {0.0, 0.0, 0.0};
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++)
            e[i][k] = (double)x->p[i + 1][k] - (double)x->p[0][k];
        df[i] = (double)x->f[i + 1] - (double)x->f[0];
    }
    for (int i = 0; i < 3; i++) {
        const double *a = e[(i + 1) % 3], *b = e[(i + 2) % 3];
        vec3_cross(a, b, normal[i]);
        for (int k = 0; k < 3; k++) {
            const int l = (k + 1) % 3, m = (k + 2) % 3;
            moduli[k] += fabs(df[i]) * (fabs(a[l] * b[m]) + fabs(a[m] * b[l]));
        }
    }
    const double determinant = vec3_dot(e[0], normal[0]);
    const exact_estimate sure = exact_near(e[0], e[1], e[2]);
    if (!(fabs(determinant) > TET_GRADIENT_SURE / EXACT_BOUND * sure.bound) ||
        !isfinite(df[0] + df[1] + df[2]))
        return false;
    const double terms = sure.bound / EXACT_BOUND, size = fabs(determinant);
    for (int k = 0; k < 3; k++) {
        const double g =
            (df[0] * normal[0][k] + df[1] * normal[1][k] + df[2] * normal[2][k]) / determinant;
        out->direction[k] = g;
        out->error[k] = 5.0 * DBL_EPSILON * (moduli[k] / size + terms / size * fabs(g));
    }
    return true;
}

bool tet_gradient(const tet *x, double gradient[3]) {
    across g;
    if (!find_gradient(x, &g))
        return false;
    memcpy(gradient, g.direction, sizeof g.direction);
    return true;
}

/* Find the normal from the diagonals, or two edges of a triangle. Returns false if it is 0. */
static bool find_normal(const isopolygon *g, across *out) {
    double e[2][3], normal[3], moduli = 0.0;
    vec3_sub(g->p[2], g->p[0], e[0]);
    vec3_sub(g->p[3], g->p[1], e[1]);
    vec3_cross(e[0], e[1], normal);
    for (int k = 0; k < 3; k++) {
        const int l = (k + 1) % 3, m = (k + 2) % 3;
        moduli += fabs(e[0][l] * e[1][m]) + fabs(e[0][m] * e[1][l]);
    }
    for (int k = 0; k < 3; k++)
        out->error[k] = 4.0 * DBL_EPSILON * (moduli / vec3_size(normal) + 1.0);
    return isfinite(normal[0] + normal[1] + normal[2]) && vec3_unit(normal, out->direction);
}

static double shortest_edge(const tet *x) {
    double square = INFINITY;
    for (int i = 0; i < TET_EDGES; i++) {
        double e[3];
        for (int k = 0; k < 3; k++)
            e[k] = (double)x->p[tet_edge_ends[i][1]][k] - (double)x->p[tet_edge_ends[i][0]][k];
        square = least(square, vec3_dot(e, e));
    }
    return sqrt(square);
}

/* Find the gradient, and return true. If there is none, set the polygon's normal or 0, and return
 * false. */
static bool find_across(const tet *x, const isopolygon *g, across *out) {
    if (find_gradient(x, out))
        return true;
    if (!find_normal(g, out))
        *out = (across){{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
    return false;
}

static void normal_against(const double gradient[3], float normal[3]) {
    if (!shade_normal(gradient, normal))
        normal[0] = normal[1] = normal[2] = 0.0f;
}

void tet_normal(const tet *x, double iso, float normal[3]) {
    across n = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
    isopolygon g;
    if (!find_gradient(x, &n) && isopolygon_of(x, iso, &g))
        (void)find_across(x, &g, &n);
    normal_against(n.direction, normal);
}

/* A point of the polygon has the isovalue, but for an error along its edge (8 epsilons of the
 * values' greatest difference from it) and its own rounding. */
tet_facts tet_facts_of(const tet *x, double iso) {
    tet_facts f = {.slack = INFINITY, .point = {.span = shortest_edge(x)}};
    across n;
    isopolygon g;
    double range = 0.0;
    if (!isopolygon_of(x, iso, &g))
        return f;
    if (find_across(x, &g, &n))
        for (int i = 0; i < 4; i++)
            range = most(range, fabs((double)x->f[i] - iso));
    f.slack = 8.0 * DBL_EPSILON * range;
    memcpy(f.at, g.p[0], sizeof f.at);
    memcpy(f.error, n.error, sizeof f.error);
    memcpy(f.point.gradient, n.direction, sizeof n.direction);
    normal_against(f.point.gradient, f.point.normal);
    return f;
}

/* Compute the difference of f from the isovalue at the ray's point, from a point that has the
 * isovalue. Its error: 11 halves of an epsilon of the coordinates, which are rounded, subtracted
 * and added up. */
surface_point tet_surface_at(const tet_facts *f, const ray *r, const hit *h) {
    surface_point point = f->point;
    double away[3], sum = f->slack;
    for (int k = 0; k < 3; k++) {
        const double along = h->t * r->d[k];
        const double far = most(fabs(r->o[k]) + fabs(along), fabs(f->at[k]));
        away[k] = r->o[k] + along - f->at[k];
        sum += fabs(point.gradient[k]) * 6.0 * DBL_EPSILON * far + f->error[k] * fabs(away[k]);
    }
    point.error = fabs(vec3_dot(point.gradient, away)) + sum;
    return point;
}

surface_point tet_surface(const tet *x, const ray *r, double iso, const hit *h) {
    const tet_facts f = tet_facts_of(x, iso);
    return tet_surface_at(&f, r, h);
}
