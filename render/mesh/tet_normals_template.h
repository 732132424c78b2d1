/* tet_normals_template.h - tet_normal() for many tets at a time, to the bit; included by the units
 * of an ISA (see formats/base/simd.h). */
#ifndef RENDER_MESH_TET_NORMALS_TEMPLATE_H
#define RENDER_MESH_TET_NORMALS_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include <float.h>

#include "formats/base/exact.h"
#include "render/mesh/tet_kernel.h"

/* VD_N tets, a lane each. */
typedef struct tet_columns {
    double p[4][3][VD_N], f[4][VD_N];
} tet_columns;

SIMD void tet_columns_put(tet_columns *c, unsigned lane, const tet *x) {
    for (int k = 0; k < 4; k++) {
        for (int a = 0; a < 3; a++)
            c->p[k][a][lane] = (double)x->p[k][a];
        c->f[k][lane] = (double)x->f[k];
    }
}

/* Compute the normals of VD_N tets. Sums and products are the same as in tet_gradient() and
 * tet_normal(), in the same order. Returns the lanes that have a gradient; the other lanes get no
 * normal. */
SIMD unsigned tet_normals_of(const tet_columns *c, float normal[3][VD_N]) {
    vd e[3][3], df[3], n[3][3], terms = d_set(0.0), g[3], unit[3];
    for (int i = 0; i < 3; i++) {
        for (int a = 0; a < 3; a++)
            e[i][a] = d_load(c->p[i + 1][a]) - d_load(c->p[0][a]);
        df[i] = d_load(c->f[i + 1]) - d_load(c->f[0]);
    }
    for (int i = 0; i < 3; i++) {
        const vd *u = e[(i + 1) % 3], *v = e[(i + 2) % 3];
        for (int a = 0; a < 3; a++) {
            const int b = (a + 1) % 3, d = (a + 2) % 3;
            const vd up = u[b] * v[d], down = u[d] * v[b];
            n[i][a] = up - down;
            if (i == 0)
                terms = terms + d_abs(e[0][a]) * (d_abs(up) + d_abs(down));
        }
    }
    const vd determinant = e[0][0] * n[0][0] + e[0][1] * n[0][1] + e[0][2] * n[0][2];
    const vd bound = d_set(EXACT_BOUND) * terms + d_set(EXACT_SMALLEST);
    for (int a = 0; a < 3; a++)
        g[a] = (df[0] * n[0][a] + df[1] * n[1][a] + df[2] * n[2][a]) / determinant;
    const vd largest = d_max(d_abs(g[0]), d_max(d_abs(g[1]), d_abs(g[2])));
    const vd values = df[0] + df[1] + df[2], slopes = g[0] + g[1] + g[2];
    const vd most = d_set(DBL_MAX);
    md sure = d_gt(d_abs(determinant), d_set(TET_GRADIENT_SURE / EXACT_BOUND) * bound);
    sure = md_and(sure, md_and(d_le(d_abs(values), most), d_le(d_abs(slopes), most)));
    sure = md_and(sure, d_gt(largest, d_set(0.0)));
    for (int a = 0; a < 3; a++)
        unit[a] = g[a] / largest;
    const vd length = d_sqrt(unit[0] * unit[0] + unit[1] * unit[1] + unit[2] * unit[2]);
    for (int a = 0; a < 3; a++)
        d_store_floats(normal[a], d_set(-0.0) - unit[a] / length);
    return md_bits(sure);
}

#endif
#endif
