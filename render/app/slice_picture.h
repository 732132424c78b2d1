/* slice_picture.h - draw the values of a slice as colours.
 *
 * Pixels without a value (NaN) are transparent. Isolines are 1.5 pixels wide and antialiased. A
 * pixel's distance to a line is |value - isovalue| divided by the gradient in the picture, which is
 * taken from neighbouring pixels. So lines have no gaps: of two neighbours on different sides of
 * the isovalue, one is at most half a pixel away.
 */
#ifndef RENDER_APP_SLICE_PICTURE_H
#define RENDER_APP_SLICE_PICTURE_H

#include "render/app/transfer_list.h"

typedef struct slice_look {
    transfer_list colours; /* colours of values; extinctions are ignored */
    const double *isovalues;
    int isos;
    float line[3]; /* the isolines' colour, linear */
} slice_look;

/* slice_picture_fill() - fill r, g, b and a of `out` from width x height values, row by row. */
void slice_picture_fill(const slice_look *look, const double *value, uint32_t width,
                        uint32_t height, const leafcast_image *out);

#endif
