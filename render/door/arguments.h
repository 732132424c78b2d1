/* arguments.h - what callers of leafcast.h pass, before it is used: the tables of its structs
 * (formats/public_fields.h), and what else is looked at, once for all calls. A fault is described,
 * ST_USAGE.
 *
 * All sizes are those of this version, as there is no other yet. Whoever appends a member accepts
 * the sizes of before, too, and gives what is missing its default.
 */
#ifndef RENDER_DOOR_ARGUMENTS_H
#define RENDER_DOOR_ARGUMENTS_H

#include "formats/public_fields.h"
#include "render/leafcast.h"

/* arguments_tables() - of the structs of leafcast.h and leafcast_experimental.h, *count of them. */
const public_fields *const *arguments_tables(int *count);

/* arguments_check_volume() - that it is one, and of this process: what a device's threads and locks
 * are needed for does not go on in a child of fork(). arguments_check_device() - likewise. */
CHECKED status arguments_check_volume(const char *call, const leafcast *v);
CHECKED status arguments_check_device(const char *call, const leafcast_device *d);

CHECKED status arguments_check_options(const leafcast_options *options);
CHECKED status arguments_check_scene(const leafcast_scene *scene);
CHECKED status arguments_check_surfaces(const leafcast_surface *surfaces, int count);
CHECKED status arguments_check_camera(const leafcast_camera *camera);
CHECKED status arguments_check_slice(const leafcast_slice_pixels *slice);

/* arguments_check_rays() - count of them, in one pass that takes little of the time of tracing
 * them. arguments_check_ray() - one of a call that has no range of t. */
CHECKED status arguments_check_rays(const leafcast_ray *rays, size_t count);
CHECKED status arguments_check_ray(const double origin[3], const double direction[3]);

/* arguments_check_picture() - of a picture, or the question whether there is room for it. stats may
 * be NULL. */
CHECKED status arguments_check_picture(const leafcast_scene *scene, const leafcast_camera *camera,
                                       const leafcast_image *image, const leafcast_stats *stats);

/* arguments_begin_view() - that such a camera can be filled, which is all 0 until it is. */
CHECKED status arguments_begin_view(const char *call, leafcast_camera *view, uint32_t width,
                                    uint32_t height);

/* Of structs that are filled: their sizes. */
CHECKED status arguments_check_stats(const leafcast_stats *stats); /* may be NULL */
CHECKED status arguments_check_info(const leafcast_info *info);

#endif
