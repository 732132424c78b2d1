/* view_pick.h - what is at a pixel of a view. */
#ifndef RENDER_VIEW_VIEW_PICK_H
#define RENDER_VIEW_VIEW_PICK_H

#include <jansson.h>

#include "formats/base/mem.h"
#include "render/view/view_picture.h"

/* view_pick() - the first hit of the ray through x, y (pixels of the wish's size, centres at +0.5),
 * as leafcast probe has it. *answer without its id, the caller's. ST_USAGE: the wish cannot be
 * drawn. */
CHECKED status view_pick(mem *m, const view_wish *wish, double x, double y, json_t **answer);

#endif
