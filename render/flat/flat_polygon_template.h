/* flat_polygon_template.h - tests of polygons against vectors of rays; included by the units of an
 * ISA (see formats/base/simd.h).
 *
 * Sums and products are the same as in exact_near() and flat_polygon_hit(), in the same order, so
 * results agree to the bit. Terms that all rays of one origin share are computed once per edge.
 */
#ifndef RENDER_FLAT_FLAT_POLYGON_TEMPLATE_H
#define RENDER_FLAT_FLAT_POLYGON_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include <string.h>

#include "formats/base/exact.h"
#include "render/flat/flat_polygon.h"

/* Edges by their points: first those of triangle 0 1 2, last those of 0 2 3. */
enum { EDGE_12, EDGE_20, EDGE_01, EDGE_23, EDGE_30, EDGES };

typedef struct seen_edge {
    vd normal[3]; /* a x e */
    vd terms[3];  /* the sum of the moduli of its two products */
} seen_edge;

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
    const vd sum = w0.modulus + (w1.modulus + w2.modulus);
    const vd lo = d_min(t0, d_min(t1, t2)), hi = d_max(t0, d_max(t1, t2));
    const vd t = t0 + (w1.modulus * (t1 - t0) + w2.modulus * (t2 - t0)) / sum;
    return d_max(lo, d_min(t, hi)) / dot(d, d);
}

/* Polygons, a lane each. */
typedef struct polygon_lanes {
    double p[4][3][VD_N];
    uint8_t edge[VD_N][4], count[VD_N]; /* count 0: there is none */
} polygon_lanes;

SIMD void polygon_lanes_put(polygon_lanes *g, unsigned lane, const flat_polygon *from) {
    for (int i = 0; i < 4; i++)
        for (int a = 0; a < 3; a++)
            g->p[i][a][lane] = from->p[i][a];
    memcpy(g->edge[lane], from->edge, sizeof from->edge);
    g->count[lane] = from->count;
}

SIMD flat_polygon polygon_lanes_get(const polygon_lanes *g, unsigned lane) {
    flat_polygon to;
    for (int i = 0; i < 4; i++)
        for (int a = 0; a < 3; a++)
            to.p[i][a] = g->p[i][a][lane];
    memcpy(to.edge, g->edge[lane], sizeof to.edge);
    to.count = g->count[lane];
    return to;
}

/* Polygons, prepared for rays from one point: with a polygon per lane. */
typedef struct seen_lanes {
    vd a[4][3];
    vd normal[EDGES][3]; /* per edge */
    vd error[EDGES];     /* at least error_of() for rays of unit length */
} seen_lanes;

SIMD void see_edges(const polygon_lanes *g, int i, int j, const vd p[4][3], vd error_most,
                    seen_lanes *out, int at) {
    unsigned swap = 0;
    vd from[3], e[3], terms = d_set(0.0);
    for (unsigned lane = 0; lane < VD_N; lane++)
        swap |= (unsigned)(g->edge[lane][i] > g->edge[lane][j]) << lane;
    for (int a = 0; a < 3; a++) {
        from[a] = d_select(md_of_bits(swap), out->a[j][a], out->a[i][a]);
        e[a] = p[j][a] - p[i][a];
    }
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3, c = (a + 2) % 3;
        const vd up = from[b] * e[c], down = from[c] * e[b];
        out->normal[at][a] = up - down;
        terms = terms + (d_abs(up) + d_abs(down));
    }
    out->error[at] = d_set(EXACT_BOUND) * (error_most * terms) + d_set(EXACT_SMALLEST);
}

/* quads: whether there are any; without them, out has no point 3 and no edges to it. */
SIMD void see_lanes(const polygon_lanes *g, const double o[3], bool quads, seen_lanes *out) {
    const vd most = d_set(1.0 + 0x1p-40); /* more than a rounded component */
    vd p[4][3];
    for (int i = 0; i < (quads ? 4 : 3); i++) {
        for (int a = 0; a < 3; a++) {
            p[i][a] = d_load(g->p[i][a]);
            out->a[i][a] = p[i][a] - d_set(o[a]);
        }
    }
    see_edges(g, 1, 2, (const vd(*)[3])p, most, out, EDGE_12);
    see_edges(g, 2, 0, (const vd(*)[3])p, most, out, EDGE_20);
    see_edges(g, 0, 1, (const vd(*)[3])p, most, out, EDGE_01);
    if (!quads)
        return;
    see_edges(g, 2, 3, (const vd(*)[3])p, most, out, EDGE_23);
    see_edges(g, 3, 0, (const vd(*)[3])p, most, out, EDGE_30);
}

/* A polygon, prepared for rays from these origins. */
typedef struct seen {
    vd a[4][3];
    seen_edge edge[EDGES];
} seen;

/* Prepare the edge function, from the point of the lower rank. Reversing the edge only changes
 * its sign, to the bit. */
SIMD void see_edge(const flat_polygon *g, int i, int j, const vd a[4][3], seen_edge *out) {
    vd e[3];
    for (int k = 0; k < 3; k++)
        e[k] = d_set(g->p[j][k]) - d_set(g->p[i][k]);
    see_line(a[g->edge[i] > g->edge[j] ? j : i], e, out);
}

SIMD void see(const flat_polygon *g, const vd o[3], seen *out) {
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

#endif
#endif
