/* medium_pixel.h - bounds of the error of a pixel of a medium before its background.
 */
#ifndef RENDER_MEDIUM_MEDIUM_PIXEL_H
#define RENDER_MEDIUM_MEDIUM_PIXEL_H

#include "render/medium/medium_stretch.h"

/* medium_pixel_limit() - limit a stretch's errors to what is possible at all: `through` is between
 * 0 and 1, and each component of light between 0 and `brightest`. */
static inline void medium_pixel_limit(medium_stretch *s, double brightest) {
    const double through = s->through < 0.5 ? 1.0 - s->through : s->through;
    double light = brightest;
    for (int c = 0; c < 3; c++)
        light = light < s->rgb[c] ? s->rgb[c] : light;
    s->through_error = s->through_error < through ? s->through_error : through;
    s->rgb_error = s->rgb_error < light ? s->rgb_error : light;
}

/* medium_pixel_error() - bound of the error of any channel, given what is seen of the whole ray. */
double medium_pixel_error(const medium_stretch *seen, const float background[4]);

/* medium_pixel_most() - bound of the error of any of the channels x[] if nothing is known of the
 * ray. brightest: the largest component of any colour. */
double medium_pixel_most(double brightest, const float background[4], const double x[4]);

#endif
