/* medium_pixel.h - how far a pixel of a medium may be off before its background.
 */
#ifndef RENDER_MEDIUM_MEDIUM_PIXEL_H
#define RENDER_MEDIUM_MEDIUM_PIXEL_H

#include "render/medium/medium_stretch.h"

/* medium_pixel_limit() - of a stretch's errors no more is left than is possible at all: no more
 * comes through than everything and no less than nothing, and light is between none and the
 * brightest. */
static inline void medium_pixel_limit(medium_stretch *s, double brightest) {
    const double through = s->through < 0.5 ? 1.0 - s->through : s->through;
    double light = brightest;
    for (int c = 0; c < 3; c++)
        light = light < s->rgb[c] ? s->rgb[c] : light;
    s->through_error = s->through_error < through ? s->through_error : through;
    s->rgb_error = s->rgb_error < light ? s->rgb_error : light;
}

/* medium_pixel_error() - of any channel, where that is seen of the whole ray. */
double medium_pixel_error(const medium_stretch *seen, const float background[4]);

/* medium_pixel_most() - the same where nothing is known: no channel x is further off than all that
 * there may be of it. brightest: the largest component of any colour. */
double medium_pixel_most(double brightest, const float background[4], const double x[4]);

#endif
