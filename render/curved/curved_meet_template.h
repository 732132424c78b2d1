/* curved_meet_template.h - VD_N rays and a curved cell: where each meets an isosurface once, or
 * surely not at all. curved_meet.h says how that is known. In units of an ISA (simd.h), or of one
 * ray (simd_one.h, which such a unit includes first): the same bits.
 *
 * A cell has a box of parameters from -1 to 1. A hexahedron is all of it, its forms have TRILINEAR
 * terms. A quadratic tet is the one whose corners are every other corner of the box; its forms have
 * FORM_TERMS, and the share of corner n is (1 + curved_corner(n) * x) / 4. `terms` tells cells
 * apart; it is constant.
 */
#ifndef RENDER_CURVED_CURVED_MEET_TEMPLATE_H
#define RENDER_CURVED_CURVED_MEET_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD

#include <math.h>
#include <string.h>

#include "formats/base/form_template.h"
#include "formats/curved/curved_cell.h"

/* A cell from an origin: the forms of its places, and of its values. */
typedef struct curved_sight {
    vd away[3][FORM_TERMS], value[FORM_TERMS];
    vd size[3], value_size; /* form_size() of each, */
    vd bent[3], value_bent; /* and of it what belongs to products and squares */
} curved_sight;

/* VD_N rays of one origin and one longest axis, as sheared_ray. */
typedef struct curved_rays {
    int axis[3];
    vd slope[2], d;
} curved_rays;

/* Of rays and a cell: the forms that are 0 where a ray is at the isovalue, two coordinates of the
 * ray's space and the value less it. rounding: by how much their coefficients may err. */
typedef struct curved_forms {
    vd f[3][FORM_TERMS], rounding[3];
} curved_forms;

typedef struct curved_met {
    md unknown;  /* rays that may meet it, and how often */
    md once;     /* rays that meet it once, */
    vd t, at[3]; /* where, */
    md enters;   /* and whether the value rises there, if the cell is right-handed */
} curved_met;

/* ---- A cell ---- */

static inline void curved_measure(curved_sight *s, int terms) {
    for (int a = 0; a < 3; a++) {
        s->size[a] = form_size(s->away[a], terms);
        s->bent[a] = form_bent(s->away[a], terms);
    }
    s->value_size = form_size(s->value, terms);
    s->value_bent = form_bent(s->value, terms);
}

static inline void curved_sight_of_hexahedron(const hexahedron *cell, const double o[3],
                                              curved_sight *out) {
    vd value[HEX_CORNERS];
    for (int a = 0; a < 3; a++) {
        vd away[HEX_CORNERS];
        for (int c = 0; c < HEX_CORNERS; c++)
            away[c] = d_set(cell->p[c][a] - o[a]);
        form_of_corners(away, out->away[a]);
    }
    for (int c = 0; c < HEX_CORNERS; c++)
        value[c] = d_set(cell->value[c]);
    form_of_corners(value, out->value);
    curved_measure(out, TRILINEAR);
}

/* Corner n of a tet in the box, by coordinate. */
static inline double curved_corner(int n, int a) {
    return n == 0 || n == 1 + (a + 1) % 3 ? -1.0 : 1.0;
}

/* Set the sums, and for each parameter the sums, with its signs, of what four corners have. */
static inline void curved_sums(const double v[QUADRATIC_CORNERS], double sum[QUADRATIC_CORNERS]) {
    sum[0] = (v[0] + v[1]) + (v[2] + v[3]);
    for (int a = 0; a < 3; a++)
        sum[1 + a] = (curved_corner(0, a) * v[0] + curved_corner(1, a) * v[1]) +
                     (curved_corner(2, a) * v[2] + curved_corner(3, a) * v[3]);
}

/* The form of Bernstein coefficients. They are those of all products of two shares; shares are sums
 * of parameters. */
static inline void curved_form_of(const double bernstein[QUADRATIC_NODES], vd out[FORM_TERMS]) {
    double sum[QUADRATIC_CORNERS][QUADRATIC_CORNERS], all[QUADRATIC_CORNERS][QUADRATIC_CORNERS];
    for (int n = 0; n < QUADRATIC_CORNERS; n++) {
        double row[QUADRATIC_CORNERS];
        for (int k = 0; k < QUADRATIC_CORNERS; k++)
            row[k] = bernstein[quadratic_coefficient(n, k)];
        curved_sums(row, sum[n]);
    }
    for (int k = 0; k < QUADRATIC_CORNERS; k++) {
        const double column[QUADRATIC_CORNERS] = {sum[0][k], sum[1][k], sum[2][k], sum[3][k]};
        curved_sums(column, all[k]);
    }
    out[0] = d_set(0.0625 * all[0][0]);
    out[7] = d_set(0.0);
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3;
        out[1 << a] = d_set(0.125 * all[0][1 + a]);
        out[1 << a | 1 << b] = d_set(0.125 * all[1 + a][1 + b]);
        out[TRILINEAR + a] = d_set(0.0625 * all[1 + a][1 + a]);
    }
}

static inline void curved_sight_of_tet(const quadratic_tet *cell, const double o[3],
                                       curved_sight *out) {
    const unsigned straight = quadratic_straight_edges(cell);
    double v[QUADRATIC_NODES], form[QUADRATIC_NODES];
    for (int a = 0; a < 3; a++) {
        for (int n = 0; n < QUADRATIC_NODES; n++)
            v[n] = cell->p[n][a] - o[a];
        quadratic_form(v, straight, form);
        curved_form_of(form, out->away[a]);
    }
    quadratic_form(cell->value, 0, form);
    curved_form_of(form, out->value);
    curved_measure(out, FORM_TERMS);
}

/* The product with corner n of a tet. */
SIMD vd curved_toward(int n, const vd x[3]) {
    return (d_set(curved_corner(n, 0)) * x[0] + d_set(curved_corner(n, 1)) * x[1]) +
           d_set(curved_corner(n, 2)) * x[2];
}

/* ---- Rays and a cell ---- */

/* By how much the coefficients of form k err: a coordinate's by some roundings of the way from the
 * origin, as sheared_ray_place() does. */
SIMD vd curved_rounding(const curved_sight *cell, const curved_rays *rays, double isovalue, int k) {
    const vd share = d_set(0x1p-48);
    if (k == 2)
        return share * (cell->value_size + d_set(fabs(isovalue)));
    return share * (cell->size[rays->axis[k]] + d_abs(rays->slope[k]) * cell->size[rays->axis[2]]);
}

/* Coefficient c of form k. */
SIMD vd curved_coefficient(const curved_sight *cell, const curved_rays *rays, double isovalue,
                           int k, int c) {
    if (k == 2)
        return cell->value[c] - d_set(c == 0 ? isovalue : 0.0);
    return cell->away[rays->axis[k]][c] - rays->slope[k] * cell->away[rays->axis[2]][c];
}

/* The sum of the sizes of those that belong to products, or more. */
SIMD vd curved_products(const curved_sight *cell, const curved_rays *rays, int k) {
    if (k == 2)
        return cell->value_bent;
    return cell->bent[rays->axis[k]] + d_abs(rays->slope[k]) * cell->bent[rays->axis[2]];
}

SIMD void curved_forms_of(const curved_sight *cell, int terms, const curved_rays *rays,
                          double isovalue, curved_forms *out) {
    for (int k = 0; k < 3; k++) {
        for (int c = 0; c < terms; c++)
            out->f[k][c] = curved_coefficient(cell, rays, isovalue, k, c);
        out->rounding[k] = curved_rounding(cell, rays, isovalue, k);
    }
}

/* Returns where a point is, surely, beyond a hexahedron's faces, or a tet's. first, rest: what the
 * inverse makes the way from the middle to the point, and of how far that may be off. */
SIMD md curved_is_beyond(vd inverse[3][3], int terms, const vd first[3], const vd rest[3]) {
    const vd one = d_set(1.0), room = d_set(FORM_ROOM);
    md far = md_of_bits(0u);
    for (int i = 0; i < (terms == TRILINEAR ? 3 : QUADRATIC_CORNERS); i++) {
        vd row[3];
        for (int k = 0; k < 3; k++)
            row[k] = terms == TRILINEAR ? inverse[k][i] : curved_toward(i, inverse[k]);
        const vd along = (row[0] * first[0] + row[1] * first[1]) + row[2] * first[2];
        const vd at = terms == TRILINEAR ? d_abs(along) : along;
        const vd stray =
            (d_abs(row[0]) * rest[0] + d_abs(row[1]) * rest[1]) + d_abs(row[2]) * rest[2];
        far = md_or(far, d_gt(at - stray, one + room * (one + stray + d_abs(at))));
    }
    return far;
}

/* Returns the rays that may meet the isosurface in the cell, by looser bounds than
 * curved_meet_lanes(), which finds nothing for all others, in less time. The Jacobian's inverse in
 * the middle makes parameters of what is linear in the forms; the rest, products, squares and
 * rounding, is no more than the sizes of its coefficients. */
SIMD md curved_may_meet(const curved_sight *cell, int terms, const curved_rays *rays,
                        double isovalue) {
    vd first[3], rest[3], slope[3][3], inverse[3][3];
    for (int k = 0; k < 3; k++) {
        first[k] = curved_coefficient(cell, rays, isovalue, k, 0);
        for (int a = 0; a < 3; a++)
            slope[k][a] = curved_coefficient(cell, rays, isovalue, k, 1 << a);
        rest[k] = curved_rounding(cell, rays, isovalue, k) + curved_products(cell, rays, k);
    }
    const vd det = form_invert(slope, inverse);
    const md flat = form_is_flat(slope, det);
    return md_or(flat, md_and_not(md_of_bits(~0u), curved_is_beyond(inverse, terms, first, rest)));
}

/* A box of parameters in which a form's own are -1 to 1. */
typedef struct curved_box {
    vd middle[3], half[3];
} curved_box;

/* Roots are single in a box that is larger by this factor. */
#define CURVED_BEYOND 1.125

/* Newton's method from x, to a step whose square is below rounding. Returns the rays of `left` for
 * which it neither leaves the box nor takes long. */
SIMD md curved_newton(const curved_forms *all, int terms, const curved_box *box, md left, vd x[3]) {
    enum { STEPS = 8 };
    md found = md_and_not(left, left);
    for (int n = 0; n < STEPS; n++) {
        vd slope[3][3], column[3][3], off[3], most = d_set(0.0);
        md within = left;
        for (int k = 0; k < 3; k++) {
            off[k] = form_at(all->f[k], terms, x);
            form_slope(all->f[k], terms, x, slope[k]);
        }
        (void)form_invert(slope, column);
        for (int i = 0; i < 3; i++) {
            const vd by = (column[0][i] * off[0] + column[1][i] * off[1]) + column[2][i] * off[2];
            x[i] = d_select(left, x[i] - by, x[i]);
            most = d_max(d_abs(by), most);
            within = md_and(
                within, d_le(d_abs(x[i] - box->middle[i]), d_set(CURVED_BEYOND) * box->half[i]));
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
SIMD md curved_shrink(const curved_forms *all, int terms, curved_forms part, curved_box box,
                      md left, md *unknown, vd x[3], vd *det) {
    enum { BOXES = 4 };
    /* Sides of boxes, each relative to that of the one before; and what content is not worth a
     * look.
     */
    const double narrowest = 0x1p-4, worth = 0.5;
    const vd one = d_set(1.0), half = d_set(0.5), room = d_set(FORM_ROOM);
    md found = md_and_not(left, left);
    *unknown = found;
    for (int n = 1;; n++) {
        vd middle[3], width[3], start[3];
        form_bend b;
        const md good = form_bend_of(part.f, terms, part.rounding, &b);
        *unknown = md_or(*unknown, md_and_not(left, good));
        left = md_and(left, good);
        for (int i = 0; i < 3; i++) {
            const vd rest = form_rest(&b, terms, i);
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
        const md single = md_and(left, form_is_single(&b, terms, CURVED_BEYOND));
        if (md_bits(single)) {
            const md roots = curved_newton(all, terms, &box, single, start);
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
            form_restrict(part.f[k], terms, middle, width);
        for (int i = 0; i < 3; i++) {
            box.middle[i] = box.middle[i] + box.half[i] * middle[i];
            box.half[i] = box.half[i] * width[i];
        }
    }
}

/* Roots of rays: of which are known, and where. */
typedef struct curved_found {
    md once, unknown;
    vd x[3], det;
} curved_found;

/* How far out a place in a box is: less than 1 in the cell and in the box, 1 at a side of either.
 */
SIMD vd curved_outness(int terms, const curved_box *box, const vd x[3]) {
    vd most = d_set(0.0);
    for (int i = 0; i < 3; i++)
        most = d_max(d_abs(x[i] - box->middle[i]) / box->half[i], most);
    for (int n = 0; n < QUADRATIC_CORNERS && terms != TRILINEAR; n++)
        most = d_max(d_set(0.0) - curved_toward(n, x), most);
    return most;
}

/* The roots in a box. One that is too near to a side to tell is not known: bounds of a single
 * root's parameters err by more than those of a form's, as bent forms move it. */
SIMD void curved_find(const curved_forms *all, int terms, const curved_forms *part,
                      const curved_box *box, md asked, curved_found *out) {
    const double room = FORM_STRETCH * FORM_ROOM * (terms == TRILINEAR ? 1.0 : 3.0);
    for (int i = 0; i < 3; i++)
        out->x[i] = box->middle[i];
    out->det = d_set(0.0);
    const md found =
        curved_shrink(all, terms, *part, *box, asked, &out->unknown, out->x, &out->det);
    const vd most = curved_outness(terms, box, out->x);
    const md near = md_and(found, d_gt(most, d_set(1.0 - room)));
    out->unknown = md_or(out->unknown, md_and(near, d_lt(most, d_set(1.0 + room))));
    out->once = md_and_not(found, near);
}

/* The roots in a cell that bends too much as a whole, by its eight parts: known where each part has
 * none but one, which has one. */
static inline void curved_find_in_parts(const curved_forms *all, int terms, md asked,
                                        curved_found *out) {
    const vd half = d_set(0.5);
    md once = md_and_not(asked, asked), left = asked;
    for (unsigned n = 0; n < 8 && md_bits(left); n++) {
        curved_forms part = *all;
        curved_box box;
        curved_found in;
        for (int i = 0; i < 3; i++) {
            box.middle[i] = d_set(n >> i & 1 ? 0.5 : -0.5);
            box.half[i] = half;
        }
        for (int k = 0; k < 3; k++)
            form_restrict(part.f[k], terms, box.middle, box.half);
        curved_find(all, terms, &part, &box, left, &in);
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
SIMD void curved_meet_lanes(const curved_sight *cell, int terms, const curved_rays *rays,
                            const curved_forms *forms, md asked, curved_met *out) {
    const vd half = d_set(0.5), zero = d_set(0.0), one = d_set(1.0);
    const curved_box whole = {{zero, zero, zero}, {one, one, one}};
    curved_found found;
    curved_find(forms, terms, forms, &whole, asked, &found);
    if (md_bits(found.unknown))
        curved_find_in_parts(forms, terms, found.unknown, &found);
    out->unknown = found.unknown;
    out->once = found.once;
    for (int i = 0; i < 3; i++)
        out->at[i] = terms == TRILINEAR ? half + half * found.x[i]
                                        : d_set(0.25) + d_set(0.25) * curved_toward(i + 1, found.x);
    out->t = form_at(cell->away[rays->axis[2]], terms, found.x) / rays->d;
    /* Right-handed in the rays' space where the ray goes up its third axis. */
    out->enters = md_xor(d_lt(found.det, zero), d_gt(rays->d, zero));
}

#endif
#endif
