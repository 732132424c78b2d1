/* between_steps.h - a volume at times between its steps.
 *
 * It is a volume of its own, over a file that lies between the steps of the other one's
 * (formats/leaf/leaf_between.h): with its own loader, on the same device, within the same budget.
 * The first call that needs it makes it; it is closed with the other one. Whatever looks at a
 * volume goes on with that one instead.
 */
#ifndef RENDER_DOOR_BETWEEN_STEPS_H
#define RENDER_DOOR_BETWEEN_STEPS_H

#include "render/door/leafcast_volume.h"

/* between_steps_check() - whether v has a field at a share, 0 or more and below 1, of the way from
 * a step to the next: ST_USAGE, or ST_UNSUPPORTED for kinds that have no such. */
CHECKED status between_steps_check(const leafcast *v, uint32_t field, uint32_t step, double share);

/* The following functions need the device's lock.
 *
 * between_steps_open() - let *v be the volume that shows a share of the way: *v itself for 0, else
 * the one over the file between. between_steps_set() - the set of such a volume that is to be
 * selected for that moment. If it was another moment's, its reads have ended. */
CHECKED status between_steps_open(leafcast **v, double share);
uint32_t between_steps_set(leafcast *v, uint32_t field, uint32_t step, double share);

/* between_steps_shown() - the same of a volume of a scene. */
static inline uint32_t between_steps_shown(const leafcast_shown *s) {
    return between_steps_set(s->volume, s->field, s->step, s->between);
}

#endif
