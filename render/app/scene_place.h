/* scene_place.h - the places of an object, from JSON: a matrix, or steps one after the other. */
#ifndef RENDER_APP_SCENE_PLACE_H
#define RENDER_APP_SCENE_PLACE_H

#include <jansson.h>

#include "formats/base/status.h"

/* scene_place_read() - make the 12 numbers of leafcast_shown.place from a value of "transform": 12
 * numbers; a step; or an array of steps, of which the first comes first. ST_USAGE names `what`. */
CHECKED status scene_place_read(const json_t *value, const char *what, double place[12]);

/* scene_place_keys() - the keys of a step, one string each, to NULL. */
extern const char *const scene_place_keys[];

#endif
