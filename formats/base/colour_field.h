/* colour_field.h - a field of colours: "rgb", 65536 r + 256 g + b of sRGB bytes. Each is
 * exact in a float.
 *
 * Of triangles these are the surface's own colours (TRIANGLES.md); of terrain they are an image,
 * to be draped over others (HEIGHTS.md).
 */
#ifndef FORMATS_BASE_COLOUR_FIELD_H
#define FORMATS_BASE_COLOUR_FIELD_H

#include <stdint.h>

#define COLOUR_FIELD "rgb" /* its name */

/* colour_field_bytes() - returns a value as a whole number; 0, black, of what is no colour. */
static inline uint32_t colour_field_bytes(double value) {
    return value >= 0.0 && value < 0x1p24 ? (uint32_t)value : 0;
}

#endif
