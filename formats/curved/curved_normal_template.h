/* curved_normal_template.h - the value's gradient in a curved cell, and the normal of its
 * isosurface, at VD_N places of one cell. In units of an ISA (simd.h), or of one (simd_one.h, which
 * such a unit includes first): the same bits.
 */
#ifndef FORMATS_CURVED_CURVED_NORMAL_TEMPLATE_H
#define FORMATS_CURVED_CURVED_NORMAL_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD

#include <math.h>

#include "formats/base/form_template.h"
#include "formats/base/hexahedron.h"
#include "formats/base/quadratic_tet.h"

/* Set the gradient in the world from the derivatives, by parameters, of places and of the value.
 * Returns where there is one: elsewhere the map has no inverse (a collapsed edge, say), and it is
 * 0.
 */
SIMD md gradient_of_slopes(vd edge[3][3], const vd slope[3], vd gradient[3]) {
    vd across[3][3];
    for (int k = 0; k < 3; k++)
        form_cross(edge[(k + 1) % 3], edge[(k + 2) % 3], across[k]);
    const vd det =
        edge[0][0] * across[0][0] + edge[0][1] * across[0][1] + edge[0][2] * across[0][2];
    const vd most = form_row_size(edge[0]) * form_row_size(edge[1]) * form_row_size(edge[2]);
    const md has = d_gt(d_abs(det), d_set(0x1p-48) * most);
    for (int a = 0; a < 3; a++) {
        vd sum = d_set(0.0);
        for (int k = 0; k < 3; k++)
            sum = sum + slope[k] / det * across[k][a];
        gradient[a] = d_select(has, sum, d_set(0.0));
    }
    return has;
}

/* Parameters are from 0 to 1. Returns as gradient_of_slopes(). */
SIMD md hex_gradient(const hexahedron *h, const vd at[3], vd gradient[3]) {
    vd slope[3], edge[3][3];
    form_rise_of_corners(h->value, at, slope);
    for (int a = 0; a < 3; a++) {
        double p[HEX_CORNERS];
        vd along[3];
        for (int c = 0; c < HEX_CORNERS; c++)
            p[c] = h->p[c][a];
        form_rise_of_corners(p, at, along);
        for (int k = 0; k < 3; k++)
            edge[k][a] = along[k];
    }
    return gradient_of_slopes(edge, slope, gradient);
}

/* quadratic_slope(). */
SIMD void quadratic_rise(const double form[QUADRATIC_NODES], const vd at[3], vd slope[3]) {
    const vd share[QUADRATIC_CORNERS] = {((d_set(1.0) - at[0]) - at[1]) - at[2], at[0], at[1],
                                         at[2]};
    vd half[QUADRATIC_CORNERS]; /* with one of two factors left open */
    for (int n = 0; n < QUADRATIC_CORNERS; n++) {
        half[n] = share[0] * d_set(form[quadratic_coefficient(n, 0)]);
        for (int c = 1; c < QUADRATIC_CORNERS; c++)
            half[n] = half[n] + share[c] * d_set(form[quadratic_coefficient(n, c)]);
    }
    for (int k = 0; k < 3; k++)
        slope[k] = d_set(2.0) * (half[k + 1] - half[0]);
}

/* Parameters are shares of corners 1 to 3. Returns as gradient_of_slopes(). */
SIMD md quadratic_gradient(const quadratic_tet *c, const vd at[3], vd gradient[3]) {
    const unsigned straight = quadratic_straight_edges(c);
    double form[QUADRATIC_NODES];
    vd slope[3], edge[3][3];
    quadratic_form(c->value, 0, form);
    quadratic_rise(form, at, slope);
    for (int a = 0; a < 3; a++) {
        double v[QUADRATIC_NODES];
        vd along[3];
        for (int n = 0; n < QUADRATIC_NODES; n++)
            v[n] = c->p[n][a];
        quadratic_form(v, straight, form);
        quadratic_rise(form, at, along);
        for (int k = 0; k < 3; k++)
            edge[k][a] = along[k];
    }
    return gradient_of_slopes(edge, slope, gradient);
}

/* The unit vector down the gradient; 0 where that is 0 or infinite. */
SIMD void curved_normal(const vd gradient[3], vd normal[3]) {
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
