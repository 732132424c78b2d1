/* tet_points_template.h - tet_surface_at() of many rays at a time, to the bit; included by the
 * units of an ISA (see formats/base/simd.h). */
#ifndef RENDER_MESH_TET_POINTS_TEMPLATE_H
#define RENDER_MESH_TET_POINTS_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include <float.h>

#include "render/mesh/isopolygon_template.h"

/* The isopolygons that VD_N rays have hit, a lane each, and the rays' hits. */
typedef struct point_columns {
    vd p[4][3], gradient[3], range, d[3], t;
    unsigned turned[EDGES]; /* bits: lanes where the edge function is taken the other way */
    unsigned quads;         /* those with four points */
} point_columns;

/* The ends of edges by number: see EDGES. */
static const uint8_t point_ends[EDGES][2] = {{1, 2}, {2, 0}, {0, 1}, {2, 3}, {3, 0}};

/* These lanes (bits) have hit an isopolygon. */
SIMD void point_columns_put(point_columns *c, unsigned lanes, const tet_facts *f) {
    const isopolygon *g = &f->g;
    const md in = md_of_bits(lanes);
    for (int a = 0; a < 3; a++) {
        for (int i = 0; i < 4; i++)
            c->p[i][a] = d_select(in, d_set(g->p[i][a]), c->p[i][a]);
        c->gradient[a] = d_select(in, d_set(f->point.gradient[a]), c->gradient[a]);
    }
    c->range = d_select(in, d_set(f->range), c->range);
    c->quads |= g->count == 4 ? lanes : 0;
    for (int e = 0; e < EDGES; e++)
        c->turned[e] |= g->edge[point_ends[e][0]] > g->edge[point_ends[e][1]] ? lanes : 0;
}

/* Where rays' lines cross a triangle: cross_triangle()'s slip where that is at t, else INFINITY.
 * *doubtful: lanes where it is not sure whether they do. */
SIMD vd slip_at(const vd d[3], const vd a0[3], const vd a1[3], const vd a2[3], const weights w[3],
                const vd bound[3], vd t, md *doubtful) {
    const verdict v = judge(w[0], w[1], w[2]);
    const vd t0 = dot(d, a0), t1 = dot(d, a1), t2 = dot(d, a2);
    const vd lo = d_min(t0, d_min(t1, t2)), hi = d_max(t0, d_max(t1, t2));
    const vd sum = w[0].modulus + w[1].modulus + w[2].modulus;
    const vd error = d_set(2.0) * (bound[0] + bound[1] + bound[2]), range = hi - lo;
    const vd slip = d_select(d_lt(error, sum), range * (error / sum), range) / dot(d, d);
    const md met =
        md_and(md_or(v.enters, v.leaves), d_eq(cross_at(d, a0, a1, a2, w[0], w[1], w[2]), t));
    *doubtful = v.doubtful;
    return d_select(met, slip, d_set(INFINITY));
}

/* The polygons' edge functions, and by how much they may be off. */
SIMD void weigh_edges(const point_columns *c, const vd d[3], const vd a[4][3],
                      weights weight[EDGES], vd bound[EDGES]) {
    const vd moduli[3] = {d_abs(d[0]), d_abs(d[1]), d_abs(d[2])};
    for (int n = 0; n < EDGES; n++) {
        const int i = point_ends[n][0], j = point_ends[n][1];
        const md turned = md_of_bits(c->turned[n]);
        vd from[3], e[3];
        seen_edge edge;
        for (int k = 0; k < 3; k++) {
            from[k] = d_select(turned, a[j][k], a[i][k]);
            e[k] = c->p[j][k] - c->p[i][k];
        }
        see_line(from, e, &edge);
        bound[n] = error_of(moduli, &edge);
        weight[n] = weigh(d, edge.normal, bound[n]);
    }
}

/* t_error() of the kernel. */
SIMD vd t_errors(const point_columns *c, const vd d[3], const vd a[4][3], unsigned *doubtful) {
    weights w[EDGES];
    vd bound[EDGES], terms = d_set(0.0);
    md first, second;
    weigh_edges(c, d, a, w, bound);
    const weights w0[3] = {w[EDGE_12], w[EDGE_20], w[EDGE_01]};
    const weights w1[3] = {w[EDGE_23], w[EDGE_30], against(w[EDGE_20])};
    const vd b0[3] = {bound[EDGE_12], bound[EDGE_20], bound[EDGE_01]};
    const vd b1[3] = {bound[EDGE_23], bound[EDGE_30], bound[EDGE_20]};
    const vd t = c->t;
    const vd s0 = slip_at(d, a[0], a[1], a[2], w0, b0, t, &first);
    const vd s1 = slip_at(d, a[0], a[2], a[3], w1, b1, t, &second);
    const md quads = md_of_bits(c->quads);
    const vd slip = d_min(s0, d_select(quads, s1, d_set(INFINITY)));
    for (int i = 0; i < 4; i++)
        terms = d_max(terms, d_abs(d[0] * a[i][0]) + d_abs(d[1] * a[i][1]) + d_abs(d[2] * a[i][2]));
    *doubtful = md_bits(md_or(first, md_and(quads, second)));
    return slip + d_set(8.0 * DBL_EPSILON) * terms / dot(d, d);
}

/* Their errors, of rays from o on. Returns the lanes that are for the kernel to do. */
SIMD unsigned point_errors(const point_columns *c, const double o[3], double error[VD_N]) {
    vd d[3], a[4][3], gradient[3];
    unsigned doubtful;
    for (int k = 0; k < 3; k++) {
        d[k] = c->d[k];
        gradient[k] = c->gradient[k];
        for (int i = 0; i < 4; i++)
            a[i][k] = c->p[i][k] - d_set(o[k]);
    }
    const vd along = t_errors(c, d, a, &doubtful);
    vd sum = d_abs(dot(gradient, d)) * along + d_set(8.0 * DBL_EPSILON) * c->range;
    for (int k = 0; k < 3; k++) {
        vd far = d_set(fabs(o[k])) + d_abs(c->t * d[k]);
        for (int i = 0; i < 4; i++)
            far = d_max(far, d_abs(c->p[i][k]));
        sum = sum + d_abs(gradient[k]) * d_set(4.0) * d_set(DBL_EPSILON) * far;
    }
    d_store(error, sum);
    return doubtful;
}

#endif
#endif
