#include "render/mesh/tet_segment.h"

#include "formats/base/exact.h"
#include "formats/base/vec3.h"

/* A weight of more than this many bounds is right to 2^-32 of itself. */
#define SURE 0x1p32

/* A tet as a ray sees it. */
typedef struct seen_tet {
    const tet *x;
    const ray *r;
    double p[4][3], a[4][3];        /* its vertices; relative to the ray's origin */
    exact_estimate edge[TET_EDGES]; /* the edge functions, from the lower id to the higher; */
    int side[TET_EDGES];            /* their signs, of the ray moved */
} seen_tet;

/* Faces by their vertices, then their edges 01, 02 and 12, as numbered in tet_kernel.h; whether
 * the fourth vertex lies along the face's normal where the tet is positively oriented. */
static const struct {
    uint8_t vertex[3], edge[3];
    int8_t inwards;
} faces[4] = {{{0, 1, 2}, {0, 1, 3}, 1},
              {{0, 1, 3}, {0, 2, 4}, -1},
              {{0, 2, 3}, {1, 2, 5}, 1},
              {{1, 2, 3}, {3, 4, 5}, -1}};

static double larger_than(double x) {
    return x + (fabs(x) + 1.0);
}

/* E of the ray moved along an axis by any step: as E is linear in its origin and vanishes there,
 * the sign of its change. */
static double moved_edge(const ray *r, int axis, const double p[3], const double q[3]) {
    double o[3] = {r->o[0], r->o[1], r->o[2]};
    o[axis] = larger_than(o[axis]);
    return exact_edge(o, r->d, p, q).value;
}

static void find_side(seen_tet *s, int e) {
    const double *p = s->p[tet_edge_ends[e][0]], *q = s->p[tet_edge_ends[e][1]];
    const double along[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]};
    s->edge[e] = exact_near(s->r->d, s->a[tet_edge_ends[e][0]], along);
    if (!(fabs(s->edge[e].value) > s->edge[e].bound))
        s->edge[e] = exact_edge(s->r->o, s->r->d, p, q);
    double value = s->edge[e].value;
    for (int axis = 0; value == 0.0 && axis < 3; axis++)
        value = moved_edge(s->r, axis, p, q);
    s->side[e] = (value > 0.0) - (value < 0.0);
}

static double weight_of(const seen_tet *s, int e) {
    if (fabs(s->edge[e].value) > SURE * s->edge[e].bound)
        return fabs(s->edge[e].value);
    const double *p = s->p[tet_edge_ends[e][0]], *q = s->p[tet_edge_ends[e][1]];
    return fabs(exact_edge(s->r->o, s->r->d, p, q).value);
}

static double kept_between(double x, double a, double b) {
    const double lo = a < b ? a : b, hi = a < b ? b : a;
    return x < lo ? lo : x > hi ? hi : x;
}

/* Three points' mean by weights, never beyond them. */
static double mean_of(const double w[3], double x0, double x1, double x2) {
    const double mean = x0 + (w[1] * (x1 - x0) + w[2] * (x2 - x0)) / (w[0] + (w[1] + w[2]));
    const double lo = x0 < x1 ? x0 : x1, hi = x0 < x1 ? x1 : x0;
    return kept_between(mean, lo < x2 ? lo : x2, hi < x2 ? x2 : hi);
}

static double t_of(const seen_tet *s, int v) {
    return vec3_dot(s->r->d, s->a[v]) / vec3_dot(s->r->d, s->r->d);
}

/* Where the ray meets the edge i, j: by how far off the ray its ends lie, in that coordinate where
 * the edge is seen longest. It is E of the line from the ray's origin along that axis. */
static void meet_edge(const seen_tet *s, int i, int j, double *t, double *f) {
    const double *p = s->p[i], *q = s->p[j];
    const double along[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]};
    double seen[3], other[3] = {s->r->o[0], s->r->o[1], s->r->o[2]};
    vec3_cross(s->r->d, along, seen);
    int c = fabs(seen[1]) > fabs(seen[0]) ? 1 : 0;
    c = fabs(seen[2]) > fabs(seen[c]) ? 2 : c;
    other[c] = larger_than(other[c]);
    const double w[3] = {fabs(exact_edge(s->r->o, s->r->d, q, other).value),
                         fabs(exact_edge(s->r->o, s->r->d, p, other).value), 0.0};
    const double ti = t_of(s, i), tj = t_of(s, j);
    *t = mean_of(w, ti, tj, tj);
    *f = mean_of(w, (double)s->x->f[i], (double)s->x->f[j], (double)s->x->f[j]);
}

/* Where the ray crosses a face. Two weights vanish where it meets a vertex, one on an edge. */
static void meet_face(const seen_tet *s, int face, double *t, double *f) {
    const uint8_t *v = faces[face].vertex, *e = faces[face].edge;
    const double w[3] = {weight_of(s, e[2]), weight_of(s, e[1]), weight_of(s, e[0])};
    const int held = (w[0] > 0.0) | (w[1] > 0.0) << 1 | (w[2] > 0.0) << 2;
    if ((held & (held - 1)) == 0) {
        *t = t_of(s, v[held >> 1]);
        *f = (double)s->x->f[v[held >> 1]];
    } else if (held != 7) {
        meet_edge(s, v[held == 6 ? 1 : 0], v[held == 3 ? 1 : 2], t, f);
    } else {
        *t = mean_of(w, t_of(s, v[0]), t_of(s, v[1]), t_of(s, v[2]));
        *f = mean_of(w, (double)s->x->f[v[0]], (double)s->x->f[v[1]], (double)s->x->f[v[2]]);
    }
}

static void see_tet(seen_tet *s, const tet *x, const ray *r) {
    s->x = x;
    s->r = r;
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++) {
            s->p[i][k] = (double)x->p[i][k];
            s->a[i][k] = s->p[i][k] - r->o[k];
        }
    for (int e = 0; e < TET_EDGES; e++)
        find_side(s, e);
}

bool tet_segment(const tet *x, const ray *r, tet_piece *out) {
    seen_tet s;
    int crossed[2], count = 0;
    see_tet(&s, x, r);
    for (int i = 0; i < 4 && count < 2; i++) {
        const uint8_t *e = faces[i].edge;
        const int side = s.side[e[0]];
        if (side != 0 && s.side[e[2]] == side && s.side[e[1]] == -side)
            crossed[count++] = i;
    }
    const int orientation = count == 2 ? exact_orientation((const double(*)[3])s.p) : 0;
    if (orientation == 0)
        return false;
    const int first = crossed[0];
    const bool enters = s.side[faces[first].edge[0]] * faces[first].inwards * orientation > 0;
    meet_face(&s, first, &out->t[!enters], &out->f[!enters]);
    meet_face(&s, crossed[1], &out->t[enters], &out->f[enters]);
    return true;
}
