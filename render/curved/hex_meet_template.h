/* hex_meet_template.h - VD_N rays and a hexahedron: where each meets an isosurface once, or surely
 * not at all. hex_meet.h says how that is known. In units of an ISA (simd.h), or of one ray
 * (simd_one.h, which such a unit includes first): the same bits.
 */
#ifndef RENDER_CURVED_HEX_MEET_TEMPLATE_H
#define RENDER_CURVED_HEX_MEET_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD

#include <string.h>

#include "formats/base/hexahedron.h"
#include "formats/base/trilinear_template.h"

/* A cell as all rays of one origin and one longest axis see it. */
typedef struct hex_sight {
    double away[3][HEX_CORNERS]; /* corners from the origin, by the axes of the rays' space */
    vd value[TRILINEAR];         /* the values' form */
    vd size;                     /* and the sum of its coefficients' sizes */
} hex_sight;

/* VD_N such rays, as sheared_ray. */
typedef struct hex_rays {
    vd slope[2], d;
} hex_rays;

/* The cell in the space of each of these rays: its first two coordinates. */
typedef struct hex_placed {
    vd q[2][HEX_CORNERS];
} hex_placed;

typedef struct hex_met {
    md unknown;  /* rays that may meet it, and how often */
    md once;     /* rays that meet it once, */
    vd t, at[3]; /* where, */
    md enters;   /* and whether the value rises there, if the cell is right-handed */
} hex_met;

/* axis: sheared_ray.axis of all these rays. */
SIMD void hex_sight_of(const hexahedron *cell, const double o[3], const int axis[3],
                       hex_sight *out) {
    vd value[HEX_CORNERS];
    for (int c = 0; c < HEX_CORNERS; c++) {
        for (int k = 0; k < 3; k++)
            out->away[k][c] = cell->p[c][axis[k]] - o[axis[k]];
        value[c] = d_set(cell->value[c]);
    }
    trilinear_of(value, out->value);
    out->size = trilinear_size(out->value);
}

/* As sheared_ray_place(). */
SIMD void hex_place(const hex_sight *cell, const hex_rays *rays, hex_placed *out) {
    for (int c = 0; c < HEX_CORNERS; c++) {
        const vd along = d_set(cell->away[2][c]);
        for (int k = 0; k < 2; k++)
            out->q[k][c] = d_set(cell->away[k][c]) - rays->slope[k] * along;
    }
}

/* The forms that are 0 where a ray is at the isovalue: two coordinates, the value less it. */
typedef struct hex_forms {
    vd f[3][TRILINEAR];
} hex_forms;

/* A box of parameters in which a form's own are -1 to 1. */
typedef struct hex_box {
    vd middle[3], half[3];
} hex_box;

/* Roots are single in a box that is larger by this factor. */
#define HEX_BEYOND 1.125

/* Newton's method from x, to a step whose square is below rounding. Returns the rays of `left` for
 * which it neither leaves the box nor takes long. */
SIMD md hex_newton(const hex_forms *all, const hex_box *box, md left, vd x[3]) {
    enum { STEPS = 8 };
    md found = md_and_not(left, left);
    for (int n = 0; n < STEPS; n++) {
        vd slope[3][3], column[3][3], off[3], most = d_set(0.0);
        md within = left;
        for (int k = 0; k < 3; k++) {
            off[k] = trilinear_at(all->f[k], x);
            trilinear_slope(all->f[k], x, slope[k]);
        }
        (void)trilinear_invert(slope, column);
        for (int i = 0; i < 3; i++) {
            const vd by = (column[0][i] * off[0] + column[1][i] * off[1]) + column[2][i] * off[2];
            x[i] = d_select(left, x[i] - by, x[i]);
            most = d_max(d_abs(by), most);
            within = md_and(within,
                            d_le(d_abs(x[i] - box->middle[i]), d_set(HEX_BEYOND) * box->half[i]));
        }
        const md done = md_and(within, d_le(most, d_set(0x1p-33)));
        found = md_or(found, done);
        left = md_and_not(within, done);
        if (!md_bits(left))
            break;
    }
    return found;
}

/* Look at rays one box after the other: boxes become smaller until one has no root, or a single
 * one, which is found. Sets x, in the whole cell's parameters, and det of rays that have one;
 * returns these. Rays that are not known go from *left to *unknown. */
SIMD md hex_shrink(const hex_forms *all, const vd rounding[3], md left, md *unknown, vd x[3],
                   vd *det) {
    enum { BOXES = 4 };
    /* Sides of boxes, each relative to that of the one before; and what content is not worth a
     * look.
     */
    const double narrowest = 0x1p-4, worth = 0.5;
    const vd zero = d_set(0.0), one = d_set(1.0), room = d_set(TRILINEAR_ROOM);
    const vd half = d_set(0.5);
    hex_forms part = *all;
    hex_box box = {{zero, zero, zero}, {one, one, one}};
    md found = md_and_not(left, left);
    for (int n = 1;; n++) {
        vd middle[3], width[3], start[3];
        trilinear_bend b;
        const md good = trilinear_bend_of(part.f, rounding, &b);
        *unknown = md_or(*unknown, md_and_not(left, good));
        left = md_and(left, good);
        for (int i = 0; i < 3; i++) {
            const vd rest = ((b.two[0][i] + b.two[1][i]) + b.two[2][i]) + b.all[i];
            const vd stray = rest + room * (one + rest + d_abs(b.at[i]));
            const vd lo = d_max(d_set(-1.0), b.at[i] - stray);
            const vd hi = d_min(one, b.at[i] + stray);
            left = md_and_not(left, d_gt(lo, hi));
            middle[i] = half * (hi + lo);
            width[i] = d_max(d_set(narrowest), half * (hi - lo));
            start[i] = box.middle[i] + box.half[i] * d_min(one, d_max(b.at[i], d_set(-1.0)));
        }
        if (!md_bits(left))
            return found;
        const md single = md_and(left, trilinear_is_single(&b, HEX_BEYOND));
        if (md_bits(single)) {
            const md roots = hex_newton(all, &box, single, start);
            for (int i = 0; i < 3; i++)
                x[i] = d_select(roots, start[i], x[i]);
            *det = d_select(roots, b.det, *det);
            found = md_or(found, roots);
            left = md_and_not(left, roots);
        }
        const md large =
            n == BOXES ? left : md_and(left, d_gt(width[0] * width[1] * width[2], d_set(worth)));
        *unknown = md_or(*unknown, large);
        left = md_and_not(left, large);
        if (!md_bits(left))
            return found;
        for (int k = 0; k < 3; k++)
            trilinear_restrict(part.f[k], middle, width);
        for (int i = 0; i < 3; i++) {
            box.middle[i] = box.middle[i] + box.half[i] * middle[i];
            box.half[i] = box.half[i] * width[i];
        }
    }
}

/* Of the rays `asked`. The cell must not be folded. */
SIMD void hex_meet_lanes(const hex_sight *cell, const hex_rays *rays, const hex_placed *placed,
                         double isovalue, md asked, hex_met *out) {
    /* A form's coefficients err by this share of their sum at most. */
    const vd error = d_set(0x1p-48), half = d_set(0.5), iso = d_set(isovalue);
    /* What bounds of a single root's parameters may err by: bent forms move it. */
    const double room = TRILINEAR_STRETCH * TRILINEAR_ROOM;
    vd x[3] = {d_set(0.0), d_set(0.0), d_set(0.0)}, det = d_set(0.0), most = d_set(0.0);
    vd rounding[3], along[HEX_CORNERS];
    hex_forms all;
    for (int k = 0; k < 2; k++) {
        trilinear_of(placed->q[k], all.f[k]);
        rounding[k] = error * trilinear_size(all.f[k]);
    }
    memcpy(all.f[2], cell->value, sizeof all.f[2]);
    all.f[2][0] = all.f[2][0] - iso;
    rounding[2] = error * (cell->size + d_abs(iso));
    out->unknown = md_and_not(asked, asked);
    const md found = hex_shrink(&all, rounding, asked, &out->unknown, x, &det);
    for (int i = 0; i < 3; i++) {
        most = d_max(d_abs(x[i]), most);
        out->at[i] = half + half * x[i];
    }
    const md near = md_and(found, d_gt(most, d_set(1.0 - room)));
    out->unknown = md_or(out->unknown, md_and(near, d_lt(most, d_set(1.0 + room))));
    out->once = md_and_not(found, near);
    if (!md_bits(out->once))
        return;
    for (int c = 0; c < HEX_CORNERS; c++)
        along[c] = d_set(cell->away[2][c]) / rays->d;
    out->t = trilinear_between(along, out->at);
    /* Right-handed in the rays' space where the ray goes up its third axis. */
    out->enters = md_xor(d_lt(det, d_set(0.0)), d_gt(rays->d, d_set(0.0)));
}

#endif
#endif
