#include "render/flat/flat_polygon.h"

#include <math.h>

#include "formats/base/exact.h"
#include "formats/base/vec3.h"

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

/* A polygon, with its points relative to a ray's origin. */
typedef struct seen_polygon {
    const flat_polygon *g;
    const ray *r;
    double a[4][3];
} seen_polygon;

/* Where the ray's line crosses a triangle. */
typedef struct crossing {
    double t;
    bool entering; /* along the polygon's normal */
} crossing;

static void see_polygon(const flat_polygon *g, const ray *r, seen_polygon *s) {
    s->g = g;
    s->r = r;
    for (int i = 0; i < g->count; i++)
        for (int k = 0; k < 3; k++)
            s->a[i][k] = g->p[i][k] - r->o[k];
}

/* Returns the edge function of points i -> j of the polygon. It is always computed from the lower
 * rank to the higher, as for the polygon beyond the edge. */
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

/* Symmetric in points 1 and 2 to the bit. */
static void cross_inside(const seen_polygon *s, const uint8_t c[3], const exact_estimate w[3],
                         crossing *out) {
    const double t0 = along_of(s, c[0]), t1 = along_of(s, c[1]), t2 = along_of(s, c[2]);
    const double w0 = fabs(w[0].value), w1 = fabs(w[1].value), w2 = fabs(w[2].value);
    const double sum = w0 + (w1 + w2), lo = least(t0, least(t1, t2)), hi = most(t0, most(t1, t2));
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

bool flat_polygon_hit(const flat_polygon *g, const ray *r, uint64_t cell, int32_t iso_index,
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

bool flat_polygon_next(const flat_polygon *g, const ray *r, uint64_t cell, int32_t iso_index,
                       const hit *after, hit *found) {
    hit last = {after->t, 0, -1, false};
    const hit behind = {after->t, UINT64_MAX, after->iso, after->entering};
    while (flat_polygon_hit(g, r, cell, iso_index, &last, found)) {
        if (flat_polygon_less(&behind, found))
            return true;
        last = *found;
    }
    return false;
}
