/* triangle_turn_template.h - triangle_polygon() for many triangles at a time, to the bit; included
 * by the units of an ISA (see formats/base/simd.h). */
#ifndef RENDER_TRIANGLE_TRIANGLE_TURN_TEMPLATE_H
#define RENDER_TRIANGLE_TRIANGLE_TURN_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/flat/flat_polygon_template.h"
#include "render/triangle/triangle_kernel.h"
#include "stream/triangle_blocks.h"

/* VF_N triangles, a lane each. */
typedef struct turned_triangles {
    _Alignas(64) float p[3][3][VF_N]; /* corners, in the file's order */
    _Alignas(64) uint32_t rank[3][VF_N];
    _Alignas(64) uint32_t first[VF_N]; /* the corner of the lowest rank */
} turned_triangles;

/* triangle_is_before() */
SIMD mf is_before_lanes(const vf a[3], const vf b[3]) {
    const mf y = mf_or(f_lt(a[1], b[1]), mf_and(f_eq(a[1], b[1]), f_lt(a[2], b[2])));
    return mf_or(f_lt(a[0], b[0]), mf_and(f_eq(a[0], b[0]), y));
}

/* Returns in how many of two orders a point comes second. */
SIMD vi rank_lanes(mf first, mf second) {
    const vf one = f_set(1.0f), zero = f_set(0.0f);
    return f_to_int(f_select(first, one, zero) + f_select(second, one, zero));
}

/* Load triangles by their vertices; x: their corners, too. */
SIMD void turn_triangles(const triangle_blocks *b, const uint32_t vertex[3][VF_N], vf x[3][3],
                         turned_triangles *out) {
    for (int k = 0; k < 3; k++)
        for (int a = 0; a < 3; a++) {
            x[k][a] = (vf)i_gather(b->p[a], i_load(vertex[k]) << 2);
            f_store(out->p[k][a], x[k][a]);
        }
    mf before[3][2]; /* corner k by the next one, by the one after that */
    for (int k = 0; k < 3; k++)
        for (int n = 0; n < 2; n++)
            before[k][n] = is_before_lanes(x[(k + 1 + n) % 3], x[k]);
    for (int k = 0; k < 3; k++)
        i_store(out->rank[k], rank_lanes(before[k][0], before[k][1]));
    const mf second = before[0][0],
             third = mf_or(mf_and(second, before[1][0]), mf_and_not(before[0][1], second));
    i_store(out->first,
            f_to_int(f_select(third, f_set(2.0f), f_select(second, f_set(1.0f), f_set(0.0f)))));
}

/* Put a lane's triangle into a lane of polygons. */
SIMD void turned_put(const turned_triangles *t, unsigned lane, polygon_lanes *g, unsigned to) {
    const uint8_t *from = triangle_corners_from[t->first[lane]];
    g->count[to] = 3;
    for (int i = 0; i < 4; i++) {
        const int k = from[i < 3 ? i : 2];
        g->edge[to][i] = (uint8_t)t->rank[k][lane];
        for (int a = 0; a < 3; a++)
            g->p[i][a][to] = (double)t->p[k][a][lane];
    }
}

#endif
#endif
