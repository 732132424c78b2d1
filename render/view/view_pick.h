/* view_pick.h - find what is at a pixel of a view, or at a point of its volume. */
#ifndef RENDER_VIEW_VIEW_PICK_H
#define RENDER_VIEW_VIEW_PICK_H

#include <jansson.h>

#include "formats/base/mem.h"
#include "render/view/view_picture.h"

/* A pixel of the wish's picture, with centres at +0.5, or a point in world space. */
typedef struct view_place {
    bool in_world;
    double pixel[2], point[3];
} view_place;

/* view_pick() - find the first hit of the pixel's ray, of a scene that of the nearest object, or
 * the value at the point, as `leafcast probe` does. *answer has no id yet and is the caller's.
 * ST_USAGE: the wish cannot be drawn. */
CHECKED status view_pick(mem *m, const view_wish *wish, const view_place *place, json_t **answer);

#endif
