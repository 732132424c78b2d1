/* slice_picture.h - values of a slice as colours.
 *
 * Where there is no value (NaN) the picture is transparent. Isolines are 1.5 pixels wide and
 * antialiased: a pixel's distance to one is the value's distance to the isovalue by its
 * gradient in the picture, which is taken from the neighbouring pixels. A line has no gap: of two
 * neighbours on both sides of an isovalue one is at most half a pixel away by this.
 */
#ifndef RENDER_APP_SLICE_PICTURE_H
#define RENDER_APP_SLICE_PICTURE_H

#include "render/app/transfer_list.h"

typedef struct slice_look {
    transfer_list colours; /* of values; their extinctions do not matter */
    const double *isovalues;
    int isos;
    float line[3]; /* the isolines' colour, linear */
} slice_look;

/* slice_picture_fill() - r, g, b and a of `out` from width x height values, row by row. */
void slice_picture_fill(const slice_look *look, const double *value, uint32_t width,
                        uint32_t height, const leafcast_image *out);

#endif
