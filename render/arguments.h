/* arguments.h - what callers of leafcast.h pass, before it is used: sizes of structs, enumerations,
 * counts. A fault is described, ST_USAGE.
 *
 * All sizes are those of this version, as there is no other yet. Whoever appends a member accepts
 * the sizes of before, too, and gives what is missing its default.
 */
#ifndef RENDER_ARGUMENTS_H
#define RENDER_ARGUMENTS_H

#include "formats/base/status.h"
#include "render/leafcast.h"

CHECKED status arguments_check_options(const leafcast_options *options);
CHECKED status arguments_check_scene(const leafcast_scene *scene);
CHECKED status arguments_check_surfaces(const leafcast_surface *surfaces, int count);

/* arguments_check_picture() - of a picture, or the question whether there is room for it. stats may
 * be NULL. */
CHECKED status arguments_check_picture(const leafcast_scene *scene, const leafcast_camera *camera,
                                       const leafcast_image *image, const leafcast_stats *stats);

#endif
