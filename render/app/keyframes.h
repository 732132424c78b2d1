/* keyframes.h - interpolate the views of a movie between a few entries of a camera path. */
#ifndef RENDER_APP_KEYFRAMES_H
#define RENDER_APP_KEYFRAMES_H

#include <jansson.h>

#include "formats/base/status.h"

/* keyframes_spread() - compute `frames` views from the first to the last of keys, an array of
 * objects as in render_script.h. Keys are equally spaced in time. *path is an array of `frames`
 * objects, the caller's to json_decref().
 *
 * Where all keys have "eye" and "look-at", the camera follows a Catmull-Rom spline through them. It
 * interpolates the point looked at, the logarithm of the distance, the direction to the eye and
 * "up", the last two on the sphere. Other numbers of a view (isovalues, colours, opacities,
 * windows, clips, lights, "time") change linearly if both neighbours have as many; "step" changes
 * by whole steps. What a time means is the caller's (key_times.h). Everything else stays as in the
 * key before.
 *
 * file: the path's, for messages. ST_USAGE: a key is not an object. ST_NOMEM. */
CHECKED status keyframes_spread(const json_t *keys, const char *file, int frames, json_t **path);

#endif
