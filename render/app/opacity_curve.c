#include "render/app/opacity_curve.h"

#include <math.h>

#include "formats/base/portable_math.h"
#include "render/app/transfer_curve.h"

double opacity_curve_extinction(double opacity) {
    return -portable_log(1.0 - opacity);
}

typedef struct span {
    const opacity_point *a, *b;
} span;

/* Returns x^e for x in [0, 1]. */
static double power(double x, double e) {
    return x > 0.0 ? portable_exp(e * portable_log(x)) : 0.0;
}

/* Returns the share of the way, remapped so that `middle` becomes 0.5. */
static double about_middle(double s, double middle) {
    return s < middle     ? 0.5 * s / middle
           : middle < 1.0 ? 0.5 + 0.5 * (s - middle) / (1.0 - middle)
                          : 1.0;
}

/* Follow vtkPiecewiseFunction: first a power, which flattens the curve away from the middle as
 * sharpness grows, then a Hermite curve whose slope at both ends falls with sharpness. */
static double sharpened(double s, double sharpness) {
    if (sharpness > 0.99)
        return s < 0.5 ? 0.0 : 1.0;
    if (sharpness < 0.01)
        return s;
    const double e = 1.0 + 10.0 * sharpness;
    s = s < 0.5 ? 0.5 * power(2.0 * s, e) : 1.0 - 0.5 * power(2.0 - 2.0 * s, e);
    const double slope = 1.0 - sharpness;
    const double curve = s * s * (3.0 - 2.0 * s) + slope * s * (1.0 - s) * (1.0 - 2.0 * s);
    return fmin(fmax(curve, 0.0), 1.0);
}

static void extinction_at(const void *ctx, double s, leafcast_transfer_point *p) {
    const span *of = ctx;
    const double w = s <= 0.0   ? 0.0
                     : s >= 1.0 ? 1.0
                                : sharpened(about_middle(s, of->a->middle), of->a->sharpness);
    const double opacity = (1.0 - w) * of->a->opacity + w * of->b->opacity;
    p->extinction = opacity_curve_extinction(fmin(opacity, OPACITY_CURVE_MOST));
}

status opacity_curve_convert(const opacity_point *points, size_t count, transfer_list *out) {
    status st = ST_OK;
    for (size_t i = 0; i + 1 < count + (count == 1) && st == ST_OK; i++) {
        const span of = {&points[i], &points[count == 1 ? i : i + 1]};
        st = transfer_curve_add(out,
                                &(transfer_curve){of.a->value, of.b->value, extinction_at, &of});
    }
    return st;
}
