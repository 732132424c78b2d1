/* view_saved.h - a scene as a page shows it, as text of a scene file (leafcast-scene(5)).
 *
 * Files are named as in the scene file that is shown, so that the text belongs into its folder.
 * Objects are told in full: with colours and isovalues that were chosen for them.
 */
#ifndef RENDER_VIEW_VIEW_SAVED_H
#define RENDER_VIEW_VIEW_SAVED_H

#include "render/view/view_message.h"
#include "render/view/view_scene.h"

/* view_saved_scene() - make the text of a state, without a size. *out is the caller's. ST_USAGE:
 * what it says cannot be drawn. */
CHECKED status view_saved_scene(mem *m, const view_scene *s, const char *state, view_message **out);

#endif
