/* surface_point.h - what is known about a point where a ray met an isosurface: gradient, normal,
 * error.
 *
 * Computed while the treelet of the hit is at hand; a suspended ray carries it along.
 */
#ifndef RENDER_RAY_SURFACE_POINT_H
#define RENDER_RAY_SURFACE_POINT_H

typedef struct surface_point {
    double gradient[3]; /* of the cell's own interpolant, world space: decides sides and bounds,
                           not shading */
    double error; /* bound of |f - iso| at the computed point: arithmetic and position, in units of
                     the samples */
    double span;  /* shortest edge of the cell, world units */
    float normal[3]; /* unit, towards lower values; from central differences (M08 eq. 4.14) or from
                        gradient */
} surface_point;

#endif
