/* clip_options.h - the values of flags that clip what is drawn. */
#ifndef RENDER_APP_CLIP_OPTIONS_H
#define RENDER_APP_CLIP_OPTIONS_H

#include "formats/base/status.h"
#include "render/leafcast.h"

/* clip_options_add_plane() - add the plane of "A,B,C,D" to the scene. clip_options_box() - take
 * "X0,Y0,Z0,X1,Y1,Z1". */
CHECKED status clip_options_add_plane(leafcast_scene *scene, const char *text);
CHECKED status clip_options_box(leafcast_scene *scene, const char *text);

#endif
