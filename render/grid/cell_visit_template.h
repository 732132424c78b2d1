/* cell_visit_template.h - rays inside cells, a lane each, and the value there; shared by the
 * kernels of an ISA (see formats/base/simd.h). Every operation is the one of cell_kernel.c.
 */
#ifndef RENDER_GRID_CELL_VISIT_TEMPLATE_H
#define RENDER_GRID_CELL_VISIT_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include <math.h>

#include "render/grid/cell_batch.h"

/* The rays' visits of their cells: cell_visit, a lane each. */
typedef struct visits {
    vd t_in, t_out, in[3], out[3];
} visits;

/* Returns the cell coordinate at t. lo: the cell's lower plane less the ray's origin. */
SIMD vd cell_coordinate(vd t, vd d, vd lo, vd inverse) {
    return d_min(d_set(1.0), d_max(d_set(0.0), (t * d - lo) * inverse));
}

/* Compute cell coordinates at t, exact on the axis that is crossed. */
SIMD void coordinates_at(const cell_batch *b, int at, vd t, vd axis, vd upper, vd lower, vd to[3]) {
    for (int a = 0; a < 3; a++) {
        const vd d = d_load(b->d[a] + at);
        const vd on_axis = d_select(d_lt(d, d_set(0.0)), upper, lower);
        to[a] = d_select(d_eq(axis, d_set(a)), on_axis,
                         cell_coordinate(t, d, d_load(b->lo[a] + at), d_load(b->inv[a] + at)));
    }
}

/* Returns the lanes from `at` on that visit their cells, and sets *v: cell_visit_of(). */
SIMD md visits_of(const cell_batch *b, int at, visits *v) {
    const vd t0 = d_load(b->t0 + at), none = d_set(-1.0), end = d_set(3.0);
    vd t_in = t0, t_out = d_load(b->t1 + at), axis_in = none, axis_out = end;
    md gone = md_of_bits(0);
    for (int a = 0; a < 3; a++) {
        const vd d = d_load(b->d[a] + at), lo = d_load(b->lo[a] + at), hi = d_load(b->hi[a] + at);
        const md up = d_gt(d, d_set(0.0));
        const vd near = d_select(up, lo, hi) / d, far = d_select(up, hi, lo) / d;
        gone = md_or(gone, md_or(d_lt(far, t0), md_and(up, d_eq(far, t0))));
        const md enters = d_ge(near, t_in);
        t_in = d_select(enters, near, t_in);
        axis_in = d_select(enters, d_set(a), axis_in);
        const md leaves = md_or(d_lt(far, t_out), md_and(d_eq(far, t_out), d_eq(axis_out, end)));
        t_out = d_select(leaves, far, t_out);
        axis_out = d_select(leaves, d_set(a), axis_out);
    }
    const md empty = md_or(d_gt(t_in, t_out), md_and(d_eq(t_in, t_out), d_ge(axis_in, axis_out)));
    v->t_in = t_in;
    v->t_out = t_out;
    coordinates_at(b, at, t_in, axis_in, d_set(1.0), d_set(0.0), v->in);
    coordinates_at(b, at, t_out, axis_out, d_set(0.0), d_set(1.0), v->out);
    return md_and_not(md_and_not(md_of_bits((1u << VD_N) - 1u), gone), empty);
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
