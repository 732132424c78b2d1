/* tet_polygons_template.h - makes the isopolygons of many tets, a lane each, and their edges as
 * seen from one point; included by the units of an ISA (see formats/base/simd.h).
 *
 * Sums and products are those of isopolygon_of() and exact_near(), in their order, so the bits are
 * the same.
 */
#ifndef RENDER_MESH_TET_POLYGONS_TEMPLATE_H
#define RENDER_MESH_TET_POLYGONS_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/mesh/isopolygon_template.h"
#include "render/mesh/tet_normals_template.h"

/* Isopolygons, a lane each. */
typedef struct polygon_lanes {
    double p[4][3][VD_N];
    uint8_t edge[VD_N][4], count[VD_N]; /* count 0: there is none */
} polygon_lanes;

SIMD void polygon_lanes_put(polygon_lanes *g, unsigned lane, const isopolygon *from) {
    for (int i = 0; i < 4; i++)
        for (int a = 0; a < 3; a++)
            g->p[i][a][lane] = from->p[i][a];
    memcpy(g->edge[lane], from->edge, sizeof from->edge);
    g->count[lane] = from->count;
}

SIMD isopolygon polygon_lanes_get(const polygon_lanes *g, unsigned lane) {
    isopolygon to;
    for (int i = 0; i < 4; i++)
        for (int a = 0; a < 3; a++)
            to.p[i][a] = g->p[i][a][lane];
    memcpy(to.edge, g->edge[lane], sizeof to.edge);
    to.count = g->count[lane];
    return to;
}

/* Find the signs of exact_orientation(). Returns the lanes where they are sure; *negative: lanes
 * where they are below 0. */
SIMD unsigned surely_orient(const vd p[4][3], unsigned *negative) {
    vd e[3][3], sum = d_set(0.0), terms = sum;
    for (int i = 0; i < 3; i++)
        for (int a = 0; a < 3; a++)
            e[i][a] = p[i + 1][a] - p[0][a];
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3, c = (a + 2) % 3;
        const vd up = e[1][b] * e[2][c], down = e[1][c] * e[2][b];
        sum = sum + e[0][a] * (up - down);
        terms = terms + d_abs(e[0][a]) * (d_abs(up) + d_abs(down));
    }
    const vd bound = d_set(EXACT_BOUND) * terms + d_set(EXACT_SMALLEST);
    *negative = md_bits(d_lt(sum, d_set(0.0)));
    return md_bits(d_gt(d_abs(sum), d_set(2.0) * bound));
}

/* Find the isovalue's point on each of a tet's edges. Means something only for edges that it
 * cuts. */
SIMD void cut_edges(const vd p[4][3], const vd f[4], vd iso, double cut[TET_EDGES][3][VD_N]) {
    for (int edge = 0; edge < TET_EDGES; edge++) {
        const int i = tet_edge_ends[edge][0], j = tet_edge_ends[edge][1];
        const vd s = (iso - f[i]) / (f[j] - f[i]);
        const md whole = d_ge(s, d_set(1.0));
        for (int a = 0; a < 3; a++)
            d_store(cut[edge][a], d_select(whole, p[j][a], p[i][a] + s * (p[j][a] - p[i][a])));
    }
}

/* Vector form of isopolygon_of(): VD_N tets, each with its own isovalue. Returns the lanes that are
 * certain; the others need isopolygon_of() itself. */
SIMD unsigned isopolygons_near(const tet_columns *x, const double isovalues[VD_N],
                               polygon_lanes *out) {
    double cut[TET_EDGES][3][VD_N];
    vd p[4][3], f[4], sum = d_set(0.0);
    unsigned in[4], negative;
    const vd iso = d_load(isovalues);
    for (int k = 0; k < 4; k++) {
        for (int a = 0; a < 3; a++)
            p[k][a] = d_load(x->p[k][a]);
        f[k] = d_load(x->f[k]);
        in[k] = md_bits(d_ge(f[k], iso));
        sum = sum + f[k];
    }
    const unsigned finite = md_bits(d_le(d_abs(sum), d_set(DBL_MAX)));
    const unsigned sure = surely_orient((const vd(*)[3])p, &negative);
    cut_edges((const vd(*)[3])p, f, iso, cut);
    for (unsigned lane = 0; lane < VD_N; lane++) {
        unsigned inside = 0;
        for (unsigned k = 0; k < 4; k++)
            inside |= (in[k] >> lane & 1u) << k;
        const tet_cut *of = &tet_cuts[finite >> lane & 1u ? inside : 0];
        uint8_t *edge = out->edge[lane];
        memcpy(edge, of->edge, sizeof of->edge);
        out->count[lane] = of->count;
        if (negative >> lane & 1u && of->count > 0)
            tet_turn_over(edge, of->count);
        for (int i = 0; i < 4; i++)
            for (int a = 0; a < 3; a++)
                out->p[i][a][lane] = cut[edge[i]][a][lane];
    }
    return sure;
}

/* Polygons, prepared for rays from one point: as struct seen, with a polygon per lane. */
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

SIMD void see_lanes(const polygon_lanes *g, const double o[3], seen_lanes *out) {
    const vd most = d_set(1.0 + 0x1p-40); /* more than a rounded component */
    vd p[4][3];
    for (int i = 0; i < 4; i++) {
        for (int a = 0; a < 3; a++) {
            p[i][a] = d_load(g->p[i][a]);
            out->a[i][a] = p[i][a] - d_set(o[a]);
        }
    }
    see_edges(g, 1, 2, (const vd(*)[3])p, most, out, EDGE_12);
    see_edges(g, 2, 0, (const vd(*)[3])p, most, out, EDGE_20);
    see_edges(g, 0, 1, (const vd(*)[3])p, most, out, EDGE_01);
    see_edges(g, 2, 3, (const vd(*)[3])p, most, out, EDGE_23);
    see_edges(g, 3, 0, (const vd(*)[3])p, most, out, EDGE_30);
}

#endif
#endif
