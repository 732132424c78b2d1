/* keyframes.h - the views between views: movies from a few entries of a camera path. */
#ifndef RENDER_APP_KEYFRAMES_H
#define RENDER_APP_KEYFRAMES_H

#include <jansson.h>

#include "formats/base/status.h"

/* keyframes_spread() - so many views from the first to the last of keys, an array of objects as
 * render_script.h has them; a key is an equal time after the one before it. *path: an array of
 * `frames` objects, the caller's to json_decref().
 *
 * Where all keys have "eye" and "look-at", the camera goes by a Catmull-Rom spline through them:
 * what is looked at, the logarithm of the distance, the direction to the eye and "up", the last two
 * on the sphere. Other numbers of a view (isovalues, colours, opacities, windows, clips, lights)
 * change evenly, if both neighbours have as many; "step" goes up by whole steps. All else stays as
 * the key before has it.
 *
 * ST_USAGE: a key is no object. ST_NOMEM. */
CHECKED status keyframes_spread(const json_t *keys, int frames, json_t **path);

#endif
