/* opacity_curve.h - what a piecewise opacity function of VTK swallows, as extinctions.
 */
#ifndef RENDER_APP_OPACITY_CURVE_H
#define RENDER_APP_OPACITY_CURVE_H

#include "render/app/transfer_list.h"

/* An opacity over some length. On the way to the next point it is half of the way at the share
 * `middle` of it; sharpness 0: lines, 1: a step there. */
typedef struct opacity_point {
    double value, opacity, middle, sharpness; /* the last three in [0, 1] */
} opacity_point;

/* The largest opacity that is told from 1: its extinction would be infinite. */
#define OPACITY_CURVE_MOST 0.999

/* opacity_curve_extinction() - that makes an opacity, below 1, over a length of 1: -ln(1 - A). */
double opacity_curve_extinction(double opacity);

/* opacity_curve_convert() - points, at least one, whose values do not fall, into an empty list of
 * extinctions: lines, to within TRANSFER_CURVE_ERROR of the opacity. Opacities above
 * OPACITY_CURVE_MOST are taken for it. Errors as of transfer_list_add(). */
CHECKED status opacity_curve_convert(const opacity_point *points, size_t count, transfer_list *out);

#endif
