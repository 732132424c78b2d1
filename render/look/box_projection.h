/* box_projection.h - the projection of boxes whose planes may lie anywhere, so that each is
 * projected when it is met. */
#ifndef RENDER_LOOK_BOX_PROJECTION_H
#define RENDER_LOOK_BOX_PROJECTION_H

#include "render/look/projection.h"

/* box_projection_init() - bounds: of all boxes, lo x y z, hi x y z. Allocates nothing. */
void box_projection_init(projection *p, const float bounds[6], const camera *c);

#endif
