/* picture_scene.h - what a picture shows, as flags say it, as the library takes it: the scene of
 * one volume or several, and what it points to.
 */
#ifndef RENDER_APP_PICTURE_SCENE_H
#define RENDER_APP_PICTURE_SCENE_H

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "render/app/transfer_list.h"
#include "render/app/view_options.h"

/* A volume of the picture, and the flags that are about it. */
typedef struct picture_volume {
    leafcast *volume;
    const view_options *view;
} picture_volume;

typedef struct picture_scene {
    leafcast_shown shown[LEAFCAST_VOLUMES_MAX];
    transfer_list transfer[LEAFCAST_VOLUMES_MAX]; /* of the picture's volumes; none: no medium */
    leafcast_medium media[LEAFCAST_VOLUMES_MAX];  /* these */
    transfer_list caps;                           /* colours of caps; none: surfaces' own */
    leafcast_medium cap_colours;
    /* Whose values presets and windows go by: the first picture of this field has set the step, so
     * that colours mean the same at every step. */
    struct {
        bool known;
        uint32_t field, step;
    } measured[LEAFCAST_VOLUMES_MAX];
    leafcast_scene_experiments experiments;
} picture_scene;

/* picture_scene_init() - m holds its transfer functions. picture_scene_release() - in any case. */
void picture_scene_init(picture_scene *p, mem *m);
void picture_scene_release(picture_scene *p);

/* picture_scene_choose() - where flags give no isovalue, and no medium, one that is worth a look.
 * suggested: room for LEAFCAST_SUGGESTIONS_MAX; *count of them, 0: isovalues were given. volume
 * NULL: not open yet, any isovalue will do. ST_USAGE: none can be suggested. */
CHECKED status picture_scene_choose(const leafcast *volume, view_options *v, double *suggested,
                                    int *count);

/* picture_scene_describe() - *scene, which points into *p and to what the flags hold; count
 * volumes, of whose flags those of the first say what the picture is like. It lists its volumes
 * where there are several, or media, or always. */
CHECKED status picture_scene_describe(picture_scene *p, const picture_volume *volumes, int count,
                                      bool always, leafcast_scene *scene);

/* picture_scene_filled() - the first volume of a described scene that is filled; -1: none. */
int picture_scene_filled(const picture_scene *p, const leafcast_scene *scene);

/* picture_scene_mark() - draw legend and annotations over a picture as the camera took it, where
 * the flags ask for them. face: letters, which annotations need; NULL: the legend's are of dots. */
void picture_scene_mark(const picture_scene *p, const picture_volume *volumes,
                        const leafcast_scene *scene, const leafcast_camera *camera,
                        const leafcast_image *image, text_face *face);

#endif
