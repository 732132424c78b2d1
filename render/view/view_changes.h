/* view_changes.h - what a page has changed of a scene's objects.
 *
 * In a page's state, "objects" is an array of
 *
 *   {"index": 2, "hidden": true, "flags": {"iso": [37], "colour": ["#ff0000"]}}
 *
 * hidden: the object is left out. flags: they replace all that the scene file says of it, but where
 * it is and its file. "page" is the page's own, as that of a state. A page may name a file only
 * where the scene file names it for that object.
 */
#ifndef RENDER_VIEW_VIEW_CHANGES_H
#define RENDER_VIEW_VIEW_CHANGES_H

#include "render/view/view_scene.h"

typedef struct view_change {
    int object;
    bool hidden;
    bool flags;        /* `view` replaces the object's own flags */
    view_options view; /* not checked against each other yet */
} view_change;

/* Constant once they are made; shared by whoever holds them. */
typedef struct view_changes view_changes;

/* view_changes_apply() - set *all, the flags of the picture, and *out from a page's state.
 * ST_USAGE: unknown keys, wrong values, names of files, no such object, flags at the wrong place;
 * all objects hidden. */
CHECKED status view_changes_apply(mem *m, json_t *state, const view_scene *s, view_options *all,
                                  view_changes **out);

/* view_changes_hold() - returns them, held once more. view_changes_drop() - the last one frees
 * them. NULL is allowed; any thread. */
view_changes *view_changes_hold(view_changes *c);
void view_changes_drop(view_changes *c);

/* view_changes_view() - returns an object's flags. view_changes_hides() - whether it is hidden. c:
 * NULL: nothing is changed. */
const view_options *view_changes_view(const view_changes *c, const view_scene *s, int object);
bool view_changes_hides(const view_changes *c, int object);

/* view_changes_any() - returns whether an object is changed or hidden. */
bool view_changes_any(const view_changes *c);

#endif
