/* triangle_facts_template.h - triangle_flat_facts() for many triangles at a time, to the bit;
 * included by the units of an ISA (see formats/base/simd.h). */
#ifndef RENDER_TRIANGLE_TRIANGLE_FACTS_TEMPLATE_H
#define RENDER_TRIANGLE_TRIANGLE_FACTS_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/flat/flat_points_template.h"
#include "render/triangle/triangle_kernel.h"
#include "stream/triangle_blocks.h"

/* VD_N triangles, a lane each. */
typedef struct triangle_columns {
    _Alignas(64) double p[3][3][VD_N];
} triangle_columns;

SIMD void triangle_columns_put(triangle_columns *c, unsigned lane, const triangle_blocks *b,
                               uint32_t local) {
    const uint16_t *v = b->rows[local];
    for (int k = 0; k < 3; k++)
        for (int a = 0; a < 3; a++)
            c->p[k][a][lane] = (double)b->p[a][v[k]];
}

/* Set at, gradient, error and slack of the columns. Where a triangle has no normal, gradient and
 * error are 0. */
SIMD void triangle_facts(const triangle_columns *c, point_columns *out) {
    const vd zero = d_set(0.0);
    vd e[2][3], n[3], unit[3], moduli = zero;
    for (int a = 0; a < 3; a++) {
        out->at[a] = d_load(c->p[0][a]);
        e[0][a] = d_load(c->p[1][a]) - d_load(c->p[0][a]);
        e[1][a] = d_load(c->p[1][a]) - d_load(c->p[2][a]);
    }
    for (int k = 0; k < 3; k++) {
        const int l = (k + 1) % 3, m = (k + 2) % 3;
        const vd up = e[0][l] * e[1][m], down = e[0][m] * e[1][l];
        n[k] = up - down;
        moduli = moduli + (d_abs(up) + d_abs(down));
    }
    const vd size = d_abs(n[0]) + d_abs(n[1]) + d_abs(n[2]);
    const vd error = d_set(4.0 * DBL_EPSILON) * (moduli / size + d_set(1.0));
    const vd largest = d_max(d_abs(n[0]), d_max(d_abs(n[1]), d_abs(n[2])));
    const md has = d_gt(largest, zero); /* and it is finite, as floats' products are */
    for (int a = 0; a < 3; a++)
        unit[a] = n[a] / largest;
    const vd length = d_sqrt(unit[0] * unit[0] + unit[1] * unit[1] + unit[2] * unit[2]);
    out->slack = zero;
    for (int a = 0; a < 3; a++) {
        out->gradient[a] = d_select(has, unit[a] / length, zero);
        out->error[a] = d_select(has, error, zero);
    }
}

/* Returns the shortest edges. */
SIMD vd triangle_spans(const triangle_columns *c) {
    vd square = d_set(INFINITY);
    for (int k = 0; k < 3; k++) {
        vd e[3];
        for (int a = 0; a < 3; a++)
            e[a] = d_load(c->p[(k + 1) % 3][a]) - d_load(c->p[k][a]);
        square = d_min(square, e[0] * e[0] + e[1] * e[1] + e[2] * e[2]);
    }
    return d_sqrt(square);
}

#endif
#endif
