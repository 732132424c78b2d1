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
    vd size[3], value_size; /* trilinear_size() of each, */
    vd bent[3], value_bent; /* and of it what belongs to products */
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
    for (int a = 0; a < 3; a++) {
        vd away[HEX_CORNERS];
        for (int c = 0; c < HEX_CORNERS; c++)
            away[c] = d_set(cell->p[c][a] - o[a]);
        trilinear_of(away, out->away[a]);
    }
    vd value[HEX_CORNERS];
    for (int c = 0; c < HEX_CORNERS; c++)
        value[c] = d_set(cell->value[c]);
    trilinear_of(value, out->value);
    for (int a = 0; a < 3; a++) {
        out->size[a] = trilinear_size(out->away[a]);
        out->bent[a] = trilinear_bent(out->away[a]);
    }
    out->value_size = trilinear_size(out->value);
    out->value_bent = trilinear_bent(out->value);
}

/* By how much the coefficients of form k err: a coordinate's by some roundings of the way from the
 * origin, as sheared_ray_place() does. */
SIMD vd hex_rounding(const hex_sight *cell, const hex_rays *rays, double isovalue, int k) {
    const vd share = d_set(0x1p-48);
    if (k == 2)
        return share * (cell->value_size + d_set(fabs(isovalue)));
    return share * (cell->size[rays->axis[k]] + d_abs(rays->slope[k]) * cell->size[rays->axis[2]]);
}

/* Coefficient c of form k. */
SIMD vd hex_coefficient(const hex_sight *cell, const hex_rays *rays, double isovalue, int k,
                        int c) {
    if (k == 2)
        return cell->value[c] - d_set(c == 0 ? isovalue : 0.0);
    return cell->away[rays->axis[k]][c] - rays->slope[k] * cell->away[rays->axis[2]][c];
}

/* The sum of the sizes of those that belong to products, or more. */
SIMD vd hex_products(const hex_sight *cell, const hex_rays *rays, int k) {
    if (k == 2)
        return cell->value_bent;
    return cell->bent[rays->axis[k]] + d_abs(rays->slope[k]) * cell->bent[rays->axis[2]];
}

SIMD void hex_forms_of(const hex_sight *cell, const hex_rays *rays, double isovalue,
                       hex_forms *out) {
    for (int k = 0; k < 3; k++) {
        for (int c = 0; c < TRILINEAR; c++)
            out->f[k][c] = hex_coefficient(cell, rays, isovalue, k, c);
        out->rounding[k] = hex_rounding(cell, rays, isovalue, k);
    }
}

/* Returns the rays that may meet the isosurface in the cell, by looser bounds than
 * hex_meet_lanes(), which finds nothing for all others, in less time. The Jacobian's inverse in the
 * middle makes parameters of what is linear in the forms; the rest, products and rounding, is no
 * more than the sizes of its coefficients. */
SIMD md hex_may_meet(const hex_sight *cell, const hex_rays *rays, double isovalue) {
    const vd one = d_set(1.0), room = d_set(TRILINEAR_ROOM);
    vd first[3], rest[3], slope[3][3], inverse[3][3];
    for (int k = 0; k < 3; k++) {
        first[k] = hex_coefficient(cell, rays, isovalue, k, 0);
        for (int a = 0; a < 3; a++)
            slope[k][a] = hex_coefficient(cell, rays, isovalue, k, 1 << a);
        rest[k] = hex_rounding(cell, rays, isovalue, k) + hex_products(cell, rays, k);
    }
    const vd det = trilinear_invert(slope, inverse);
    const md sharp = md_and_not(md_of_bits(~0u), trilinear_is_flat(slope, det));
    md far = md_and_not(sharp, sharp);
    for (int i = 0; i < 3; i++) {
        const vd at =
            d_abs((inverse[0][i] * first[0] + inverse[1][i] * first[1]) + inverse[2][i] * first[2]);
        const vd stray = (d_abs(inverse[0][i]) * rest[0] + d_abs(inverse[1][i]) * rest[1]) +
                         d_abs(inverse[2][i]) * rest[2];
        far = md_or(far, d_gt(at - stray, one + room * (one + stray + at)));
    }
    return md_and_not(md_of_bits(~0u), md_and(sharp, far));
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

/* Look at rays one box after the other, beginning with one in which the forms are part: boxes
 * become smaller until one has no root, or a single one, which is found. Sets x, in the whole
 * cell's parameters, and det of rays that have one; returns these. *unknown: the rays of `left` of
 * which nothing is known. */
SIMD md hex_shrink(const hex_forms *all, hex_forms part, hex_box box, md left, md *unknown, vd x[3],
                   vd *det) {
    enum { BOXES = 4 };
    /* Sides of boxes, each relative to that of the one before; and what content is not worth a
     * look.
     */
    const double narrowest = 0x1p-4, worth = 0.5;
    const vd one = d_set(1.0), half = d_set(0.5), room = d_set(TRILINEAR_ROOM);
    md found = md_and_not(left, left);
    *unknown = found;
    for (int n = 1;; n++) {
        vd middle[3], width[3], start[3];
        trilinear_bend b;
        const md good = trilinear_bend_of(part.f, part.rounding, &b);
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

/* Roots of rays: of which are known, and where. */
typedef struct hex_found {
    md once, unknown;
    vd x[3], det;
} hex_found;

/* The roots in a box. One that is too near to its sides to tell is not known: bounds of a single
 * root's parameters err by more than those of a form's, as bent forms move it. */
SIMD void hex_find(const hex_forms *all, const hex_forms *part, const hex_box *box, md asked,
                   hex_found *out) {
    const double room = TRILINEAR_STRETCH * TRILINEAR_ROOM;
    vd most = d_set(0.0);
    for (int i = 0; i < 3; i++)
        out->x[i] = box->middle[i];
    out->det = most;
    const md found = hex_shrink(all, *part, *box, asked, &out->unknown, out->x, &out->det);
    for (int i = 0; i < 3; i++)
        most = d_max(d_abs(out->x[i] - box->middle[i]) / box->half[i], most);
    const md near = md_and(found, d_gt(most, d_set(1.0 - room)));
    out->unknown = md_or(out->unknown, md_and(near, d_lt(most, d_set(1.0 + room))));
    out->once = md_and_not(found, near);
}

/* The roots in a cell that bends too much as a whole, by its eight parts: known where each part has
 * none but one, which has one. */
static inline void hex_find_in_parts(const hex_forms *all, md asked, hex_found *out) {
    const vd half = d_set(0.5);
    md once = md_and_not(asked, asked), left = asked;
    for (unsigned n = 0; n < 8 && md_bits(left); n++) {
        hex_forms part = *all;
        hex_box box;
        hex_found in;
        for (int i = 0; i < 3; i++) {
            box.middle[i] = d_set(n >> i & 1 ? 0.5 : -0.5);
            box.half[i] = half;
        }
        for (int k = 0; k < 3; k++)
            trilinear_restrict(part.f[k], box.middle, box.half);
        hex_find(all, &part, &box, left, &in);
        left = md_and_not(left, md_or(in.unknown, md_and(once, in.once)));
        once = md_or(once, in.once);
        for (int i = 0; i < 3; i++)
            out->x[i] = d_select(in.once, in.x[i], out->x[i]);
        out->det = d_select(in.once, in.det, out->det);
    }
    out->once = md_or(out->once, md_and(once, left));
    out->unknown = md_and_not(out->unknown, left);
}

/* Of the rays `asked`. The cell must not be folded. */
SIMD void hex_meet_lanes(const hex_sight *cell, const hex_rays *rays, const hex_forms *forms,
                         md asked, hex_met *out) {
    const vd half = d_set(0.5), zero = d_set(0.0), one = d_set(1.0);
    const hex_box whole = {{zero, zero, zero}, {one, one, one}};
    hex_found found;
    hex_find(forms, forms, &whole, asked, &found);
    if (md_bits(found.unknown))
        hex_find_in_parts(forms, found.unknown, &found);
    out->unknown = found.unknown;
    out->once = found.once;
    for (int i = 0; i < 3; i++)
        out->at[i] = half + half * found.x[i];
    out->t = trilinear_at(cell->away[rays->axis[2]], found.x) / rays->d;
    /* Right-handed in the rays' space where the ray goes up its third axis. */
    out->enters = md_xor(d_lt(found.det, zero), d_gt(rays->d, zero));
}

#endif
#endif
