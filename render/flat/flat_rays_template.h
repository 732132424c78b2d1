/* flat_rays_template.h - tests vectors of the rays of flat_rays.h against one polygon; included by
 * the units of an ISA (see formats/base/simd.h).
 *
 * Each ray may have its own origin. The polygon is seen from VD_N origins at a time, lane by lane
 * as exact_near() does, so that its bound holds for each.
 */
#ifndef RENDER_FLAT_FLAT_RAYS_TEMPLATE_H
#define RENDER_FLAT_FLAT_RAYS_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/flat/flat_polygon_template.h"
#include "render/flat/flat_rays.h"

typedef struct hit_of {
    uint64_t cell;
    int32_t iso;
} hit_of;

/* Offer hits at t of the rays at + bit. Returns the rays for which this is the nearest hit so
 * far. */
SIMD unsigned offer(flat_rays *rays, int at, hit_of of, unsigned hits, unsigned enters, vd t) {
    double ts[VD_N];
    unsigned taken = 0;
    d_store(ts, t);
    for (; hits; hits &= hits - 1) {
        const int k = __builtin_ctz(hits);
        const hit h = {ts[k], of.cell, of.iso, enters >> k & 1};
        taken |= (unsigned)flat_rays_offer(rays, at + k, &h) << k;
    }
    return taken;
}

/* Test the triangle with these corners, for rays that hit no other triangle of the polygon. Returns
 * as offer() does. */
SIMD unsigned meet(flat_rays *rays, int at, hit_of of, const vd d[3], const vd a0[3],
                   const vd a1[3], const vd a2[3], weights w0, weights w1, weights w2, verdict v,
                   unsigned wanted) {
    const md hits = md_or(v.enters, v.leaves);
    if (!(md_bits(hits) & wanted))
        return 0;
    const vd t = cross_at(d, a0, a1, a2, w0, w1, w2);
    const md within = md_and(d_ge(t, d_load(rays->from + at)), d_le(t, d_load(rays->to + at)));
    const unsigned counted = md_bits(md_and(hits, within)) & wanted;
    return counted ? offer(rays, at, of, counted, md_bits(v.enters), t) : 0;
}

SIMD weights weigh_ray(const vd d[3], const vd moduli[3], const seen_edge *e) {
    return weigh(d, e->normal, error_of(moduli, e));
}

/* Test a vector of rays. wanted: rays to test. Returns the rays for which this is the nearest hit
 * so far. */
SIMD unsigned test_rays(const flat_polygon *g, const seen *s, flat_rays *rays, int at, hit_of of,
                        unsigned wanted) {
    const vd d[3] = {d_load(rays->d[0] + at), d_load(rays->d[1] + at), d_load(rays->d[2] + at)};
    const vd moduli[3] = {d_abs(d[0]), d_abs(d[1]), d_abs(d[2])};
    const weights w12 = weigh_ray(d, moduli, &s->edge[EDGE_12]);
    const weights w20 = weigh_ray(d, moduli, &s->edge[EDGE_20]);
    const weights w01 = weigh_ray(d, moduli, &s->edge[EDGE_01]);
    const verdict v = judge(w12, w20, w01);
    unsigned doubtful = md_bits(v.doubtful), taken = 0;
    if (g->count == 4) {
        const weights w23 = weigh_ray(d, moduli, &s->edge[EDGE_23]);
        const weights w30 = weigh_ray(d, moduli, &s->edge[EDGE_30]);
        const weights w02 = against(w20);
        const verdict v2 = judge(w23, w30, w02);
        /* A quadrilateral that is hit twice is bent: leave it to the scalar truth. */
        doubtful |= md_bits(v2.doubtful) |
                    (md_bits(md_or(v.enters, v.leaves)) & md_bits(md_or(v2.enters, v2.leaves)));
        taken =
            meet(rays, at, of, d, s->a[0], s->a[2], s->a[3], w23, w30, w02, v2, wanted & ~doubtful);
    }
    taken |= meet(rays, at, of, d, s->a[0], s->a[1], s->a[2], w12, w20, w01, v, wanted & ~doubtful);
    for (unsigned left = doubtful & wanted; left; left &= left - 1) {
        const int lane = at + __builtin_ctz(left);
        if (rays->from[lane] <= rays->to[lane])
            taken |= (unsigned)flat_rays_one(g, of.cell, of.iso, rays, lane) << (lane - at);
    }
    return taken;
}

SIMD void see_from(const flat_polygon *g, const flat_rays *rays, int at, seen *s) {
    const vd o[3] = {d_load(rays->o[0] + at), d_load(rays->o[1] + at), d_load(rays->o[2] + at)};
    see(g, o, s);
}

#endif
#endif
