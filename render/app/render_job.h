/* render_job.h - draw described pictures of one open file and write them: the work of `leafcast
 * render` between reading its flags and printing its messages. */
#ifndef RENDER_APP_RENDER_JOB_H
#define RENDER_APP_RENDER_JOB_H

#include "formats/base/mem.h"
#include "formats/base/progress.h"
#include "formats/base/status.h"
#include "render/app/image_out.h"
#include "render/app/picture_scene.h"
#include "render/app/render_script.h"
#include "render/app/render_stats.h"

/* Where a volume is drawn: `count` places of 12 numbers (leafcast_shown.place), one after the
 * other; 0: once, where its file says. */
typedef struct render_places {
    double *at;
    int count;
} render_places;

/* A scene that another places many times, or an object of a scene: the volumes of this group lie
 * in it. */
typedef struct render_group {
    int parent; /* the group in which it lies, from 1 on; 0: none */
    render_places places;
    const struct scene_tiles *tiles; /* by which these are found, once files are open; or NULL */
    uint16_t *which;                 /* then: what lies at each */
    bool chosen;                     /* has no places, but lies where that says so */
} render_group;

/* A volume that is drawn together with the first one. */
typedef struct render_also {
    const char *path;
    char *allocated;   /* NULL, or the same */
    view_options view; /* its isosurfaces, field and step */
    leafcast *volume;
    int same; /* the number of the volume whose file is this one, opened before: 1 is also[0], 0 the
                 picture's first; -1: none */
    render_places places;
    int group; /* in which it lies, from 1 on, then at one place at most; 0: none */
} render_also;

typedef struct render_job {
    mem m; /* allocates the planes; leafcast_trace() counts them against the volume's budget */
    leafcast *volume;
    render_also *also; /* also_count more volumes, on the same device */
    int also_count;
    bool fits_all;        /* views are of all objects, in the scene's world */
    render_places places; /* of the first volume */
    int group;            /* of that, too; then all volumes are of groups */
    render_group *groups; /* group_count of them, level by level; volumes come in this order */
    int group_count;
    picture_group *placed;   /* the same, made */
    picture_volume *objects; /* of all, each at each of its places; its flags are those of `also` */
    int object_count;
    picture_scene scene;
    leafcast_info info;
    leafcast_camera fitted; /* the view fitted to the first picture; width 0: none yet */
    const char *source;     /* the treelet file's path, for the pictures' metadata */
    const progress *watch;
    double done, share; /* shares of the whole job: before this picture, and for it; share 0:
                           unknown, then only stop() is called */
    image_out_options out;
    int repeat;
    bool certify;     /* see certificate.h */
    bool progressive; /* write a preview first */
    const char *font; /* font file of annotations; NULL: a common one */
    text_face *face;
    /* Kept between pictures, from here on. */
    image_out *files;
    leafcast_image image;
    uint32_t width, height;
    leafcast_surface selected[LEAFCAST_SURFACES_MAX];
    int selected_count;
    uint32_t field, step;
    double between;   /* ... so much of the way to the next step */
    int drawn, empty; /* pictures so far; of these, without any surface (render_picture.h) */
    int lacking;      /* and those that lack treelets that are lost */
} render_job;

/* render_status() - convert a public status to an internal one; its description stays. */
status render_status(leafcast_status st);

/* render_job_open() - open the volumes. The caller has zeroed *job and set out, repeat, font, also
 * and watch. Call render_job_close() in any case. */
CHECKED status render_job_open(render_job *job, const char *path, const leafcast_options *options);
void render_job_close(render_job *job);

/* render_job_check() - check before drawing what can fail: existing output files, names without a
 * picture's suffix, flags that contradict each other. Fills in defaults, see view_options_check().
 */
CHECKED status render_job_check(const render_job *job, script_frame *frame);

/* render_job_list() - list the objects of `volume` and `also`, which are open, in `objects`: freed
 * by render_job_unlist(). render_job_objects() - returns them, for a picture whose first volume has
 * these flags. render_job_camera() - returns the camera of a picture, of all objects if
 * `fits_all`. */
CHECKED status render_job_list(render_job *job);
void render_job_unlist(render_job *job);
const picture_volume *render_job_objects(const render_job *job, const view_options *first);
leafcast_camera render_job_camera(render_job *job, const view_options *view);

/* render_job_turn() - fix the view of a checked picture, turned by this share of a full turn, see
 * view_camera_turn(). */
void render_job_turn(render_job *job, view_options *view, double share);

/* render_job_draw() - open the files of a checked picture, draw it job->repeat times, write it
 * once.
 */
CHECKED status render_job_draw(render_job *job, const script_frame *frame, render_stats *stats);

#endif
