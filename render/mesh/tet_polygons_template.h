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

#endif
#endif
