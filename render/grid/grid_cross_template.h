/* grid_cross_template.h - which ray-cells may cross a surface, in single precision and proven: the
 * filter that tiles and batches of rays put in front of the cell kernel; included by the units of
 * an ISA (see formats/base/simd.h).
 */
#ifndef RENDER_GRID_GRID_CROSS_TEMPLATE_H
#define RENDER_GRID_GRID_CROSS_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

static const float UNIT = 0x1p-24f; /* of float rounding */

/* f - iso over cells, one a lane: the coefficients of 1 x y z xy yz xz xyz, in cell coordinates,
 * and the bound of may_cross(). */
typedef struct near_forms {
    vf c[8], bound;
} near_forms;

/* Compute the coefficients from the corners f, less the isovalue. */
SIMD void near_coefficients(const vf f[8], vf c[8]) {
    const vf x0 = f[1] - f[0], x1 = f[3] - f[2], x2 = f[5] - f[4], x3 = f[7] - f[6];
    const vf y0 = f[2] - f[0], xy0 = x1 - x0;
    c[0] = f[0];
    c[1] = x0;
    c[2] = y0;
    c[3] = f[4] - f[0];
    c[4] = xy0;
    c[5] = (f[6] - f[4]) - y0;
    c[6] = x2 - x0;
    c[7] = (x3 - x2) - xy0;
}

/* Where visits enter their cells, and exit minus entry, in cell coordinates. */
typedef struct near_way {
    vf in[3], way[3];
} near_way;

SIMD vf near_coordinate(vf t, vf d, vf lo, vf inv) {
    return f_min(f_max((t * d - lo) * inv, f_set(0.0f)), f_set(1.0f));
}

/* Compute the control values of the cubic along a visit, as cell_cubic() does but for rounding. */
SIMD void near_controls(const near_way *v, const vf c[8], vf b[4]) {
    const vf *in = v->in, *way = v->way;
    const vf x = in[0], y = in[1], z = in[2];
    /* Per power of x and y, as a linear function along the visit: e + s h. */
    const vf e0 = c[0] + c[3] * z, h0 = c[3] * way[2];
    const vf ex = c[1] + c[6] * z, hx = c[6] * way[2];
    const vf ey = c[2] + c[5] * z, hy = c[5] * way[2];
    const vf exy = c[4] + c[7] * z, hxy = c[7] * way[2];
    const vf xy = x * y, xy1 = x * way[1] + y * way[0], xy2 = way[0] * way[1];
    const vf k0 = e0 + ex * x + ey * y + exy * xy;
    const vf k1 = h0 + hx * x + ex * way[0] + hy * y + ey * way[1] + hxy * xy + exy * xy1;
    const vf k2 = hx * way[0] + hy * way[1] + hxy * xy1 + exy * xy2;
    const vf k3 = hxy * xy2;
    const vf third = f_set(1.0f / 3.0f);
    b[0] = k0;
    b[1] = k0 + third * k1;
    b[2] = b[1] + third * (k1 + k2);
    b[3] = k0 + k1 + k2 + k3;
}

/* Returns the lanes whose control polygons (cell_cubic()) may change side. The cell kernel finds no
 * root in the others.
 *
 * The proof, in units u = 2^-24. Coordinates in the cell are (t d - lo) inv. t errs by 5 u of
 * itself, d by u; the product, lo and the difference add u each. Where the ray passes the cell, |t
 * d| is at most max(|lo|, |hi|), so the sum errs by at most 10 u max(|lo|, |hi|) inv. inv and the
 * last product add 2 u; taking entry from exit and adding it again adds 2 u. All that is less than
 * e = 16 u (max(|lo|, |hi|) inv + 1). Clamping adds nothing.
 *
 * The form is linear in each coordinate with slopes of at most 2 F, F = max |f|: positions add 2 F
 * (e_x + e_y + e_z). Values: f errs by u F, the eight coefficients by 81 u F together; their sizes
 * add up to 27 F. The cubic's coefficients k0 .. k3 add up to 27, 54, 36 and 8 F before signs
 * cancel, with at most 14 roundings on the way: 1750 u F. Denormal results err by 2^-149 a step.
 * Together with the kernel's own rounding, 2^-50 F, that is less than F (2048 u + 2 (e_x + e_y +
 * e_z)) + 2^-130. */
SIMD unsigned may_cross(const near_way *v, const near_forms *forms) {
    vf b[4];
    near_controls(v, forms->c, b);
    const vf least = f_min(f_min(b[0], b[3]), f_min(b[1], b[2]));
    const vf greatest = f_max(f_max(b[0], b[3]), f_max(b[1], b[2]));
    return ~mf_bits(mf_or(f_gt(least, forms->bound), f_lt(greatest, f_set(-0.0f) - forms->bound)));
}

#endif
#endif
