/* projection_integrator.h - a pixel from the values on its ray: their maximum, minimum or mean, or
 * the first that reaches a threshold. The pixel has that value's colour, opaque, or else the
 * background.
 *
 * Conventions. f is the cells' own interpolant along the ray, inside the box and the clips. Cells
 * that touch NaN or inf count for nothing, nor do flat tets. "The data" are the pieces (segments.h)
 * of the ray's way through the other cells.
 *
 *   maximum, minimum   exact extremum of each piece's polynomial (extremes.h); image.z: the first t
 *                      where it is
 *   mean               integral of f dt over the data, exact piece by piece, in order, divided by
 *                      the data's length; image.z: +inf
 *   first              the first place in the data with f >= V, and the value there: V, or f where
 *                      data begin above V; image.z: its t. A place that only touches V counts
 *
 * Several volumes: the greatest and the least value, and the first place, of any of them; the mean
 * over the sum of the ways through them.
 */
#ifndef RENDER_PROJECTION_PROJECTION_INTEGRATOR_H
#define RENDER_PROJECTION_PROJECTION_INTEGRATOR_H

#include "render/frame/integrator.h"
#include "render/look/transfer.h"

extern const integrator projection_integrator;

/* frame.look */
typedef struct projection_look {
    leafcast_project project;
    double value;           /* threshold of LEAFCAST_PROJECT_FIRST; also the tracers' `above` */
    const transfer *colour; /* of the value; NULL: grey, black and white at */
    double range[2];
    float background[4];
} projection_look;

#endif
