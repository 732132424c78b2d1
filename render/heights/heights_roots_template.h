/* heights_roots_template.h - the kernel of heights_patch.h, VD_N cells at a time: the same
 * operations in the same order, so the same roots to the bit. Included by the units of an ISA (see
 * formats/base/simd.h).
 */
#ifndef RENDER_HEIGHTS_HEIGHTS_ROOTS_TEMPLATE_H
#define RENDER_HEIGHTS_HEIGHTS_ROOTS_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/heights/heights_patch.h"

/* Patches, a lane each: as heights_patch. */
typedef struct patch_lanes {
    vd x, z, h[4];
    double size, inverse;
} patch_lanes;

/* Rays, a lane each; no direction has a component 0. */
typedef struct ray_lanes {
    vd o[3], d[3];
} ray_lanes;

/* Up to two roots of each lane, in order; bits: which lanes have them, and whose come from above.
 */
typedef struct root_lanes {
    unsigned one, two, entering;
    vd t[2];
} root_lanes;

SIMD vd heights_lanes_share(vd o, vd d, vd t, vd first, double inverse) {
    const vd at = (o + t * d - first) * d_set(inverse);
    return d_min(d_max(at, d_set(0.0)), d_set(1.0));
}

SIMD vd heights_lanes_at(const vd h[4], vd u, vd v) {
    const vd one = d_set(1.0);
    const vd first = h[0] * (one - u) + h[1] * u, last = h[2] * (one - u) + h[3] * u;
    return first * (one - v) + last * v;
}

/* Where rays come in and go out of their cells: over the lattice, and at its elevations. */
typedef struct visit_lanes {
    vd in[3], to[3], t_in, t_out;
} visit_lanes;

/* Returns which lanes visit their cells at elevations that the patch may have. */
SIMD unsigned heights_lanes_visit(const patch_lanes *p, const ray_lanes *r, visit_lanes *v) {
    const vd first[3] = {p->x, d_set(0.0), p->z};
    for (int a = 0; a < 3; a += 2) {
        const md back = d_lt(r->d[a], d_set(0.0));
        const vd last = first[a] + d_set(p->size);
        v->in[a] = (d_select(back, last, first[a]) - r->o[a]) / r->d[a];
        v->to[a] = (d_select(back, first[a], last) - r->o[a]) / r->d[a];
    }
    const vd least = d_min(d_min(p->h[0], p->h[1]), d_min(p->h[2], p->h[3]));
    const vd most = d_max(d_max(p->h[0], p->h[1]), d_max(p->h[2], p->h[3]));
    const vd margin = d_set(0x1p-10) * (most - least) +
                      d_set(0x1p-40) * (d_abs(least) + d_abs(most) + d_abs(r->o[1])) +
                      d_set(0x1p-900);
    const vd bottom = least - margin, top = most + margin;
    const md falls = d_lt(r->d[1], d_set(0.0));
    v->in[1] = (d_select(falls, top, bottom) - r->o[1]) / r->d[1];
    v->to[1] = (d_select(falls, bottom, top) - r->o[1]) / r->d[1];
    v->t_in = d_max(d_max(v->in[0], v->in[2]), v->in[1]);
    v->t_out = d_min(d_min(v->to[0], v->to[2]), v->to[1]);
    const vd sum = (p->h[0] - p->h[1]) + (p->h[2] - p->h[3]);
    const md over = md_and(d_le(v->in[0], v->to[2]), d_lt(v->in[2], v->to[0]));
    const md within = md_and(d_le(v->t_in, v->t_out), d_eq(sum - sum, d_set(0.0)));
    return md_bits(md_and(over, within)) & ((1u << VD_N) - 1u);
}

/* The patch's height minus the ray's at an end of the visit; where that is, in the cell. */
SIMD vd heights_lanes_end(const patch_lanes *p, const ray_lanes *r, const vd planes[3], vd t,
                          bool end, vd *u, vd *v) {
    const vd zero = d_set(0.0), one = d_set(1.0);
    const md on_x = d_eq(planes[0], t), on_z = d_eq(planes[2], t);
    const md by_z = end ? md_and_not(on_z, on_x) : on_z, by_x = md_and_not(on_x, by_z);
    const md back_x = d_lt(r->d[0], zero), back_z = d_lt(r->d[2], zero);
    const vd side_x = end ? d_select(back_x, zero, one) : d_select(back_x, one, zero);
    const vd side_z = end ? d_select(back_z, zero, one) : d_select(back_z, one, zero);
    *u = d_select(by_x, side_x, heights_lanes_share(r->o[0], r->d[0], t, p->x, p->inverse));
    *v = d_select(by_z, side_z, heights_lanes_share(r->o[2], r->d[2], t, p->z, p->inverse));
    return heights_lanes_at(p->h, *u, *v) - (r->o[1] + t * r->d[1]);
}

/* heights_lanes_roots() - heights_patch_roots() of lanes; returns which lanes visit their cells. */
SIMD unsigned heights_lanes_roots(const patch_lanes *p, const ray_lanes *r, root_lanes *out) {
    const vd zero = d_set(0.0), one = d_set(1.0), two = d_set(2.0);
    visit_lanes w;
    vd u[2], v[2];
    const unsigned visiting = heights_lanes_visit(p, r, &w);
    out->one = out->two = 0;
    if (!visiting)
        return 0;
    const vd f0 = heights_lanes_end(p, r, w.in, w.t_in, false, &u[0], &v[0]);
    const vd f1 = heights_lanes_end(p, r, w.to, w.t_out, true, &u[1], &v[1]);
    const md above = d_lt(f0, zero), differ = md_xor(above, d_lt(f1, zero));
    const vd sign = d_select(above, one, d_set(-1.0));
    const vd twist = (p->h[3] - p->h[2]) - (p->h[1] - p->h[0]);
    const vd a = sign * twist * (u[1] - u[0]) * (v[1] - v[0]), c = sign * f0;
    const vd b = sign * (f1 - f0) - a, width = w.t_out - w.t_in;
    const vd square = b * b - d_set(4.0) * a * c, root = d_sqrt(d_max(square, zero));
    const vd both = b + root;
    const md pair = md_and_not(md_and(md_and(d_lt(a, zero), d_gt(b, zero)),
                                      md_and(d_lt(b, d_set(-2.0) * a), d_gt(square, zero))),
                               differ);
    out->one = md_bits(md_or(differ, pair)) & visiting;
    out->two = md_bits(pair) & visiting;
    out->entering = md_bits(above);
    if (!out->one)
        return visiting;
    const vd by_sum = d_set(-2.0) * c / both;
    const vd by_rest =
        d_select(differ, root - b, both) / d_select(differ, two * a, d_set(-2.0) * a);
    const vd rises = d_select(d_ge(b, zero), d_select(d_gt(both, zero), by_sum, zero),
                              d_select(d_gt(a, zero), by_rest, one));
    const vd s[2] = {d_select(differ, rises, by_sum), by_rest};
    for (int i = 0; i < 2; i++)
        out->t[i] = d_min(w.t_in + d_min(d_max(s[i], zero), one) * width, w.t_out);
    return visiting;
}

#endif
#endif
