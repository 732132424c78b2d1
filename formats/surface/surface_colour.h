/* surface_colour.h - a colour as the value of a field (colour_field.h).
 *
 * Colours are as stored, but for glTF's, which are linear.
 */
#ifndef FORMATS_SURFACE_SURFACE_COLOUR_H
#define FORMATS_SURFACE_SURFACE_COLOUR_H

#include <math.h>

#include "formats/base/colour_field.h"

static inline double surface_colour_byte(double v) {
    return v >= 0 ? v < 255 ? floor(v + 0.5) : 255 : 0; /* NaN: 0 */
}

/* surface_colour_value() - returns the value of three numbers in 0 .. `most`, rounded to bytes. */
static inline double surface_colour_value(const double rgb[3], double most) {
    double c[3];
    for (int i = 0; i < 3; i++)
        c[i] = surface_colour_byte(most == 255 ? rgb[i] : rgb[i] / most * 255);
    return 65536 * c[0] + 256 * c[1] + c[2];
}

#endif
