/* legend.h - draw a bar of a transfer function's colours, with some of its values, into a picture.
 */
#ifndef RENDER_APP_LEGEND_H
#define RENDER_APP_LEGEND_H

#include "render/app/text_face.h"
#include "render/app/transfer_list.h"

/* legend_draw() - draw at the right edge of a picture of width x height pixels, over its planes r,
 * g, b and a (NULL ones are skipped). The bar shows the colours, opaque, from window[0] at the
 * bottom to window[1]; numbers give the values at the ends and in the middle. face: the font of the
 * numbers; NULL: letters of dots. title: what the values are, written above in that font; "", or
 * too long for the picture: nothing. A picture that is too small is left unchanged. */
void legend_draw(const leafcast_image *image, uint32_t width, uint32_t height,
                 const transfer_list *t, const double window[2], const char *title,
                 text_face *face);

#endif
