/* cell_visit_template.h - rays inside cells, a lane each, and the value there: what the kernels of
 * an ISA share (see formats/base/simd.h), operation by operation that of cell_kernel.c.
 */
#ifndef RENDER_GRID_CELL_VISIT_TEMPLATE_H
#define RENDER_GRID_CELL_VISIT_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

/* Where rays are in their cells: cell_visit. */
typedef struct visits {
    vd t_in, t_out, in[3], out[3];
} visits;

/* The coordinate at t between two planes, of which the lower one is `lo` from the origin. */
SIMD vd cell_coordinate(vd t, vd d, vd lo, vd inverse) {
    return d_min(d_set(1.0), d_max(d_set(0.0), (t * d - lo) * inverse));
}

SIMD vd mix(vd a, vd b, vd s) {
    return (d_set(1.0) - s) * a + s * b;
}

SIMD void cubic(const visits *v, const vd f[8], vd b[4]) {
    vd x[2][4], xy[4][2], m[8];
    for (int i = 0; i < 4; i++) {
        x[0][i] = mix(f[2 * i], f[2 * i + 1], v->in[0]);
        x[1][i] = mix(f[2 * i], f[2 * i + 1], v->out[0]);
    }
    for (int i = 0; i < 2; i++) {
        for (int k = 0; k < 2; k++) {
            xy[i][k] = mix(x[i][2 * k], x[i][2 * k + 1], v->in[1]);
            xy[i + 2][k] = mix(x[i][2 * k], x[i][2 * k + 1], v->out[1]);
        }
    }
    for (int i = 0; i < 4; i++) {
        m[i] = mix(xy[i][0], xy[i][1], v->in[2]);
        m[i + 4] = mix(xy[i][0], xy[i][1], v->out[2]);
    }
    const vd third = d_set(1.0 / 3.0);
    b[0] = m[0];
    b[1] = (m[1] + m[2] + m[4]) * third;
    b[2] = (m[3] + m[5] + m[6]) * third;
    b[3] = m[7];
}

#endif
#endif
