/* view_camera.h - compute the camera of view_options.h for a volume. */
#ifndef RENDER_APP_VIEW_CAMERA_H
#define RENDER_APP_VIEW_CAMERA_H

#include "render/app/view_options.h"

/* view_camera_of() - returns the camera for this volume: the view that fits isovalues, field and
 * step (if no eye is given), or the standard or close view. Values that flags give replace its own.
 */
leafcast_camera view_camera_of(const view_options *v, const leafcast *volume);

/* view_camera_turn() - fix the camera of view_camera_of(), turned by this share of a full turn
 * about the axis through look_at along up, to the right as seen from above. */
void view_camera_turn(view_options *v, const leafcast *volume, double share);

/* view_camera_fit() - returns the view that fits, without values from flags; store it in `hold` for
 * further pictures. view_camera_fits() - returns whether view_camera_of() starts from this view.
 */
leafcast_camera view_camera_fit(const view_options *v, const leafcast *volume);
bool view_camera_fits(const view_options *v);

#endif
