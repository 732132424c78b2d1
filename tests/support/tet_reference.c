/* tet_reference.c - brute force: every tetrahedron near the ray by itself.
 *
 * On which side of an edge PQ the ray passes is the sign of d . ((P - o) x (Q - o)), always taken
 * from the lower vertex id to the higher: in long double where its error bound allows, else summed
 * exactly. A zero is decided by moving the ray by e, e^2, e^3 along the axes, of which that
 * determinant is a linear function (simulation of simplicity). A face is crossed when the ray
 * passes its three edges on the same side; the three determinants are then also the weights of its
 * vertices.
 */
#include "tests/support/tet_reference.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/exact_sum.h"

typedef long double real;

enum { LEAF_TETS = 4, NO_CHILD = 0 };

/* long double determinants hold their sign, or 44 bits, above these shares of the sum of their
 * terms' sizes; all bits above none. */
static const real SIGN_HOLDS = 0x1p-58L, VALUE_HOLDS = 0x1p-16L, NONE_HOLDS = 2;

/* A value this much smaller than the terms it is summed from is 0: rays that meet an edge exactly
 * where f = iso see the same side on all faces around it. */
static const real VANISHES = 0x1p-40L;

/* Boxes are grown by this share of their longest side, for rays moved by 1e-6 of an edge. */
static const double GROWN = 4e-6;

/* A subtree: its boxes and range of values. Children lie side by side from `child` on. */
typedef struct node {
    float lo[3], hi[3];
    float least, most;
    size_t first, count; /* of the order */
    size_t child;        /* NO_CHILD: a leaf */
} node;

struct tet_ref {
    tet_ref_mesh m;
    size_t *order; /* tets that may hold a surface */
    size_t order_count;
    node *nodes;
    size_t node_count;
};

/* A ray, and what is asked of it. */
typedef struct query {
    const tet_ref_mesh *m;
    real o[3], d[3];
    double o_high[3], o_low[3]; /* their sum is o */
    real dd;
    real holds; /* VALUE_HOLDS or NONE_HOLDS */
    real t0, t1;
    const double *isos;
    int iso_count;
    ref_hit *hits; /* sorted, the first `capacity` of those found */
    size_t capacity, found;
    double nearby;
} query;

/* ---- edges ---- */

/* d . ((P - o) x (Q - o)), every term of it. */
static real exact_edge(const query *q, const float *P, const float *Q) {
    exact_sum s;
    exact_sum_clear(&s);
    for (int a = 0; a < 3; a++) {
        int b = (a + 1) % 3, c = (a + 2) % 3;
        double d = (double)q->d[a];
        exact_sum_add(&s, d, P[b], Q[c]);
        exact_sum_add(&s, -d, P[c], Q[b]);
        for (int part = 0; part < 2; part++) {
            const double *o = part == 0 ? q->o_high : q->o_low;
            exact_sum_add(&s, -d, P[b], o[c]);
            exact_sum_add(&s, d, P[c], o[b]);
            exact_sum_add(&s, -d, o[b], Q[c]);
            exact_sum_add(&s, d, o[c], Q[b]);
        }
    }
    return exact_sum_value(&s);
}

/* The same, in long double where its error is below the share that `holds` allows. */
static real edge(const query *q, const float *P, const float *Q, real holds) {
    real p[3], e[3], sum = 0, size = 0;
    for (int a = 0; a < 3; a++) {
        p[a] = (real)P[a] - q->o[a];
        e[a] = (real)Q[a] - P[a];
    }
    for (int a = 0; a < 3; a++) {
        int b = (a + 1) % 3, c = (a + 2) % 3;
        real u = p[b] * e[c], v = p[c] * e[b];
        sum += q->d[a] * (u - v);
        size += fabsl(q->d[a]) * (fabsl(u) + fabsl(v));
    }
    return fabsl(sum) > holds * size ? sum : exact_edge(q, P, Q);
}

/* How the determinant of PQ grows when o moves along an axis. */
static real edge_slope(const query *q, const float *P, const float *Q, int axis) {
    int b = (axis + 1) % 3, c = (axis + 2) % 3;
    double db = (double)q->d[b], dc = (double)q->d[c];
    exact_sum s;
    exact_sum_clear(&s);
    exact_sum_add(&s, dc, P[b], 1);
    exact_sum_add(&s, -dc, Q[b], 1);
    exact_sum_add(&s, -db, P[c], 1);
    exact_sum_add(&s, db, Q[c], 1);
    return exact_sum_value(&s);
}

/* +1 or -1; 0 only where the edge points along the ray, or has no length. */
static int edge_side(const query *q, const float *P, const float *Q) {
    real value = edge(q, P, Q, SIGN_HOLDS);
    for (int axis = 0; value == 0 && axis < 3; axis++)
        value = edge_slope(q, P, Q, axis);
    return (value > 0) - (value < 0);
}

static void sort_ids(uint32_t *v, int count) {
    for (int i = 1; i < count; i++)
        for (int k = i; k > 0 && v[k] < v[k - 1]; k--) {
            uint32_t swap = v[k];
            v[k] = v[k - 1];
            v[k - 1] = swap;
        }
}

/* ---- faces ---- */

/* Where the ray crosses a face: its t, its vertices (ascending) and their weights. */
typedef struct crossing {
    real t;
    uint32_t vertex[3];
    real weight[3];
} crossing;

static void cross_face(const query *q, const uint32_t v[3], crossing *x) {
    const float *A = q->m->points[v[0]], *B = q->m->points[v[1]], *C = q->m->points[v[2]];
    const real weight[3] = {fabsl(edge(q, B, C, q->holds)), fabsl(edge(q, A, C, q->holds)),
                            fabsl(edge(q, A, B, q->holds))};
    const real sum = weight[0] + weight[1] + weight[2];
    x->t = 0;
    for (int i = 0; i < 3; i++) {
        const float *P = q->m->points[v[i]];
        real along = 0;
        for (int a = 0; a < 3; a++)
            along += ((real)P[a] - q->o[a]) * q->d[a];
        x->vertex[i] = v[i];
        x->weight[i] = weight[i] / sum;
        x->t += x->weight[i] * (along / q->dd);
    }
}

/* f - iso there. */
static real crossing_value(const query *q, const crossing *x, double iso) {
    real value = 0, size = 0;
    for (int i = 0; i < 3; i++) {
        real term = x->weight[i] * ((real)q->m->values[x->vertex[i]] - iso);
        value += term;
        size += fabsl(term);
    }
    return fabsl(value) <= VANISHES * size ? 0 : value;
}

/* The two faces of a tetrahedron that the ray crosses, in order. */
static bool cross_tet(const query *q, const uint32_t ids[4], crossing x[2]) {
    static const int faces[4][3] = {{0, 1, 2}, {0, 1, 3}, {0, 2, 3}, {1, 2, 3}};
    uint32_t v[4];
    int side[4][4], count = 0;
    memcpy(v, ids, sizeof v);
    sort_ids(v, 4);
    for (int i = 0; i < 4; i++)
        for (int k = i + 1; k < 4; k++)
            side[i][k] = edge_side(q, q->m->points[v[i]], q->m->points[v[k]]);
    for (int n = 0; n < 4 && count < 2; n++) {
        const int *f = faces[n], s = side[f[0]][f[1]];
        const uint32_t face[3] = {v[f[0]], v[f[1]], v[f[2]]};
        if (s != 0 && side[f[1]][f[2]] == s && side[f[0]][f[2]] == -s)
            cross_face(q, face, &x[count++]);
    }
    if (count == 2 && x[1].t < x[0].t) {
        crossing swap = x[0];
        x[0] = x[1];
        x[1] = swap;
    }
    return count == 2;
}

double tet_ref_local_edge(const tet_ref_mesh *m, size_t tet) {
    double length[6];
    int count = 0;
    for (int i = 0; i < 4; i++)
        for (int k = i + 1; k < 4; k++) {
            const float *P = m->points[m->tets[tet][i]], *Q = m->points[m->tets[tet][k]];
            double l = hypot(hypot((double)Q[0] - P[0], (double)Q[1] - P[1]), (double)Q[2] - P[2]);
            int at = count++;
            for (; at > 0 && length[at - 1] > l; at--)
                length[at] = length[at - 1];
            length[at] = l;
        }
    return length[2];
}

/* ---- one tetrahedron ---- */

static bool same_tet(const query *q, int64_t a, int64_t b) {
    uint32_t v[4], w[4];
    memcpy(v, q->m->tets[a], sizeof v);
    memcpy(w, q->m->tets[b], sizeof w);
    sort_ids(v, 4);
    sort_ids(w, 4);
    return memcmp(v, w, sizeof v) == 0;
}

static bool comes_before(const ref_hit *a, const ref_hit *b) {
    if (a->t != b->t)
        return a->t < b->t;
    if (a->cell != b->cell)
        return a->cell < b->cell;
    return a->iso < b->iso;
}

/* Keep the hit at its place in the list, unless its tetrahedron is there under another number. */
static void keep(query *q, const ref_hit *hit) {
    size_t n = q->found < q->capacity ? q->found : q->capacity;
    for (size_t i = 0; i < n; i++)
        if (q->hits[i].t == hit->t && q->hits[i].iso == hit->iso &&
            same_tet(q, q->hits[i].cell, hit->cell)) {
            q->hits[i].cell = hit->cell < q->hits[i].cell ? hit->cell : q->hits[i].cell;
            return;
        }
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

/* The surface of one isovalue between two crossings, as far as [t0, t1] reaches. */
static void find_surface(query *q, const crossing x[2], size_t tet, int iso) {
    real g[2], t[2];
    for (int i = 0; i < 2; i++) {
        g[i] = crossing_value(q, &x[i], q->isos[iso]);
        t[i] = x[i].t;
    }
    const real slope = t[1] > t[0] ? (g[1] - g[0]) / (t[1] - t[0]) : 0;
    if (t[0] < q->t0) {
        g[0] = t[1] > q->t0 ? g[0] + (q->t0 - t[0]) * slope : g[1];
        t[0] = q->t0;
    }
    if (t[1] > q->t1) {
        g[1] = t[0] < q->t1 ? g[1] + (q->t1 - t[1]) * slope : g[0];
        t[1] = q->t1;
    }
    if ((g[0] >= 0) == (g[1] >= 0))
        return;
    ref_hit hit = {.cell = (int64_t)tet, .iso = iso, .from_inside = g[0] >= 0};
    hit.t_exact = t[0] + (t[1] - t[0]) * (g[0] / (g[0] - g[1]));
    hit.t = (double)hit.t_exact;
    hit.cells_per_t = (double)sqrtl(q->dd) / tet_ref_local_edge(q->m, tet);
    keep(q, &hit);
}

static void value_range(const tet_ref_mesh *m, size_t tet, float *least, float *most) {
    *least = INFINITY;
    *most = -INFINITY;
    for (int i = 0; i < 4; i++) {
        float f = m->values[m->tets[tet][i]];
        *least = f < *least ? f : *least;
        *most = f > *most ? f : *most;
    }
}

static bool is_active(float least, float most, double iso) {
    return (double)least < iso && (double)most >= iso;
}

static void visit_tet(query *q, size_t tet) {
    float least, most;
    crossing x[2];
    bool active = false;
    value_range(q->m, tet, &least, &most);
    for (int i = 0; i < q->iso_count; i++)
        active |= is_active(least, most, q->isos[i]);
    if (!active)
        return;
    q->nearby = fmax(q->nearby, tet_ref_local_edge(q->m, tet));
    if (!cross_tet(q, q->m->tets[tet], x) || x[1].t < q->t0 || x[0].t > q->t1)
        return;
    for (int i = 0; i < q->iso_count; i++)
        if (is_active(least, most, q->isos[i]))
            find_surface(q, x, tet, i);
}

/* ---- the tree ---- */

/* Whether the ray may pass through the box, a little grown. */
static bool meets_box(const query *q, const node *n) {
    double side = 0;
    for (int a = 0; a < 3; a++)
        side = fmax(side, (double)n->hi[a] - n->lo[a]);
    real t0 = q->t0, t1 = q->t1;
    for (int a = 0; a < 3; a++) {
        real far = fabsl(q->o[a]) + fabsl((real)n->lo[a]) + fabsl((real)n->hi[a]);
        real grown = GROWN * side + 1e-15L * far;
        real lo = n->lo[a] - grown - q->o[a], hi = n->hi[a] + grown - q->o[a];
        if (q->d[a] == 0) {
            if (lo > 0 || hi < 0)
                return false;
            continue;
        }
        real u = lo / q->d[a], v = hi / q->d[a];
        t0 = fmaxl(t0, fminl(u, v));
        t1 = fminl(t1, fmaxl(u, v));
    }
    return t0 <= t1;
}

static void visit_node(query *q, const tet_ref *r, const node *n) {
    bool active = false;
    for (int i = 0; i < q->iso_count; i++)
        active |= is_active(n->least, n->most, q->isos[i]);
    if (!active || !meets_box(q, n))
        return;
    if (n->child != NO_CHILD) {
        visit_node(q, r, &r->nodes[n->child]);
        visit_node(q, r, &r->nodes[n->child + 1]);
        return;
    }
    for (size_t i = 0; i < n->count; i++)
        visit_tet(q, r->order[n->first + i]);
}

static float centre(const tet_ref *r, size_t tet, int axis) {
    float sum = 0;
    for (int i = 0; i < 4; i++)
        sum += r->m.points[r->m.tets[tet][i]][axis] / 4;
    return sum;
}

/* Order `count` tets so that the first half has the lower centres. */
static void split_at_median(const tet_ref *r, size_t *order, size_t count, int axis) {
    size_t lo = 0, hi = count - 1, middle = count / 2;
    while (lo < hi) {
        float pivot = centre(r, order[lo + (hi - lo) / 2], axis);
        size_t i = lo, k = hi;
        for (;;) {
            while (centre(r, order[i], axis) < pivot)
                i++;
            while (centre(r, order[k], axis) > pivot)
                k--;
            if (i >= k)
                break;
            size_t swap = order[i];
            order[i++] = order[k];
            order[k--] = swap;
        }
        if (middle <= k)
            hi = k;
        else
            lo = k + 1;
    }
}

static void measure(const tet_ref *r, node *n) {
    for (int a = 0; a < 3; a++) {
        n->lo[a] = INFINITY;
        n->hi[a] = -INFINITY;
    }
    n->least = INFINITY;
    n->most = -INFINITY;
    for (size_t i = 0; i < n->count; i++) {
        size_t tet = r->order[n->first + i];
        float least, most;
        value_range(&r->m, tet, &least, &most);
        n->least = fminf(n->least, least);
        n->most = fmaxf(n->most, most);
        for (int k = 0; k < 4; k++)
            for (int a = 0; a < 3; a++) {
                float x = r->m.points[r->m.tets[tet][k]][a];
                n->lo[a] = fminf(n->lo[a], x);
                n->hi[a] = fmaxf(n->hi[a], x);
            }
    }
}

static void build(tet_ref *r, size_t at) {
    node *n = &r->nodes[at];
    measure(r, n);
    if (n->count <= LEAF_TETS)
        return;
    int longest = 0;
    for (int a = 1; a < 3; a++)
        if (n->hi[a] - n->lo[a] > n->hi[longest] - n->lo[longest])
            longest = a;
    split_at_median(r, r->order + n->first, n->count, longest);
    n->child = r->node_count;
    r->node_count += 2;
    size_t half = n->count / 2;
    r->nodes[n->child] = (node){.first = n->first, .count = half};
    r->nodes[n->child + 1] = (node){.first = n->first + half, .count = n->count - half};
    build(r, n->child);
    build(r, n->child + 1);
}

/* ---- asking ---- */

static bool is_sound(const tet_ref_mesh *m, const uint32_t ids[4]) {
    for (int i = 0; i < 4; i++) {
        if (ids[i] >= m->point_count || !isfinite(m->values[ids[i]]))
            return false;
        for (int a = 0; a < 3; a++)
            if (!isfinite(m->points[ids[i]][a]))
                return false;
        for (int k = 0; k < i; k++)
            if (ids[i] == ids[k])
                return false;
    }
    return true;
}

tet_ref *tet_ref_create(const tet_ref_mesh *m) {
    tet_ref *r = calloc(1, sizeof *r);
    if (!r)
        return NULL;
    r->m = *m;
    r->order = malloc((m->tet_count + 1) * sizeof *r->order);
    r->nodes = malloc((m->tet_count + 1) * sizeof *r->nodes);
    if (!r->order || !r->nodes) {
        tet_ref_destroy(r);
        return NULL;
    }
    for (size_t i = 0; i < m->tet_count; i++)
        if (is_sound(m, m->tets[i]))
            r->order[r->order_count++] = i;
    r->nodes[0] = (node){.count = r->order_count};
    r->node_count = 1;
    build(r, 0);
    return r;
}

void tet_ref_destroy(tet_ref *r) {
    if (!r)
        return;
    free(r->order);
    free(r->nodes);
    free(r);
}

const tet_ref_mesh *tet_ref_raw(const tet_ref *r) {
    return &r->m;
}

static query query_of(const tet_ref_mesh *m, const ref_ray *ray, const long double shift[3]) {
    query q = {.m = m, .holds = VALUE_HOLDS, .t0 = -INFINITY, .t1 = INFINITY};
    for (int a = 0; a < 3; a++) {
        q.d[a] = ray->d[a];
        q.dd += q.d[a] * q.d[a];
        q.o[a] = (real)ray->o[a] + (shift ? shift[a] : 0);
        q.o_high[a] = (double)q.o[a];
        q.o_low[a] = (double)(q.o[a] - q.o_high[a]);
    }
    return q;
}

size_t tet_ref_trace_shifted(const tet_ref *r, const ref_ray *ray, const long double shift[3],
                             const double *isos, int iso_count, const ref_clip *clip, ref_hit *hits,
                             size_t capacity) {
    query q = query_of(&r->m, ray, shift);
    q.isos = isos;
    q.iso_count = iso_count;
    q.hits = hits;
    q.capacity = capacity;
    ref_clip_interval(clip, ray, &q.t0, &q.t1);
    if (q.t0 <= q.t1)
        visit_node(&q, r, &r->nodes[0]);
    return q.found;
}

size_t tet_ref_trace(const tet_ref *r, const ref_ray *ray, const double *isos, int iso_count,
                     const ref_clip *clip, ref_hit *hits, size_t capacity) {
    return tet_ref_trace_shifted(r, ray, NULL, isos, iso_count, clip, hits, capacity);
}

double tet_ref_nearby(const tet_ref *r, const ref_ray *ray, const double *isos, int iso_count,
                      const ref_clip *clip) {
    query q = query_of(&r->m, ray, NULL);
    q.isos = isos;
    q.iso_count = iso_count;
    ref_clip_interval(clip, ray, &q.t0, &q.t1);
    if (q.t0 <= q.t1)
        visit_node(&q, r, &r->nodes[0]);
    return q.nearby;
}

bool tet_ref_crossings(const tet_ref_mesh *m, size_t tet, const ref_ray *ray, long double t[2],
                       long double value[2]) {
    query q = query_of(m, ray, NULL);
    crossing x[2];
    if (!is_sound(m, m->tets[tet]) || !cross_tet(&q, m->tets[tet], x))
        return false;
    for (int i = 0; i < 2; i++) {
        t[i] = x[i].t;
        value[i] = crossing_value(&q, &x[i], 0);
    }
    return true;
}

bool tet_ref_exact_crossings(const tet_ref_mesh *m, size_t tet, const ref_ray *ray,
                             long double t[2], long double value[2]) {
    query q = query_of(m, ray, NULL);
    crossing x[2];
    q.holds = NONE_HOLDS;
    if (!is_sound(m, m->tets[tet]) || !cross_tet(&q, m->tets[tet], x))
        return false;
    for (int i = 0; i < 2; i++) {
        /* About one vertex: a constant stays what it is. */
        const real first = m->values[x[i].vertex[0]];
        t[i] = x[i].t;
        value[i] = first;
        for (int k = 1; k < 3; k++)
            value[i] += x[i].weight[k] * ((real)m->values[x[i].vertex[k]] - first);
    }
    return true;
}
