/* leafcast_caps.h - caps: what a clip has cut open is closed by the cut (leafcast_scene.caps).
 *
 * A pixel has a cap where its ray enters the volume through a clip, at a place whose value is an
 * isovalue or more: the ray would see the surface from behind, or nothing. Caps come over a picture
 * when it is drawn, all of them at once: the values are those of points (point_samples.h), so no
 * treelet is read but those that a clip cuts.
 */
#ifndef RENDER_DOOR_LEAFCAST_CAPS_H
#define RENDER_DOOR_LEAFCAST_CAPS_H

#include "render/door/leafcast_turn.h"
#include "render/look/transfer.h"

/* caps_draw() - over the picture f, which is drawn, of the turn's scene. colours: by the values, or
 * NULL: by surfaces. Takes the budget for points: turn_prepare() comes next. */
CHECKED status caps_draw(turn *t, const frame *f, const transfer *colours, ray_counters *counters);

#endif
