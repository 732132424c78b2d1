/* view_pick.h - what is at a pixel of a view, or at a point of its volume. */
#ifndef RENDER_VIEW_VIEW_PICK_H
#define RENDER_VIEW_VIEW_PICK_H

#include <jansson.h>

#include "formats/base/mem.h"
#include "render/view/view_picture.h"

/* A pixel of the wish's size, centres at +0.5; or a point of the world. */
typedef struct view_place {
    bool in_world;
    double pixel[2], point[3];
} view_place;

/* view_pick() - the first hit of the ray through the pixel, or the value at the point, as leafcast
 * probe has it. *answer without its id, the caller's. ST_USAGE: the wish cannot be drawn. */
CHECKED status view_pick(mem *m, const view_wish *wish, const view_place *place, json_t **answer);

#endif
