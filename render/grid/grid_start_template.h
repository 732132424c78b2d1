/* grid_start_template.h - ray-cells in which a ray starts on the surface itself; included by the
 * units of an ISA (see formats/base/simd.h).
 *
 * A shadow ray has a root near its start: the surface that it comes from, which does not count.
 * Mostly the control polygon alone shows that the cell has no other root. Then the scalar kernel
 * need not search the cell.
 */
#ifndef RENDER_GRID_GRID_START_TEMPLATE_H
#define RENDER_GRID_GRID_START_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/grid/cell_batch.h"

/* A ray in its cell: nearly the kernel's visit, with other rounding. off: bound of how far the
 * coordinates differ, in units of 2^-50. */
typedef struct start_visit {
    vd t_in, t_out, in[3], out[3], off;
} start_visit;

SIMD start_visit start_visit_of(const cell_batch *b, int at) {
    const vd zero = d_set(0.0), one = d_set(1.0);
    start_visit v = {.t_in = d_load(b->t0 + at), .t_out = d_load(b->t1 + at), .off = one};
    for (int a = 0; a < 3; a++) {
        const vd r = one / d_load(b->d[a] + at);
        const vd to_lo = d_load(b->lo[a] + at) * r, to_hi = d_load(b->hi[a] + at) * r;
        v.t_in = d_max(v.t_in, d_min(to_lo, to_hi));
        v.t_out = d_min(v.t_out, d_max(to_lo, to_hi));
    }
    for (int a = 0; a < 3; a++) {
        const vd d = d_load(b->d[a] + at), lo = d_load(b->lo[a] + at), hi = d_load(b->hi[a] + at);
        const vd inv = d_load(b->inv[a] + at);
        v.in[a] = d_min(d_max((v.t_in * d - lo) * inv, zero), one);
        v.out[a] = d_min(d_max((v.t_out * d - lo) * inv, zero), one);
        v.off = v.off + d_max(d_abs(lo), d_abs(hi)) * inv;
    }
    return v;
}

SIMD vd start_mix(vd a, vd b, vd s) {
    return (d_set(1.0) - s) * a + s * b;
}

/* Compute cell_cubic()'s control values. f: corners less the isovalue. */
SIMD void start_cubic(const start_visit *v, const vd f[8], vd b[4]) {
    vd m[8];
    for (int i = 0; i < 8; i++) {
        const vd *x = i & 1 ? v->out : v->in, *y = i & 2 ? v->out : v->in,
                 *z = i & 4 ? v->out : v->in;
        const vd x0 = start_mix(f[0], f[1], x[0]), x1 = start_mix(f[2], f[3], x[0]);
        const vd x2 = start_mix(f[4], f[5], x[0]), x3 = start_mix(f[6], f[7], x[0]);
        m[i] = start_mix(start_mix(x0, x1, y[1]), start_mix(x2, x3, y[1]), z[2]);
    }
    b[0] = m[0];
    b[1] = (m[1] + m[2] + m[4]) * d_set(1.0 / 3.0);
    b[2] = (m[3] + m[5] + m[6]) * d_set(1.0 / 3.0);
    b[3] = m[7];
}

/* Returns the lanes in which the kernel finds no root behind t = after.
 *
 * The proof, for a cubic that ends above 0 (the others are mirror images). F: the largest |f|; m:
 * the least of b1, b2, b3; e: how far the kernel's control values may differ from these.
 * Coordinates differ by at most 2^-50 `off`, slopes are at most 2 F, and mixing adds 2^-48 F: e =
 * (4 + off) 2^-48 F.
 *
 * Case b0 > e, m > e: the control values do not change side, so there is no root.
 *
 * Else m >= 2^-10 F and |b0| <= 2^-26 F, so |b0| <= 2^-16 m. A third of the slope is (1 - s)^2 (b1
 * - b0) + 2 s (1 - s) (b2 - b1) + s^2 (b3 - b2), above 0 for s <= 2^-13: there is no extremum
 * before. Behind, the cubic is no less than m (1 - (1 - s)^3) - |b0| >= m s - |b0| > 2^-14 m >=
 * 2^-24 F: rounding makes no touch or root of that. So the only root, if any, lies before (|b0| +
 * e) / m. The rounding of the kernel's polynomial, less than 2^-47 F, moves it by at most e / m. */
SIMD unsigned start_clears(const start_visit *v, const vd f[8], vd after) {
    vd b[4], largest = d_set(0.0);
    const vd zero = d_set(0.0);
    for (int i = 0; i < 8; i++)
        largest = d_max(largest, d_abs(f[i]));
    start_cubic(v, f, b);
    const md below = d_lt(b[3], zero);
    for (int i = 0; i < 4; i++)
        b[i] = d_select(below, zero - b[i], b[i]);
    const vd least = d_min(d_min(b[1], b[2]), b[3]);
    const vd e = largest * ((d_set(4.0) + v->off) * d_set(0x1p-48));
    const md apart = md_and(d_gt(b[0], e), d_gt(least, e));
    const vd root = (d_abs(b[0]) + e + e) / least;
    const vd t = v->t_in + root * (v->t_out - v->t_in);
    const vd rounding = d_set(0x1p-48) * (d_abs(v->t_in) + d_abs(after));
    const md near =
        md_and(d_le(d_abs(b[0]), largest * d_set(0x1p-26)), d_ge(least, largest * d_set(0x1p-10)));
    return md_bits(md_or(apart, md_and(near, d_lt(t + rounding, after))));
}

#endif
#endif
