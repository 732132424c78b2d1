/* picture_scene.h - build a library scene from flags, for one volume or several, and hold the data
 * that it points to.
 */
#ifndef RENDER_APP_PICTURE_SCENE_H
#define RENDER_APP_PICTURE_SCENE_H

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "render/app/colour_by.h"
#include "render/app/transfer_list.h"
#include "render/app/view_options.h"

/* An object of the picture: a volume, its flags, and where it is (leafcast_shown.place). */
typedef struct picture_volume {
    leafcast *volume;
    const view_options *view;
    const double *place;
    int group; /* number of the group in which it lies, from 1 on; 0: in none */
} picture_volume;

/* What is placed many times (leafcast_group). */
typedef struct picture_group {
    int parent;              /* the group in which it lies, from 1 on; 0: in none */
    leafcast_places *places; /* NULL: nowhere, */
    bool chosen;             /* unless places of that say where it lies */
} picture_group;

/* The step whose values set presets and windows: that of the first picture of this field. So
 * colours mean the same at every step. */
typedef struct picture_measured {
    bool known;
    uint32_t field, step;
    uint32_t opened; /* of colour_by */
} picture_measured;

typedef struct picture_scene {
    mem *m;
    bool opens; /* flags may name files to open; set it after picture_scene_init() */
    int room;   /* elements of the arrays, one an object: */
    leafcast_shown *shown;
    transfer_list *transfer;  /* empty: no medium */
    leafcast_medium *media;   /* the same, for the scene */
    leafcast_medium *colours; /* of surfaces, by value */
    picture_measured *measured;
    colour_by *by;                  /* of the first object of its volume and --colour-by; */
    leafcast_colouring *colourings; /* of all */
    transfer_list caps;             /* colours of caps; empty: the surfaces' own */
    leafcast_medium cap_colours;
    const picture_group *groups; /* group_count of them, level by level; objects come in this order,
                                    those of none first. Set them after picture_scene_init() */
    int group_count;
    leafcast_group *grouped; /* for the scene */
    leafcast_scene_experiments experiments;
} picture_scene;

/* picture_scene_init() - start empty; m allocates the transfer functions. picture_scene_release() -
 * call it in any case. picture_scene_renew() - begin another run of pictures; files that flags have
 * opened stay open. */
void picture_scene_init(picture_scene *p, mem *m);
void picture_scene_release(picture_scene *p);
void picture_scene_renew(picture_scene *p);

/* picture_scene_choose() - find the step of --time, and choose an isovalue if the flags give
 * neither isovalue nor medium. suggested: room for LEAFCAST_SUGGESTIONS_MAX; *count: how many are
 * suggested, 0 if the flags gave isovalues. volume NULL: not open yet, sets any isovalue. ST_USAGE:
 * none can be suggested.
 * picture_scene_check_used() - ST_USAGE: isovalues were given for a surface, which has none. */
CHECKED status picture_scene_check_used(const leafcast *volume, const view_options *v);
CHECKED status picture_scene_choose(const leafcast *volume, view_options *v, double *suggested,
                                    int *count);

/* picture_scene_describe() - fill in *scene, which points into *p and to data of the flags. The
 * first volume's flags describe the picture as a whole. The scene lists its `count` volumes if
 * there are several or any has a medium, or if `always`. */
CHECKED status picture_scene_describe(picture_scene *p, const picture_volume *volumes, int count,
                                      bool always, leafcast_scene *scene);

/* picture_scene_filled() - returns the first volume of a described scene that has a medium; -1:
 * none. */
int picture_scene_filled(const picture_scene *p, const leafcast_scene *scene);

/* picture_scene_mark() - draw legend and annotations over a picture that the camera has taken, if
 * the flags ask for them. face: the font, required for annotations; NULL: the legend uses letters
 * of dots. */
void picture_scene_mark(const picture_scene *p, const picture_volume *volumes,
                        const leafcast_scene *scene, const leafcast_camera *camera,
                        const leafcast_image *image, text_face *face);

#endif
