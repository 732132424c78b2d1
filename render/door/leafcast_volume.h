/* leafcast_volume.h - open volumes: for the files that implement leafcast.h. */
#ifndef RENDER_DOOR_LEAFCAST_VOLUME_H
#define RENDER_DOOR_LEAFCAST_VOLUME_H

#include "formats/public_status.h"
#include "render/look/camera.h"
#include "render/ray/open_volume.h"

/* volume_check_set() - ST_USAGE where the file has no such field or step. */
CHECKED status volume_check_set(const leafcast *v, uint32_t field, uint32_t step);

/* volume_check_file() - what becomes of a picture or an answer with this status, now that it is
 * made: ST_CORRUPT if the file changed since it was opened. That is said then rather than which
 * bytes were found wrong. */
CHECKED status volume_check_file(const leafcast *v, status st);

/* What follows is for whoever holds the device's lock.
 *
 * volume_on() - a volume without a file; NULL: no memory. volume_open_file() - all else of one that
 * has its file. volume_release() - what there is of it; it is none of the device's list. */
leafcast *volume_on(leafcast_device *d, const leafcast_options *options);
CHECKED status volume_open_file(leafcast *v);
void volume_release(leafcast *v);

/* volume_show() - from now on, rays look for these surfaces; loading starts. volume_show_beside() -
 * and also for what has these values. */
void volume_show(leafcast *v, uint32_t field, uint32_t step, const leafcast_surface *surfaces,
                 int count);
void volume_show_beside(const leafcast_shown *shown, const interest *beside);

/* volume_tracer() - for rays through what volume_show() said. c: the camera, for levels of detail
 * by pixels; may be NULL. */
CHECKED status volume_tracer(leafcast *v, const leafcast_scene *scene, const camera *c, tracer *tr);

/* volume_tracer_of_all() - likewise, whether a surface is selected or not. */
CHECKED status volume_tracer_of_all(leafcast *v, const leafcast_scene *scene, const camera *c,
                                    tracer *tr);

#endif
