#include "render/mesh/tet_sight.h"

#include "formats/base/vec3.h"

/* A weight of more than this many times its bound is right to 2^-32 of itself. */
#define SURE 0x1p32

const tet_face tet_faces[TET_FACES] = {{{0, 1, 2}, {0, 1, 3}, 1},
                                       {{0, 1, 3}, {0, 2, 4}, -1},
                                       {{0, 2, 3}, {1, 2, 5}, 1},
                                       {{1, 2, 3}, {3, 4, 5}, -1}};

/* The edge between two vertices. */
static const uint8_t edge_between[4][4] = {{0, 0, 1, 2}, {0, 0, 3, 4}, {1, 3, 0, 5}, {2, 4, 5, 0}};

static double larger_than(double x) {
    return x + (fabs(x) + 1.0);
}

/* Returns a number with the sign that the edge function E has when the ray is moved along an axis.
 * E is linear in the ray's origin and 0 at the true origin, so any step gives the same sign. */
static double moved_edge(const ray *r, int axis, const double p[3], const double q[3]) {
    double o[3] = {r->o[0], r->o[1], r->o[2]};
    o[axis] = larger_than(o[axis]);
    return exact_edge(o, r->d, p, q).value;
}

static void find_side(tet_sight *s, int e) {
    const double *p = s->p[tet_edge_ends[e][0]], *q = s->p[tet_edge_ends[e][1]];
    const double along[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]};
    s->edge[e] = exact_near(s->r->d, s->a[tet_edge_ends[e][0]], along);
    if (!(fabs(s->edge[e].value) > s->edge[e].bound))
        s->edge[e] = exact_edge(s->r->o, s->r->d, p, q);
    double value = s->edge[e].value;
    for (int axis = 0; value == 0.0 && axis < 3; axis++)
        value = moved_edge(s->r, axis, p, q);
    s->side[e] = (value > 0.0) - (value < 0.0);
    s->tests++;
}

static int side_of(tet_sight *s, int e) {
    if (s->side[e] == TET_SIDE_UNKNOWN)
        find_side(s, e);
    return s->side[e];
}

static double weight_of(tet_sight *s, int e) {
    (void)side_of(s, e);
    if (fabs(s->edge[e].value) > SURE * s->edge[e].bound)
        return fabs(s->edge[e].value);
    const double *p = s->p[tet_edge_ends[e][0]], *q = s->p[tet_edge_ends[e][1]];
    return fabs(exact_edge(s->r->o, s->r->d, p, q).value);
}

static double kept_between(double x, double a, double b) {
    const double lo = a < b ? a : b, hi = a < b ? b : a;
    return x < lo ? lo : x > hi ? hi : x;
}

/* Mean of three numbers by weights, kept within their range. */
static double mean_of(const double w[3], double x0, double x1, double x2) {
    const double mean = x0 + (w[1] * (x1 - x0) + w[2] * (x2 - x0)) / (w[0] + (w[1] + w[2]));
    const double lo = x0 < x1 ? x0 : x1, hi = x0 < x1 ? x1 : x0;
    return kept_between(mean, lo < x2 ? lo : x2, hi < x2 ? x2 : hi);
}

static double t_of(const tet_sight *s, int v) {
    return vec3_dot(s->r->d, s->a[v]) / vec3_dot(s->r->d, s->r->d);
}

/* Find where the ray meets the edge i, j. Use the distances of its ends from the ray, in the
 * coordinate in which the edge looks longest. The distance of an end is E for the line along that
 * axis through the ray's origin. */
static void meet_edge(const tet_sight *s, int i, int j, double *t, double *f) {
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
    *f = mean_of(w, s->f[i], s->f[j], s->f[j]);
}

/* Find where the ray crosses a face. Two weights are 0 if it meets a vertex, one if it meets an
 * edge. */
void tet_sight_meet(tet_sight *s, int face, double *t, double *f) {
    const uint8_t *v = tet_faces[face].vertex, *e = tet_faces[face].edge;
    const double w[3] = {weight_of(s, e[2]), weight_of(s, e[1]), weight_of(s, e[0])};
    const int held = (w[0] > 0.0) | (w[1] > 0.0) << 1 | (w[2] > 0.0) << 2;
    if ((held & (held - 1)) == 0) {
        *t = t_of(s, v[held >> 1]);
        *f = s->f[v[held >> 1]];
    } else if (held != 7) {
        meet_edge(s, v[held == 6 ? 1 : 0], v[held == 3 ? 1 : 2], t, f);
    } else {
        *t = mean_of(w, t_of(s, v[0]), t_of(s, v[1]), t_of(s, v[2]));
        *f = mean_of(w, s->f[v[0]], s->f[v[1]], s->f[v[2]]);
    }
}

/* ---- A tet, and the next ---- */

static void put_vertex(tet_sight *s, int v, const tet *x) {
    for (int k = 0; k < 3; k++) {
        s->p[v][k] = (double)x->p[v][k];
        s->a[v][k] = s->p[v][k] - s->r->o[k];
    }
    s->f[v] = (double)x->f[v];
}

void tet_sight_begin(tet_sight *s, const tet *x, const ray *r) {
    s->r = r;
    for (int v = 0; v < 4; v++)
        put_vertex(s, v, x);
    for (int e = 0; e < TET_EDGES; e++)
        s->side[e] = TET_SIDE_UNKNOWN;
}

bool tet_sight_crosses(tet_sight *s, int face) {
    const uint8_t *e = tet_faces[face].edge;
    const int side = side_of(s, e[0]);
    return side != 0 && side_of(s, e[2]) == side && side_of(s, e[1]) == -side;
}

bool tet_sight_enters(const tet_sight *s, int face, int orientation) {
    return s->side[tet_faces[face].edge[0]] * tet_faces[face].inwards * orientation > 0;
}

/* Returns the side of the edge directed from one vertex to another, whichever has the lower id. */
static int side_towards(tet_sight *s, int from, int to) {
    const int side = side_of(s, edge_between[from][to]);
    return from < to ? side : -side;
}

/* Call the face `entered` 012, and the fourth vertex the top. The ray crosses 012, so it passes all
 * three edges of 012 on the same side. It also crosses the face of two of these vertices and the
 * top if it passes that face's edges on one side, too. An edge parallel to the ray has side 0: both
 * its faces are seen from the side. Then the top is seen at a vertex of 012, and the other sides
 * still decide. */
int tet_sight_leaves_by(tet_sight *s, int entered) {
    const uint8_t *v = tet_faces[entered].vertex;
    const int top = 3 - entered, turn = s->side[tet_faces[entered].edge[0]];
    const int first = side_towards(s, v[0], top), second = side_towards(s, v[1], top);
    if (first == -turn && second == turn)
        return 3 - v[2];
    if (first == -turn && second == -turn)
        return 3 - v[0];
    if (first == turn && second == turn)
        return 3 - v[1];
    return side_towards(s, v[2], top) == turn ? 3 - v[0] : 3 - v[1];
}

void tet_sight_go(tet_sight *s, int left, const tet *x, int entered) {
    const tet_face *from = &tet_faces[left], *to = &tet_faces[entered];
    const tet_sight old = *s;
    for (int e = 0; e < TET_EDGES; e++)
        s->side[e] = TET_SIDE_UNKNOWN;
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            s->p[to->vertex[i]][k] = old.p[from->vertex[i]][k];
            s->a[to->vertex[i]][k] = old.a[from->vertex[i]][k];
        }
        s->f[to->vertex[i]] = old.f[from->vertex[i]];
        s->edge[to->edge[i]] = old.edge[from->edge[i]];
        s->side[to->edge[i]] = old.side[from->edge[i]];
    }
    put_vertex(s, 3 - entered, x);
}
