/* view_where.h - where a picture is provisional, for a page that marks it. */
#ifndef RENDER_VIEW_VIEW_WHERE_H
#define RENDER_VIEW_VIEW_WHERE_H

#include <jansson.h>
#include <stdint.h>

enum { VIEW_WHERE_MAX = 1 << 14 }; /* squares of a picture, about */

/* view_where_describe() - the picture in squares of `side` pixels, row by row, `columns` a row;
 * those at its right and lower border may be cut off. `runs`: how many squares in a row have no
 * provisional pixel, how many then have one, and so on in turn; they sum up to all. provisional: a
 * byte a pixel; NULL: all pixels are. NULL: no memory. */
json_t *view_where_describe(const uint8_t *provisional, uint32_t width, uint32_t height);

#endif
