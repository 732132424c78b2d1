/* view_camera.h - where the camera of view_options.h is, for a volume. */
#ifndef RENDER_APP_VIEW_CAMERA_H
#define RENDER_APP_VIEW_CAMERA_H

#include "render/app/view_options.h"

/* view_camera_of() - the camera for this volume: the view that fits the isovalues, field and
 * step (without an eye), or the standard or close view, with whatever was given put in its place.
 */
leafcast_camera view_camera_of(const view_options *v, const leafcast *volume);

/* view_camera_turn() - fix the camera of view_camera_of(), turned about the axis through
 * look_at along up by this share of a full turn, to the right as seen from above. */
void view_camera_turn(view_options *v, const leafcast *volume, double share);

/* view_camera_fit() - the view that fits, before anything else is put in its place; what `hold` is
 * to be for further pictures. view_camera_fits() - whether view_camera_of() starts from it.
 */
leafcast_camera view_camera_fit(const view_options *v, const leafcast *volume);
bool view_camera_fits(const view_options *v);

#endif
