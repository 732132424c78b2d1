/* surface_point.h - a point where a ray met an isosurface: gradient, normal, error.
 *
 * Computed while the hit's treelet is resident. A suspended ray keeps it.
 */
#ifndef RENDER_RAY_SURFACE_POINT_H
#define RENDER_RAY_SURFACE_POINT_H

typedef struct surface_point {
    double gradient[3]; /* of the cell's own interpolant, world space: for sides and bounds, not for
                           shading */
    double error; /* bound of |f - iso| at the computed point: arithmetic and position, in units of
                     the samples */
    double span;  /* shortest edge of the cell, world units */
    float normal[3]; /* unit, towards lower values; from central differences (M08 eq. 4.14) or from
                        gradient */
    float own[3]; /* of kinds that are given (kind.h): the point's own colour, if tracer.coloured;
                     else the value there, and twice 0. Of others undefined */
} surface_point;

#endif
