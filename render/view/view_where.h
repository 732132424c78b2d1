/* view_where.h - describe where a picture is provisional, for a page that marks it. */
#ifndef RENDER_VIEW_VIEW_WHERE_H
#define RENDER_VIEW_VIEW_WHERE_H

#include <jansson.h>
#include <stdint.h>

enum { VIEW_WHERE_MAX = 1 << 14 }; /* squares of a picture, at most about */

/* view_where_describe() - divide the picture into squares of `side` pixels, row by row, `columns`
 * per row; squares at the right and lower border may be cut off. `runs` are lengths, in turn: of
 * squares without a provisional pixel, then of squares with one, and so on. They sum up to all
 * squares. provisional: one byte per pixel; NULL: all pixels are. Returns NULL without memory. */
json_t *view_where_describe(const uint8_t *provisional, uint32_t width, uint32_t height);

#endif
