/* opacity_curve.h - convert a piecewise opacity function of VTK to extinctions. */
#ifndef RENDER_APP_OPACITY_CURVE_H
#define RENDER_APP_OPACITY_CURVE_H

#include "render/app/transfer_list.h"

/* The opacity at a value, over some length. Between it and the next point, half of the change is
 * reached at the share `middle` of the way. Sharpness 0: linear, 1: a step at the middle. */
typedef struct opacity_point {
    double value, opacity, middle, sharpness; /* the last three in [0, 1] */
} opacity_point;

/* The largest opacity that is kept; 1 would need an infinite extinction. */
#define OPACITY_CURVE_MOST 0.999

/* opacity_curve_extinction() - returns the extinction that gives an opacity A, below 1, over a
 * length of 1: -ln(1 - A). */
double opacity_curve_extinction(double opacity);

/* opacity_curve_convert() - convert points (at least one, with values that do not fall) into an
 * empty list of extinctions. The list is piecewise linear, within TRANSFER_CURVE_ERROR of the
 * opacity. Opacities above OPACITY_CURVE_MOST are lowered to it. Errors as from
 * transfer_list_add(). */
CHECKED status opacity_curve_convert(const opacity_point *points, size_t count, transfer_list *out);

#endif
