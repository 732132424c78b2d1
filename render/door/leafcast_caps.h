/* leafcast_caps.h - caps: they close the surfaces that a clip has cut open (leafcast_scene.caps).
 *
 * A pixel has a cap where its ray enters the volume through a clip, at a point whose value is an
 * isovalue or more: without it the ray would see the surface from behind, or nothing. Caps are
 * drawn over a finished picture, all at once. Their values are sampled at points
 * (point_samples.h), so only treelets that a clip cuts are read.
 */
#ifndef RENDER_DOOR_LEAFCAST_CAPS_H
#define RENDER_DOOR_LEAFCAST_CAPS_H

#include "render/door/leafcast_turn.h"
#include "render/look/transfer.h"

/* caps_draw() - draw the caps of the turn's scene over the finished picture f. colours: maps values
 * to colours; NULL: caps have their surface's colour. Takes the budget for points, so call
 * turn_prepare() next. */
CHECKED status caps_draw(turn *t, const frame *f, const transfer *colours, ray_counters *counters);

#endif
