/* hex_normal_template.h - the value's gradient in a hexahedron, and the normal of its isosurface,
 * at VD_N places of one cell. In units of an ISA (simd.h), or of one (simd_one.h, which such a unit
 * includes first): the same bits.
 */
#ifndef FORMATS_CURVED_HEX_NORMAL_TEMPLATE_H
#define FORMATS_CURVED_HEX_NORMAL_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD

#include <math.h>

#include "formats/base/hexahedron.h"
#include "formats/base/trilinear_template.h"

/* Set the gradient in the world at parameters. Returns where there is one: elsewhere the map has no
 * inverse (a collapsed edge, say), and it is 0. */
SIMD md hex_gradient(const hexahedron *h, const vd at[3], vd gradient[3]) {
    vd slope[3], edge[3][3], across[3][3];
    trilinear_rise(h->value, at, slope);
    for (int a = 0; a < 3; a++) {
        double p[HEX_CORNERS];
        vd along[3];
        for (int c = 0; c < HEX_CORNERS; c++)
            p[c] = h->p[c][a];
        trilinear_rise(p, at, along);
        for (int k = 0; k < 3; k++)
            edge[k][a] = along[k];
    }
    for (int k = 0; k < 3; k++)
        trilinear_cross(edge[(k + 1) % 3], edge[(k + 2) % 3], across[k]);
    const vd det =
        edge[0][0] * across[0][0] + edge[0][1] * across[0][1] + edge[0][2] * across[0][2];
    const vd most =
        trilinear_row_size(edge[0]) * trilinear_row_size(edge[1]) * trilinear_row_size(edge[2]);
    const md has = d_gt(d_abs(det), d_set(0x1p-48) * most);
    for (int a = 0; a < 3; a++) {
        vd sum = d_set(0.0);
        for (int k = 0; k < 3; k++)
            sum = sum + slope[k] / det * across[k][a];
        gradient[a] = d_select(has, sum, d_set(0.0));
    }
    return has;
}

/* The unit vector down the gradient; 0 where that is 0 or infinite. */
SIMD void hex_normal(const vd gradient[3], vd normal[3]) {
    vd largest = d_set(0.0), square = d_set(0.0);
    for (int a = 0; a < 3; a++)
        largest = d_max(d_abs(gradient[a]), largest);
    const md usable = md_and(d_gt(largest, d_set(0.0)), d_lt(largest, d_set(INFINITY)));
    for (int a = 0; a < 3; a++) {
        normal[a] = gradient[a] / largest;
        square = square + normal[a] * normal[a];
    }
    const vd length = d_sqrt(square);
    for (int a = 0; a < 3; a++)
        normal[a] = d_set(0.0) - d_select(usable, normal[a] / length, d_set(0.0));
}

#endif
#endif
