/* leafcast_volume.h - open volumes: for the files that implement leafcast.h. */
#ifndef RENDER_DOOR_LEAFCAST_VOLUME_H
#define RENDER_DOOR_LEAFCAST_VOLUME_H

#include "formats/public_status.h"
#include "render/door/live_steps.h"
#include "render/look/camera.h"
#include "render/ray/open_volume.h"

/* volume_check_set() - returns ST_USAGE where the file has no such field or step. */
CHECKED status volume_check_set(const leafcast *v, uint32_t field, uint32_t step);

/* volume_check_file() - returns the final status of a picture or answer that ended with `st`:
 * ST_CORRUPT if the file changed since it was opened. That message then replaces the one about
 * wrong bytes. */
CHECKED status volume_check_file(const leafcast *v, status st);

/* volume_open_by() - open a volume: make() opens v->file from `from`, in any memory of v->m.
 * volume_open_on() - the same, for callers that hold the device's lock. The volume is no user of
 * the device: it is closed with one that is. */
typedef status (*volume_make)(leafcast *v, const void *from);
leafcast_status volume_open_by(volume_make make, const void *from, const leafcast_options *given,
                               leafcast **volume);
CHECKED status volume_open_on(leafcast_device *d, const leafcast_options *options, volume_make make,
                              const void *from, leafcast **out);

/* volume_hold() - returns the file's step that a caller's step is: of a live volume the current
 * one, which then stays as it is until volume_let_go(), as do the steps of a file that grows: for
 * whoever looks at the file without the device's lock. Any thread; a thread that holds takes no
 * other lock of a volume or device. */
uint32_t volume_hold(const leafcast *v, uint32_t step, live_hold *h);
void volume_let_go(const leafcast *v, live_hold *h);

/* volume_lock() - take the device's lock, so that the file does not grow; of a live volume hold the
 * current step, too, which is v->step then. volume_unlock() - give both back, and end the reads of
 * such a step. */
void volume_lock(leafcast *v, live_hold *h);
void volume_unlock(leafcast *v, live_hold *h);

/* The following functions need the device's lock.
 *
 * volume_on() - make a volume without a file; NULL: no memory. volume_open_file() - set up the rest
 * of a volume once v->file is open. volume_release() - free a volume, also a half-built one; it
 * must not be in the device's list. */
leafcast *volume_on(leafcast_device *d, const leafcast_options *options);
CHECKED status volume_open_file(leafcast *v);
void volume_release(leafcast *v);

/* volume_show() - from now on, rays look for these surfaces; loading starts. volume_show_beside() -
 * likewise, and also for the values of `beside`. Of a time between steps, the volume is that of
 * between_steps_open(). */
void volume_show(leafcast *v, uint32_t field, uint32_t step, const leafcast_surface *surfaces,
                 int count);
void volume_show_beside(const leafcast_shown *shown, const interest *beside);

/* volume_seek_same() - let rays through v look for what they look for in another volume over the
 * same treelets. Its set stays. */
void volume_seek_same(leafcast *v, const leafcast *other);

/* volume_tracer() - set *tr up for rays through what volume_show() selected. c: the camera, for
 * levels of detail by pixels; may be NULL. Fails without any selected surface or medium. */
CHECKED status volume_tracer(leafcast *v, const leafcast_scene *scene, const camera *c, tracer *tr);

/* volume_tracer_of_all() - the same, but needs no selected surface or medium. */
CHECKED status volume_tracer_of_all(leafcast *v, const leafcast_scene *scene, const camera *c,
                                    tracer *tr);

#endif
