/* flat_points_template.h - flat_point_at() for many rays at a time, to the bit; included by the
 * units of an ISA (see formats/base/simd.h). */
#ifndef RENDER_FLAT_FLAT_POINTS_TEMPLATE_H
#define RENDER_FLAT_FLAT_POINTS_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include <float.h>
#include <math.h>

#include "render/flat/flat_point.h"

/* The facts of the polygons that VD_N rays have hit, a lane each, and the rays' hits. */
typedef struct point_columns {
    vd at[3], gradient[3], error[3], slack, d[3], t;
} point_columns;

/* Set the facts of these lanes (bits), which have hit one polygon. */
SIMD void point_columns_put(point_columns *c, unsigned lanes, const flat_facts *f) {
    const md in = md_of_bits(lanes);
    for (int k = 0; k < 3; k++) {
        c->at[k] = d_select(in, d_set(f->at[k]), c->at[k]);
        c->gradient[k] = d_select(in, d_set(f->point.gradient[k]), c->gradient[k]);
        c->error[k] = d_select(in, d_set(f->error[k]), c->error[k]);
    }
    c->slack = d_select(in, d_set(f->slack), c->slack);
}

/* Compute the points' errors, for rays from o. */
SIMD void point_errors(const point_columns *c, const double o[3], double error[VD_N]) {
    vd away[3], sum = c->slack;
    for (int k = 0; k < 3; k++) {
        const vd along = c->t * c->d[k];
        const vd far = d_max(d_set(fabs(o[k])) + d_abs(along), d_abs(c->at[k]));
        away[k] = d_set(o[k]) + along - c->at[k];
        sum = sum + (d_abs(c->gradient[k]) * d_set(6.0) * d_set(DBL_EPSILON) * far +
                     c->error[k] * d_abs(away[k]));
    }
    const vd *g = c->gradient;
    d_store(error, d_abs(g[0] * away[0] + g[1] * away[1] + g[2] * away[2]) + sum);
}

#endif
#endif
