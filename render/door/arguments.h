/* arguments.h - checks of what callers of leafcast.h pass, before it is used.
 *
 * Holds the tables of the public structs (formats/public_fields.h), and all other checks, once for
 * all calls. A fault returns ST_USAGE with a description.
 *
 * Only this version's struct sizes are accepted: there is no other version yet. Whoever appends a
 * member must accept the earlier sizes, too, and give missing members their defaults.
 */
#ifndef RENDER_DOOR_ARGUMENTS_H
#define RENDER_DOOR_ARGUMENTS_H

#include "formats/public_fields.h"
#include "render/leafcast.h"

/* arguments_tables() - returns the *count tables of the structs of leafcast.h and
 * leafcast_experimental.h. */
const public_fields *const *arguments_tables(int *count);

/* arguments_check_volume() - check that v is not NULL and that this process opened it. A child of
 * fork() has neither the device's threads nor usable locks. arguments_check_device() - likewise. */
CHECKED status arguments_check_volume(const char *call, const leafcast *v);
CHECKED status arguments_check_device(const char *call, const leafcast_device *d);

/* arguments_check_values() - arguments_check_volume(), and that the volume is no surface itself
 * (LEAFCAST_ABILITY_GIVEN), which has values on it alone. arguments_check_points() - that it has
 * values at points: all do, but for such a surface that lies over no plane. */
CHECKED status arguments_check_values(const char *call, const leafcast *v);
CHECKED status arguments_check_points(const char *call, const leafcast *v);

CHECKED status arguments_check_options(const leafcast_options *options);
CHECKED status arguments_check_scene(const leafcast_scene *scene); /* without its groups */
CHECKED status arguments_check_group(const leafcast_group *group); /* without those in it */
CHECKED status arguments_check_surfaces(const leafcast_surface *surfaces, int count);
CHECKED status arguments_check_camera(const leafcast_camera *camera);
CHECKED status arguments_check_slice(const leafcast_slice_pixels *slice);

/* arguments_check_rays() - check `count` rays in one pass, fast beside tracing them.
 * arguments_check_ray() - check one ray of a call without a range of t. */
CHECKED status arguments_check_rays(const leafcast_ray *rays, size_t count);
CHECKED status arguments_check_ray(const double origin[3], const double direction[3]);

/* arguments_check_picture() - check the arguments that draw a picture, or that ask whether there is
 * room for one. stats may be NULL. */
CHECKED status arguments_check_picture(const leafcast_scene *scene, const leafcast_camera *camera,
                                       const leafcast_image *image, const leafcast_stats *stats);

/* arguments_begin_view() - check the size of a picture, and set all of *view but `size` to 0: the
 * caller fills it next. */
CHECKED status arguments_begin_view(const char *call, leafcast_camera *view, uint32_t width,
                                    uint32_t height);

/* Structs that the library fills: check their sizes. */
CHECKED status arguments_check_stats(const leafcast_stats *stats); /* may be NULL */
CHECKED status arguments_check_info(const leafcast_info *info);
CHECKED status arguments_check_cell(const leafcast_cell *cell);

#endif
