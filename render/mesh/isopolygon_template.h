/* isopolygon_template.h - tests of isopolygons against vectors of rays; included by the units of an
 * ISA (see formats/base/simd.h).
 *
 * Sums and products are the same as in exact_near() and flat_polygon_hit(), in the same order, so
 * results agree to the bit. Terms that all rays of one origin share are computed once per edge.
 */
#ifndef RENDER_MESH_ISOPOLYGON_TEMPLATE_H
#define RENDER_MESH_ISOPOLYGON_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include <string.h>

#include "formats/base/exact.h"
#include "render/mesh/tet_kernel.h"

/* Edges by their points: first those of triangle 0 1 2, last those of 0 2 3. */
enum { EDGE_12, EDGE_20, EDGE_01, EDGE_23, EDGE_30, EDGES };

typedef struct seen_edge {
    vd normal[3]; /* a x e */
    vd terms[3];  /* the sum of the moduli of its two products */
} seen_edge;

/* A vertex with its position and its value; or any four doubles. */
typedef double point4 __attribute__((vector_size(32)));
typedef int64_t mask4 __attribute__((vector_size(32)));

/* Finds the sign of exact_orientation(), from e[i] = vertex i + 1 less vertex 0. Returns whether it
 * is sure. */
SIMD bool surely_oriented(const point4 e[3], bool *negative) {
    const point4 yzx2 = __builtin_shufflevector(e[2], e[2], 1, 2, 0, 3),
                 zxy2 = __builtin_shufflevector(e[2], e[2], 2, 0, 1, 3);
    const point4 yzx1 = __builtin_shufflevector(e[1], e[1], 1, 2, 0, 3),
                 zxy1 = __builtin_shufflevector(e[1], e[1], 2, 0, 1, 3);
    const point4 up = yzx1 * zxy2, down = zxy1 * yzx2;
    const point4 value = e[0] * (up - down);
    const mask4 modulus = {INT64_MAX, INT64_MAX, INT64_MAX, INT64_MAX};
    const point4 terms = (point4)((mask4)e[0] & modulus) *
                         ((point4)((mask4)up & modulus) + (point4)((mask4)down & modulus));
    const double sum = value[0] + value[1] + value[2];
    *negative = sum < 0.0;
    return fabs(sum) > 2.0 * (EXACT_BOUND * (terms[0] + terms[1] + terms[2]) + EXACT_SMALLEST);
}

typedef struct near_tet {
    point4 v[4];
} near_tet;

SIMD near_tet near_tet_of(const tet *x) {
    near_tet near;
    for (int k = 0; k < 4; k++)
        near.v[k] = (point4){x->p[k][0], x->p[k][1], x->p[k][2], x->f[k]};
    return near;
}

/* A position, and 0. */
SIMD point4 point4_of_triple(const float at[3]) {
    typedef float floats4 __attribute__((vector_size(16)));
    return __builtin_convertvector((floats4){at[0], at[1], at[2]}, point4);
}

typedef enum polygon_certainty { NO_POLYGON, SURE_POLYGON, DOUBTFUL_POLYGON } polygon_certainty;

/* isopolygon_of(), with all coordinates of a vertex in a vector. The result is the same, to the
 * bit, or DOUBTFUL_POLYGON. */
SIMD polygon_certainty isopolygon_near(const near_tet *x, double iso, isopolygon *out) {
    const point4 *v = x->v;
    point4 e[3];
    unsigned inside = 0;
    double sum = 0.0;
    for (int k = 0; k < 4; k++) {
        inside |= (unsigned)(v[k][3] >= iso) << k;
        sum += v[k][3];
    }
    const tet_cut *cut = &tet_cuts[inside];
    if (cut->count == 0 || !isfinite(sum))
        return NO_POLYGON;
    for (int k = 0; k < 3; k++)
        e[k] = v[k + 1] - v[0];
    const uint8_t *ends[4];
    point4 from, to;
    bool negative;
    if (!surely_oriented(e, &negative))
        return DOUBTFUL_POLYGON;
    memcpy(out->edge, cut->edge, sizeof out->edge);
    out->count = cut->count;
    if (negative)
        tet_turn_over(out->edge, out->count);
    for (int k = 0; k < 4; k++) {
        ends[k] = tet_edge_ends[out->edge[k]];
        from[k] = v[ends[k][0]][3];
        to[k] = v[ends[k][1]][3];
    }
    const point4 s = (iso - from) / (to - from);
    for (int k = 0; k < 4; k++) {
        const point4 a = v[ends[k][0]], b = v[ends[k][1]], at = a + s[k] * (b - a);
        memcpy(out->p[k], s[k] >= 1.0 ? &b : &at, sizeof out->p[k]);
    }
    return SURE_POLYGON;
}

/* A polygon, prepared for rays from these origins. */
typedef struct seen {
    vd a[4][3];
    seen_edge edge[EDGES];
} seen;

typedef struct weights {
    vd modulus;
    md above, below; /* where this is sure */
} weights;

/* Prepare an edge e that begins at `from`. */
SIMD void see_line(const vd from[3], const vd e[3], seen_edge *out) {
    for (int k = 0; k < 3; k++) {
        const int l = (k + 1) % 3, m = (k + 2) % 3;
        const vd up = from[l] * e[m], down = from[m] * e[l];
        out->normal[k] = up - down;
        out->terms[k] = d_abs(up) + d_abs(down);
    }
}

/* Prepare the edge function, from the point on the lower tet edge. Reversing the edge only changes
 * its sign, to the bit. */
SIMD void see_edge(const isopolygon *g, int i, int j, const vd a[4][3], seen_edge *out) {
    vd e[3];
    for (int k = 0; k < 3; k++)
        e[k] = d_set(g->p[j][k]) - d_set(g->p[i][k]);
    see_line(a[g->edge[i] > g->edge[j] ? j : i], e, out);
}

SIMD void see(const isopolygon *g, const vd o[3], seen *out) {
    for (int i = 0; i < g->count; i++)
        for (int k = 0; k < 3; k++)
            out->a[i][k] = d_set(g->p[i][k]) - o[k];
    see_edge(g, 1, 2, out->a, &out->edge[EDGE_12]);
    see_edge(g, 2, 0, out->a, &out->edge[EDGE_20]);
    see_edge(g, 0, 1, out->a, &out->edge[EDGE_01]);
    if (g->count < 4)
        return;
    see_edge(g, 2, 3, out->a, &out->edge[EDGE_23]);
    see_edge(g, 3, 0, out->a, &out->edge[EDGE_30]);
}

SIMD vd dot(const vd a[3], const vd b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Returns the error bound of exact_near() for rays; moduli: of their directions, or more. */
SIMD vd error_of(const vd moduli[3], const seen_edge *e) {
    return d_set(EXACT_BOUND) * dot(moduli, e->terms) + d_set(EXACT_SMALLEST);
}

/* Vector form of exact_near(). error: at least error_of(). A larger error only leaves more lanes in
 * doubt; other lanes do not change. */
SIMD weights weigh(const vd d[3], const vd normal[3], vd error) {
    const vd value = dot(d, normal);
    return (weights){d_abs(value), d_gt(value, error), d_lt(value, d_set(0.0) - error)};
}

SIMD weights against(weights w) {
    return (weights){w.modulus, w.below, w.above};
}

/* Which rays certainly hit a triangle, by direction. doubtful: neither a hit nor a miss is certain.
 */
typedef struct verdict {
    md enters, leaves, doubtful;
} verdict;

SIMD verdict judge(weights w0, weights w1, weights w2) {
    const md above = md_or(w0.above, md_or(w1.above, w2.above));
    const md below = md_or(w0.below, md_or(w1.below, w2.below));
    const md all = md_of_bits((1u << VD_N) - 1);
    verdict v;
    v.enters = md_and(w0.above, md_and(w1.above, w2.above));
    v.leaves = md_and(w0.below, md_and(w1.below, w2.below));
    v.doubtful = md_and_not(md_and_not(all, md_and(above, below)), md_or(v.enters, v.leaves));
    return v;
}

/* Vector form of cross_inside() of the scalar kernel. */
SIMD vd cross_at(const vd d[3], const vd a0[3], const vd a1[3], const vd a2[3], weights w0,
                 weights w1, weights w2) {
    const vd t0 = dot(d, a0), t1 = dot(d, a1), t2 = dot(d, a2);
    const vd sum = w0.modulus + w1.modulus + w2.modulus;
    const vd lo = d_min(t0, d_min(t1, t2)), hi = d_max(t0, d_max(t1, t2));
    const vd t = t0 + (w1.modulus * (t1 - t0) + w2.modulus * (t2 - t0)) / sum;
    return d_max(lo, d_min(t, hi)) / dot(d, d);
}

#endif
#endif
