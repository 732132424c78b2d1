/* render_job.h - draw described pictures of one open file and write them: what render does between
 * its flags and its messages. */
#ifndef RENDER_APP_RENDER_JOB_H
#define RENDER_APP_RENDER_JOB_H

#include "formats/base/mem.h"
#include "formats/base/progress.h"
#include "formats/base/status.h"
#include "render/app/image_out.h"
#include "render/app/picture_scene.h"
#include "render/app/render_script.h"
#include "render/app/render_stats.h"

/* A volume that is drawn together with the first one. */
enum { RENDER_ALSO_MAX = LEAFCAST_VOLUMES_MAX - 1 };
typedef struct render_also {
    const char *path;
    view_options view; /* its isosurfaces, field and step */
    leafcast *volume;
} render_also;

typedef struct render_job {
    mem m; /* of the planes; counted against the volume's budget by leafcast_trace() */
    leafcast *volume;
    render_also *also; /* also_count more, on the same device */
    int also_count;
    picture_scene scene;
    leafcast_info info;
    leafcast_camera fitted; /* to the first picture; width 0: to none yet */
    const char *source;     /* the treelet file's path, for the pictures' metadata */
    const progress *watch;
    double done, share; /* of the whole job: before this picture, and this picture; share 0:
                           unknown, only stop() is asked */
    image_out_options out;
    int repeat;
    bool certify;     /* see certificate.h */
    const char *font; /* of annotations: a file, or NULL: what is found; and once it is open: */
    text_face *face;
    /* Kept between pictures. */
    image_out *files;
    leafcast_image image;
    uint32_t width, height;
    leafcast_surface selected[LEAFCAST_SURFACES_MAX];
    int selected_count;
    uint32_t field, step;
} render_job;

/* render_status() - a public status as an internal one; the description is the same. */
status render_status(leafcast_status st);

/* render_job_open() - *job is zeroed but for out, repeat, font, also and watch, which the caller
 * has set. render_job_close() in any case. */
CHECKED status render_job_open(render_job *job, const char *path, const leafcast_options *options);
void render_job_close(render_job *job);

/* render_job_check() - what can be known to fail before anything is drawn: output files that exist,
 * names of no picture, flags that do not go together. Fills in defaults, see view_options_check().
 */
CHECKED status render_job_check(const render_job *job, script_frame *frame);

/* render_job_turn() - fix the view that a checked picture would have, turned by this share of a
 * full turn, see view_camera_turn(). */
void render_job_turn(render_job *job, view_options *view, double share);

/* render_job_draw() - open a checked picture's files, draw it job->repeat times, write them once.
 */
CHECKED status render_job_draw(render_job *job, const script_frame *frame, render_stats *stats);

#endif
