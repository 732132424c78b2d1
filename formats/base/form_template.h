/* form_template.h - trilinear forms by their coefficients, and how far three of them are from
 * linear: VD_N at a time, in units of an ISA (simd.h), or one (simd_one.h, which such a unit
 * includes first). The same bits.
 *
 * Coefficient c belongs to the product of those parameters that are the bits of c; parameters are
 * from -1 to 1, 0 in the middle. Three forms of three parameters are a map. Its inverse Jacobian in
 * the middle makes of the map the parameters themselves and a bent rest.
 */
#ifndef FORMATS_BASE_FORM_TEMPLATE_H
#define FORMATS_BASE_FORM_TEMPLATE_H

#include "formats/base/simd.h"

enum { TRILINEAR = 8, FORM_TERMS = TRILINEAR + 3 };

#ifdef SIMD

/* ---- A form ---- */

/* The trilinear form that has these values at the corners; corner c is where the parameters that
 * are bits of c are 1, the others -1. */
SIMD void form_of_corners(const vd v[TRILINEAR], vd form[TRILINEAR]) {
    vd pair[TRILINEAR], face[TRILINEAR];
    const vd share = d_set(0.125);
    for (int c = 0; c < TRILINEAR; c += 2) {
        pair[c] = v[c + 1] + v[c];
        pair[c + 1] = v[c + 1] - v[c];
    }
    for (int c = 0; c < TRILINEAR; c += 4)
        for (int i = 0; i < 2; i++) {
            face[c + i] = pair[c + 2 + i] + pair[c + i];
            face[c + 2 + i] = pair[c + 2 + i] - pair[c + i];
        }
    for (int i = 0; i < 4; i++) {
        form[i] = share * (face[4 + i] + face[i]);
        form[4 + i] = share * (face[4 + i] - face[i]);
    }
}

/* Its value. (hexahedron_at() has parameters from 0 to 1, and corners.) */
SIMD vd form_at(const vd f[FORM_TERMS], int terms, const vd x[3]) {
    const vd low = (f[0] + x[0] * f[1]) + x[1] * (f[2] + x[0] * f[3]);
    const vd high = (f[4] + x[0] * f[5]) + x[1] * (f[6] + x[0] * f[7]);
    vd sum = low + x[2] * high;
    for (int c = TRILINEAR; c < terms; c++)
        sum = sum + x[c - TRILINEAR] * x[c - TRILINEAR] * f[c];
    return sum;
}

/* Its derivatives by the parameters. */
SIMD void form_slope(const vd f[FORM_TERMS], int terms, const vd x[3], vd slope[3]) {
    slope[0] = (f[1] + x[1] * f[3]) + x[2] * (f[5] + x[1] * f[7]);
    slope[1] = (f[2] + x[0] * f[3]) + x[2] * (f[6] + x[0] * f[7]);
    slope[2] = (f[4] + x[0] * f[5]) + x[1] * (f[6] + x[0] * f[7]);
    for (int c = TRILINEAR; c < terms; c++)
        slope[c - TRILINEAR] = slope[c - TRILINEAR] + (x[c - TRILINEAR] + x[c - TRILINEAR]) * f[c];
}

/* The sum of the sizes of those coefficients that belong to products and squares. */
SIMD vd form_bent(const vd f[FORM_TERMS], int terms) {
    vd sum = (d_abs(f[3]) + d_abs(f[5])) + (d_abs(f[6]) + d_abs(f[7]));
    for (int c = TRILINEAR; c < terms; c++)
        sum = sum + d_abs(f[c]);
    return sum;
}

/* The sum of all coefficients' sizes. */
SIMD vd form_size(const vd f[FORM_TERMS], int terms) {
    return ((d_abs(f[0]) + d_abs(f[1])) + (d_abs(f[2]) + d_abs(f[4]))) + form_bent(f, terms);
}

/* Make it the same form of parameters that are -1 to 1 in a part of the box. */
SIMD void form_restrict(vd f[FORM_TERMS], int terms, const vd middle[3], const vd half[3]) {
    for (int c = TRILINEAR; c < terms; c++) {
        const int a = c - TRILINEAR;
        f[0] = f[0] - middle[a] * middle[a] * f[c];
        f[1 << a] = f[1 << a] + (middle[a] + middle[a]) * f[c];
        f[c] = half[a] * half[a] * f[c];
    }
    for (int a = 0; a < 3; a++)
        for (int c = 0; c < TRILINEAR; c++)
            if (!(c & 1 << a)) {
                f[c] = f[c] + middle[a] * f[c | 1 << a];
                f[c | 1 << a] = f[c | 1 << a] * half[a];
            }
}

/* The derivatives of what has these values at the corners, by parameters from 0 to 1:
 * hexahedron_slope(). */
SIMD void form_rise_of_corners(const double v[TRILINEAR], const vd at[3], vd slope[3]) {
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3, c = (a + 2) % 3;
        double along[4];
        for (int i = 0; i < 4; i++) {
            const int corner = (i & 1) << b | (i >> 1) << c;
            along[i] = v[corner | 1 << a] - v[corner];
        }
        const vd low = d_set(along[0]) + at[b] * d_set(along[1] - along[0]);
        const vd high = d_set(along[2]) + at[b] * d_set(along[3] - along[2]);
        slope[a] = low + at[c] * (high - low);
    }
}

/* ---- Three of them ---- */

SIMD void form_cross(const vd a[3], const vd b[3], vd out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* The inverse of a Jacobian: column k is inverse[k]. Returns the determinant; where it is 0 or
 * nearly, the inverse is not finite, or useless. */
SIMD vd form_invert(vd slope[3][3], vd inverse[3][3]) {
    for (int k = 0; k < 3; k++)
        form_cross(slope[(k + 1) % 3], slope[(k + 2) % 3], inverse[k]);
    const vd det =
        slope[0][0] * inverse[0][0] + slope[0][1] * inverse[0][1] + slope[0][2] * inverse[0][2];
    const vd share = d_set(1.0) / det;
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++)
            inverse[k][i] = inverse[k][i] * share;
    return det;
}

/* All of it errs by FORM_ROOM of itself and of 1 at most. */
typedef struct form_bend {
    vd at[3];        /* the parameters where all forms would be 0, without the rest */
    vd two[3][3];    /* of the rest: [n][i]: in parameter i, the size of its coefficient of the
                            product of the two other than n; */
    vd square[3][3]; /* of the square of n, if there are squares; */
    vd all[3];       /* and of the product of all three */
    vd det;          /* the Jacobian's determinant in the middle */
} form_bend;

#define FORM_ROOM 0x1p-20

/* What the inverse makes of one coefficient of each form. */
SIMD void form_straighten(vd inverse[3][3], vd f[3][FORM_TERMS], int c, vd out[3]) {
    for (int i = 0; i < 3; i++)
        out[i] = (inverse[0][i] * f[0][c] + inverse[1][i] * f[1][c]) + inverse[2][i] * f[2][c];
}

SIMD vd form_row_size(const vd a[3]) {
    return d_abs(a[0]) + d_abs(a[1]) + d_abs(a[2]);
}

/* Returns where a Jacobian is flat: at this share of its rows' sizes the determinant has 2^-33 of
 * rounding, and so has the inverse times the Jacobian. */
SIMD md form_is_flat(vd slope[3][3], vd det) {
    const vd least = d_set(0x1p-16) *
                     (form_row_size(slope[0]) * form_row_size(slope[1]) * form_row_size(slope[2]));
    return md_and_not(md_of_bits(~0u), d_gt(d_abs(det), least));
}

/* rounding: by how much a form's coefficients may err. Returns where the Jacobian is not flat, nor
 * rounding too large. */
SIMD md form_bend_of(vd form[3][FORM_TERMS], int terms, const vd rounding[3], form_bend *out) {
    const vd most = d_set(0.5 * FORM_ROOM), zero = d_set(0.0); /* of what rounding makes */
    vd slope[3][3], inverse[3][3];
    for (int k = 0; k < 3; k++) {
        slope[k][0] = form[k][1];
        slope[k][1] = form[k][2];
        slope[k][2] = form[k][4];
    }
    out->det = form_invert(slope, inverse);
    md good = md_and_not(md_of_bits(~0u), form_is_flat(slope, out->det));
    form_straighten(inverse, form, 0, out->at);
    form_straighten(inverse, form, 6, out->two[0]);
    form_straighten(inverse, form, 5, out->two[1]);
    form_straighten(inverse, form, 3, out->two[2]);
    form_straighten(inverse, form, 7, out->all);
    for (int c = TRILINEAR; c < terms; c++)
        form_straighten(inverse, form, c, out->square[c - TRILINEAR]);
    for (int i = 0; i < 3; i++) {
        const vd off = d_abs(inverse[0][i]) * rounding[0] + d_abs(inverse[1][i]) * rounding[1] +
                       d_abs(inverse[2][i]) * rounding[2];
        good = md_and(good, d_le(off, most));
        for (int n = 0; n < 3; n++)
            out->two[n][i] = d_abs(out->two[n][i]);
        for (int c = TRILINEAR; c < terms; c++)
            out->square[c - TRILINEAR][i] = d_abs(out->square[c - TRILINEAR][i]);
        out->all[i] = d_abs(out->all[i]);
        out->at[i] = zero - out->at[i];
    }
    return good;
}

/* By how much the rest may move parameter i in the box. */
SIMD vd form_rest(const form_bend *b, int terms, int i) {
    vd sum = ((b->two[0][i] + b->two[1][i]) + b->two[2][i]) + b->all[i];
    for (int c = TRILINEAR; c < terms; c++)
        sum = sum + b->square[c - TRILINEAR][i];
    return sum;
}

/* Where two places of the box are apart by this times what the parameters of their values are, at
 * most: in maps that form_is_single(). */
#define FORM_STRETCH 64.0

/* Returns where the map has no value twice in the box that is larger by a factor; nor is any matrix
 * singular there whose columns are its derivatives, each at a place of its own.
 *
 * Two places with one value would differ by what the rest changes between them: by no more than a
 * matrix, the bounds of the rest's slopes, times their difference. Where a power of the matrix is
 * small there is no such difference. Likewise for what a singular matrix makes 0. How far two
 * places can be apart whose values are near follows from the sum of all powers, a geometric series.
 */
SIMD md form_is_single(const form_bend *b, int terms, double larger) {
    enum { POWERS = 4 };
    const double share = 0.75; /* what the power may be */
    const vd once = d_set(larger), twice = d_set(larger * larger), zero = d_set(0.0);
    vd size[3] = {d_set(1.0), d_set(1.0), d_set(1.0)}, lower[3] = {zero, zero, zero};
    md single = md_of_bits(~0u);
    for (int power = 0; power < POWERS; power++) {
        const vd sum[3] = {size[1] + size[2], size[2] + size[0], size[0] + size[1]};
        const vd every = size[0] + sum[0];
        vd next[3];
        for (int i = 0; i < 3; i++) {
            vd rise = (b->two[0][i] * sum[0] + b->two[1][i] * sum[1]) + b->two[2][i] * sum[2];
            for (int c = TRILINEAR; c < terms; c++)
                rise = rise + d_set(2.0) * b->square[c - TRILINEAR][i] * size[c - TRILINEAR];
            next[i] = once * rise + twice * (b->all[i] * every);
        }
        for (int i = 0; i < 3; i++) {
            lower[i] = lower[i] + size[i];
            size[i] = next[i];
        }
    }
    for (int i = 0; i < 3; i++) {
        single = md_and(single, d_le(size[i], d_set(share)));
        single = md_and(single, d_le(lower[i], d_set((1.0 - share) * FORM_STRETCH)));
    }
    return single;
}

#endif
#endif
