/* colour_map.h - colour maps: by name, and from the points that a file has.
 *
 * viridis, plasma, inferno and magma (Nathaniel Smith, Stefan van der Walt, Eric Firing; CC0) have
 * 19 to 29 points each, between which light is linear: no component of their 256 colours is further
 * off than 1 of 255, as a screen shows them. The others are made by formula. What lies between the
 * points of a map becomes lines in linear light, to within half a step of 8 bits
 * (transfer_curve.h).
 */
#ifndef RENDER_APP_COLOUR_MAP_H
#define RENDER_APP_COLOUR_MAP_H

#include "render/app/colour_space.h"
#include "render/app/transfer_list.h"

/* A colour as a screen shows it, each component in [0, 1]. */
typedef struct colour_point {
    double value, rgb[3];
} colour_point;

/* colour_map_names() - of all maps, divided by '|', the default first. */
const char *colour_map_names(void);

/* colour_map_named() - put a map into an empty list, values 0 to 1. ST_AGAIN: there is none of this
 * name. ST_NOMEM. */
CHECKED status colour_map_named(const char *name, transfer_list *out);

/* colour_map_convert() - points, at least one, whose values do not fall, behind those of a list.
 * Errors as of transfer_list_add(). */
CHECKED status colour_map_convert(colour_space space, const colour_point *points, size_t count,
                                  transfer_list *out);

#endif
