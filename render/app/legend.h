/* legend.h - a bar of the colours of a transfer function with some of its values, drawn into a
 * picture.
 */
#ifndef RENDER_APP_LEGEND_H
#define RENDER_APP_LEGEND_H

#include "render/app/text_face.h"
#include "render/app/transfer_list.h"

/* legend_draw() - at the right edge of the planes r, g, b and a (as far as there are any) of a
 * picture of width x height pixels: the colours from window[0], below, to window[1], opaque, and
 * the values at its ends and in the middle, in letters of a font, or of dots (face NULL). Of a
 * picture too small for it nothing is changed. */
void legend_draw(const leafcast_image *image, uint32_t width, uint32_t height,
                 const transfer_list *t, const double window[2], text_face *face);

#endif
