/* view_cast.h - what a picture of a scene shows: its objects that are not hidden, with the flags
 * that a page has set, checked as render checks them.
 */
#ifndef RENDER_VIEW_VIEW_CAST_H
#define RENDER_VIEW_VIEW_CAST_H

#include "render/view/view_changes.h"

typedef struct view_cast {
    render_job job;     /* with the scene's volumes and places */
    script_frame frame; /* its flags are the picture's, and the first shown object's */
    int *objects;       /* the scene's number of the job's volume, and of each of its `also` */
    int *owner;         /* ... and of each of its objects, which are one for each place */
    int *first;         /* for the making */
} view_cast;

/* view_cast_make() - choose and check what is drawn. all: as view_changes_apply() has set it,
 * with the size. ST_USAGE: it cannot be drawn. Where a page has changed objects, flags of the
 * picture may have lost what they are of (lights, without surfaces): they are let pass, as they
 * change nothing. view_cast_idle() - returns whether a flag is one of these. view_cast_free() -
 * NULL is allowed. */
CHECKED status view_cast_make(mem *m, const view_scene *s, const view_options *all,
                              const view_changes *c, view_cast **out);
bool view_cast_idle(mem *m, const view_scene *s, const view_options *all, const view_changes *c,
                    const char *flag);

/* view_cast_room() - check that a picture fits into memory, as leafcast_check_room(). ST_NOMEM
 * names the object that alone would not, if there is one. */
CHECKED status view_cast_room(const view_cast *cast, const view_scene *s,
                              const leafcast_scene *scene, const leafcast_camera *camera,
                              const leafcast_image *planes, uint64_t beside);
void view_cast_free(mem *m, view_cast *cast);

#endif
