/* tet_batch_template.h - tet_batch.h for the ISA of the translation unit that includes it.
 *
 * A vector of rays at a time. What the rays of one origin have in common, the polygon's edges as
 * the origin sees them, is done once; then an edge function is a scalar product. Sums and products
 * are those of exact_near() and isopolygon_hit(), in their order, so the bits are the same. Rays
 * whose signs these leave in doubt go to the scalar truth.
 */
#ifndef RENDER_MESH_TET_BATCH_TEMPLATE_H
#define RENDER_MESH_TET_BATCH_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/mesh/tet_batch.h"
#include "render/mesh/tet_sight_template.h"

void SIMD_NAME(tet_batch)(const isopolygon *g, uint64_t cell, int32_t iso_index, tet_known known,
                          tet_rays *rays, int first, int end);

typedef struct hit_of {
    uint64_t cell;
    int32_t iso;
} hit_of;

/* Rays at + bit: enter or leave at t. */
SIMD void offer(tet_rays *rays, int at, hit_of of, unsigned hits, unsigned enters, vd t) {
    double ts[VD_N];
    d_store(ts, t);
    for (; hits; hits &= hits - 1) {
        const int k = __builtin_ctz(hits);
        const hit h = {ts[k], of.cell, of.iso, enters >> k & 1};
        tet_batch_offer(rays, at + k, &h);
    }
}

/* The triangle with these corners, unless another of the ray's is hit, too. */
SIMD void meet(tet_rays *rays, int at, hit_of of, const vd d[3], const vd a0[3], const vd a1[3],
               const vd a2[3], weights w0, weights w1, weights w2, verdict v, unsigned wanted) {
    const md hits = md_or(v.enters, v.leaves);
    if (!(md_bits(hits) & wanted))
        return;
    const vd t = cross_at(d, a0, a1, a2, w0, w1, w2);
    const md within = md_and(d_ge(t, d_load(rays->from + at)), d_le(t, d_load(rays->to + at)));
    const unsigned counted = md_bits(md_and(hits, within)) & wanted;
    if (counted)
        offer(rays, at, of, counted, md_bits(v.enters), t);
}

SIMD weights weigh_ray(const vd d[3], const vd moduli[3], const seen_edge *e) {
    return weigh(d, e->normal, error_of(moduli, e));
}

/* A vector of rays that all hit one triangle: only where is asked. */
SIMD void pass_rays(const seen *s, tet_rays *rays, int at, hit_of of, tet_known known,
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
    meet(rays, at, of, d, s->a[0], s->a[b], s->a[b + 1], w0, w1, w2, v, wanted);
}

/* A vector of rays; wanted: those that are asked for. */
SIMD void test_rays(const isopolygon *g, const seen *s, tet_rays *rays, int at, hit_of of,
                    unsigned wanted) {
    const vd d[3] = {d_load(rays->d[0] + at), d_load(rays->d[1] + at), d_load(rays->d[2] + at)};
    const vd moduli[3] = {d_abs(d[0]), d_abs(d[1]), d_abs(d[2])};
    const weights w12 = weigh_ray(d, moduli, &s->edge[EDGE_12]);
    const weights w20 = weigh_ray(d, moduli, &s->edge[EDGE_20]);
    const weights w01 = weigh_ray(d, moduli, &s->edge[EDGE_01]);
    const verdict v = judge(w12, w20, w01);
    unsigned doubtful = md_bits(v.doubtful);
    if (g->count == 4) {
        const weights w23 = weigh_ray(d, moduli, &s->edge[EDGE_23]);
        const weights w30 = weigh_ray(d, moduli, &s->edge[EDGE_30]);
        const weights w02 = against(w20);
        const verdict v2 = judge(w23, w30, w02);
        /* A quadrilateral that is hit twice is bent: not here. */
        doubtful |= md_bits(v2.doubtful) |
                    (md_bits(md_or(v.enters, v.leaves)) & md_bits(md_or(v2.enters, v2.leaves)));
        meet(rays, at, of, d, s->a[0], s->a[2], s->a[3], w23, w30, w02, v2, wanted & ~doubtful);
    }
    meet(rays, at, of, d, s->a[0], s->a[1], s->a[2], w12, w20, w01, v, wanted & ~doubtful);
    for (unsigned left = doubtful & wanted; left; left &= left - 1) {
        const int lane = at + __builtin_ctz(left);
        if (rays->from[lane] <= rays->to[lane])
            tet_batch_one(g, of.cell, of.iso, rays, lane);
    }
}

SIMD void see_from(const isopolygon *g, const tet_rays *rays, int at, seen *s) {
    const vd o[3] = {d_load(rays->o[0] + at), d_load(rays->o[1] + at), d_load(rays->o[2] + at)};
    see(g, o, s);
}

SIMD void see_from_one(const isopolygon *g, const tet_rays *rays, int at, seen *s) {
    const vd o[3] = {d_set(rays->o[0][at]), d_set(rays->o[1][at]), d_set(rays->o[2][at])};
    see(g, o, s);
}

void SIMD_NAME(tet_batch)(const isopolygon *g, uint64_t cell, int32_t iso_index, tet_known known,
                          tet_rays *rays, int first, int end) {
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
            test_rays(g, &s, rays, at, of, wanted);
        else
            pass_rays(&s, rays, at, of, known, wanted);
    }
}

#endif
#endif
