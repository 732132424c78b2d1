/* tet_batch_template.h - tet_batch.h for the ISA of the translation unit that includes it.
 *
 * Takes a vector of rays at a time. The polygon's edges as seen from the origin are prepared once
 * for all rays of one origin; then an edge function is a scalar product. Sums and products are
 * those of exact_near() and flat_polygon_hit(), in their order, so the bits are the same. Rays
 * whose signs stay in doubt go to the scalar truth.
 */
#ifndef RENDER_MESH_TET_BATCH_TEMPLATE_H
#define RENDER_MESH_TET_BATCH_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/flat/flat_rays_template.h"
#include "render/mesh/isopolygon_template.h"
#include "render/mesh/tet_batch.h"

void SIMD_NAME(tet_batch)(const isopolygon *g, uint64_t cell, int32_t iso_index, tet_known known,
                          flat_rays *rays, int first, int end);

/* Compute t for a vector of rays that are known to hit the triangle `known`, and offer the hits. */
SIMD void pass_rays(const seen *s, flat_rays *rays, int at, hit_of of, tet_known known,
                    unsigned wanted) {
    const vd d[3] = {d_load(rays->d[0] + at), d_load(rays->d[1] + at), d_load(rays->d[2] + at)};
    const vd exact = d_set(0.0);
    const weights w20 = weigh(d, s->edge[EDGE_20].normal, exact);
    const bool first = known == TET_FIRST_IS_HIT;
    const weights w0 = weigh(d, s->edge[first ? EDGE_12 : EDGE_23].normal, exact);
    const weights w1 = first ? w20 : weigh(d, s->edge[EDGE_30].normal, exact);
    const weights w2 = first ? weigh(d, s->edge[EDGE_01].normal, exact) : against(w20);
    const verdict v = {w0.above, w0.below, md_of_bits(0)};
    const int b = first ? 1 : 2;
    (void)meet(rays, at, of, d, s->a[0], s->a[b], s->a[b + 1], w0, w1, w2, v, wanted);
}

SIMD void see_from_one(const isopolygon *g, const flat_rays *rays, int at, seen *s) {
    const vd o[3] = {d_set(rays->o[0][at]), d_set(rays->o[1][at]), d_set(rays->o[2][at])};
    see(g, o, s);
}

void SIMD_NAME(tet_batch)(const isopolygon *g, uint64_t cell, int32_t iso_index, tet_known known,
                          flat_rays *rays, int first, int end) {
    const hit_of of = {cell, iso_index};
    const unsigned all = (1u << VD_N) - 1;
    seen s;
    if (first >= end)
        return;
    if (rays->one_origin)
        see_from_one(g, rays, first, &s);
    for (int at = first & -VD_N; at < end; at += VD_N) {
        unsigned wanted = all;
        if (at < first)
            wanted &= all << (first - at);
        if (at + VD_N > end)
            wanted &= all >> (at + VD_N - end);
        if (!rays->one_origin)
            see_from(g, rays, at, &s);
        if (known == TET_UNKNOWN)
            (void)test_rays(g, &s, rays, at, of, wanted);
        else
            pass_rays(&s, rays, at, of, known, wanted);
    }
}

#endif
#endif
