/* render_groups.h - where the groups of a picture are. */
#ifndef RENDER_APP_RENDER_GROUPS_H
#define RENDER_APP_RENDER_GROUPS_H

#include "render/app/render_job.h"

/* render_groups_place() - make job->placed, once all volumes are open and listed: lay tiles on the
 * ground, and hand places over to the library. render_groups_release() - in any case. */
CHECKED status render_groups_place(render_job *job);
void render_groups_release(render_job *job);

/* render_groups_box() - the box of all objects at all their places. */
void render_groups_box(const render_job *job, double box[2][3]);

#endif
