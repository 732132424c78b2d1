/* hex_meet_template.h - VD_N rays and a hexahedron: where each meets an isosurface once, or surely
 * not at all. hex_meet.h says how that is known. In units of an ISA (simd.h), or of one ray
 * (simd_one.h, which such a unit includes first): the same bits.
 */
#ifndef RENDER_CURVED_HEX_MEET_TEMPLATE_H
#define RENDER_CURVED_HEX_MEET_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD

#include <math.h>
#include <string.h>

#include "formats/base/hexahedron.h"
#include "formats/base/trilinear_template.h"

/* A cell from an origin: the forms of its corners' places, and of their values. */
typedef struct hex_sight {
    vd away[3][TRILINEAR], value[TRILINEAR];
    vd size[3], value_size; /* trilinear_size() of each */
} hex_sight;

/* VD_N rays of one origin and one longest axis, as sheared_ray. */
typedef struct hex_rays {
    int axis[3];
    vd slope[2], d;
} hex_rays;

/* Of rays and a cell: the forms that are 0 where a ray is at the isovalue, two coordinates of the
 * ray's space and the value less it. rounding: by how much their coefficients may err. */
typedef struct hex_forms {
    vd f[3][TRILINEAR], rounding[3];
} hex_forms;

typedef struct hex_met {
    md unknown;  /* rays that may meet it, and how often */
    md once;     /* rays that meet it once, */
    vd t, at[3]; /* where, */
    md enters;   /* and whether the value rises there, if the cell is right-handed */
} hex_met;

SIMD void hex_sight_of(const hexahedron *cell, const double o[3], hex_sight *out) {
    vd corner[HEX_CORNERS];
    for (int a = 0; a < 3; a++) {
        for (int c = 0; c < HEX_CORNERS; c++)
            corner[c] = d_set(cell->p[c][a] - o[a]);
        trilinear_of(corner, out->away[a]);
        out->size[a] = trilinear_size(out->away[a]);
    }
    for (int c = 0; c < HEX_CORNERS; c++)
        corner[c] = d_set(cell->value[c]);
    trilinear_of(corner, out->value);
    out->value_size = trilinear_size(out->value);
}

/* A coordinate's coefficients err by some roundings of the way from the origin, as
 * sheared_ray_place() does. */
SIMD void hex_forms_of(const hex_sight *cell, const hex_rays *rays, double isovalue,
                       hex_forms *out) {
    const vd share = d_set(0x1p-48);
    const vd *along = cell->away[rays->axis[2]];
    for (int k = 0; k < 2; k++) {
        const vd *across = cell->away[rays->axis[k]];
        for (int c = 0; c < TRILINEAR; c++)
            out->f[k][c] = across[c] - rays->slope[k] * along[c];
        out->rounding[k] =
            share * (cell->size[rays->axis[k]] + d_abs(rays->slope[k]) * cell->size[rays->axis[2]]);
    }
    for (int c = 0; c < TRILINEAR; c++)
        out->f[2][c] = cell->value[c];
    out->f[2][0] = cell->value[0] - d_set(isovalue);
    out->rounding[2] = share * (cell->value_size + d_set(fabs(isovalue)));
}

/* A parameter's bounds where all forms are 0, not yet cut to the box. */
SIMD void hex_bounds(const trilinear_bend *b, int i, vd *lo, vd *hi) {
    const vd room = d_set(TRILINEAR_ROOM), one = d_set(1.0);
    const vd rest = ((b->two[0][i] + b->two[1][i]) + b->two[2][i]) + b->all[i];
    const vd stray = rest + room * (one + rest + d_abs(b->at[i]));
    *lo = b->at[i] - stray;
    *hi = b->at[i] + stray;
}

/* Returns the rays that may meet the isosurface in the cell: hex_meet_lanes() finds nothing for all
 * others. */
SIMD md hex_may_meet(hex_forms *forms) {
    trilinear_bend b;
    const md good = trilinear_bend_of(forms->f, forms->rounding, &b);
    md none = md_and_not(good, good);
    for (int i = 0; i < 3; i++) {
        vd lo, hi;
        hex_bounds(&b, i, &lo, &hi);
        none = md_or(none, md_or(d_gt(lo, d_set(1.0)), d_lt(hi, d_set(-1.0))));
    }
    return md_and_not(md_of_bits(~0u), md_and(good, none));
}

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
SIMD md hex_shrink(const hex_forms *all, md left, md *unknown, vd x[3], vd *det) {
    enum { BOXES = 4 };
    /* Sides of boxes, each relative to that of the one before; and what content is not worth a
     * look.
     */
    const double narrowest = 0x1p-4, worth = 0.5;
    const vd zero = d_set(0.0), one = d_set(1.0), half = d_set(0.5);
    hex_forms part = *all;
    hex_box box = {{zero, zero, zero}, {one, one, one}};
    md found = md_and_not(left, left);
    for (int n = 1;; n++) {
        vd middle[3], width[3], start[3];
        trilinear_bend b;
        const md good = trilinear_bend_of(part.f, part.rounding, &b);
        *unknown = md_or(*unknown, md_and_not(left, good));
        left = md_and(left, good);
        for (int i = 0; i < 3; i++) {
            vd lo, hi;
            hex_bounds(&b, i, &lo, &hi);
            lo = d_max(d_set(-1.0), lo);
            hi = d_min(one, hi);
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
SIMD void hex_meet_lanes(const hex_sight *cell, const hex_rays *rays, const hex_forms *forms,
                         md asked, hex_met *out) {
    /* What bounds of a single root's parameters may err by: bent forms move it. */
    const double room = TRILINEAR_STRETCH * TRILINEAR_ROOM;
    const vd half = d_set(0.5), zero = d_set(0.0);
    vd x[3] = {zero, zero, zero}, det = zero, most = zero;
    out->unknown = out->enters = md_and_not(asked, asked);
    const md found = hex_shrink(forms, asked, &out->unknown, x, &det);
    for (int i = 0; i < 3; i++) {
        most = d_max(d_abs(x[i]), most);
        out->at[i] = half + half * x[i];
    }
    const md near = md_and(found, d_gt(most, d_set(1.0 - room)));
    out->unknown = md_or(out->unknown, md_and(near, d_lt(most, d_set(1.0 + room))));
    out->once = md_and_not(found, near);
    out->t = trilinear_at(cell->away[rays->axis[2]], x) / rays->d;
    /* Right-handed in the rays' space where the ray goes up its third axis. */
    out->enters = md_xor(d_lt(det, zero), d_gt(rays->d, zero));
}

#endif
#endif
