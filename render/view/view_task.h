/* view_task.h - what a view asks to be drawn, as the pace sees it (view_pace.h). */
#ifndef RENDER_VIEW_VIEW_TASK_H
#define RENDER_VIEW_VIEW_TASK_H

#include "render/app/picture_scene.h"
#include "render/view/view_pace.h"

/* Kinds of scenes; the times of each are learned separately. */
typedef enum view_way {
    VIEW_WAY_SURFACES,
    VIEW_WAY_BEHIND,
    VIEW_WAY_MEDIA,
    VIEW_WAY_SHADED,
    VIEW_WAY_EXTREMES,
    VIEW_WAY_MEANS,
    VIEW_WAYS
} view_way;

/* view_task_way() - returns the kind of a described scene, of flags that are checked. */
view_way view_task_way(const leafcast_scene *scene, const view_options *v);

/* view_task_of() - returns the task of drawing objects in a scene of this kind: the levels are
 * those of the one that has most, and cells the smallest in a pixel. */
view_task view_task_of(const picture_volume *objects, int count, const leafcast_scene *scene,
                       const leafcast_camera *camera, view_way of);

#endif
