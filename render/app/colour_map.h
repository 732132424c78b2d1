/* colour_map.h - colour maps: by name, and from the points of a file.
 *
 * viridis, plasma, inferno and magma (Nathaniel Smith, Stefan van der Walt, Eric Firing; CC0) are
 * stored as 19 to 29 points each, linear in light between points. No component of their 256 colours
 * is off by more than 1 of 255 (sRGB). The other maps are computed by formula. Between its points,
 * a map becomes lines in linear light, to within half a step of 8 bits (transfer_curve.h).
 */
#ifndef RENDER_APP_COLOUR_MAP_H
#define RENDER_APP_COLOUR_MAP_H

#include "render/app/colour_space.h"
#include "render/app/transfer_list.h"

/* A value and its colour in sRGB, each component in [0, 1]. */
typedef struct colour_point {
    double value, rgb[3];
} colour_point;

/* colour_map_names() - returns the names of all maps, separated by '|', the default first. */
const char *colour_map_names(void);

/* colour_map_named() - put the map of this name into an empty list, values 0 to 1. Returns ST_AGAIN
 * if there is none of this name, or ST_NOMEM. */
CHECKED status colour_map_named(const char *name, transfer_list *out);

/* colour_map_convert() - append points (at least one, with values that do not fall) to a list.
 * Errors as from transfer_list_add(). */
CHECKED status colour_map_convert(colour_space space, const colour_point *points, size_t count,
                                  transfer_list *out);

#endif
