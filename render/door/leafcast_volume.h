/* leafcast_volume.h - what an open volume is made of: for the files that implement leafcast.h. */
#ifndef RENDER_LEAFCAST_VOLUME_H
#define RENDER_LEAFCAST_VOLUME_H

#include "formats/public_status.h"
#include "render/frame/frame.h"
#include "render/grid/intersect.h"
#include "render/kernels.h"
#include "render/leafcast_experimental.h"

struct leafcast {
    leafcast_device *device;
    leafcast *next;           /* on it */
    mem *m;                   /* its budget */
    leafcast_options options; /* its experiments: */
    leafcast_experiments experiments;
    leaf_file *file;
    loader *treelets;
    const struct kind *kind;
    void *own; /* the kind's part */
    affine space;
    world_axes axes; /* of the world that space leads to */
    kernels kernels;
    /* What rays look for now: */
    double isovalues[LEAFCAST_SURFACES_MAX];
    int isovalue_count;
    interest beside;
    uint32_t set;
    /* What leafcast_select() and leafcast_select_set() said: */
    leafcast_surface surfaces[LEAFCAST_SURFACES_MAX];
    int surface_count;
    uint32_t field, step;
    uint32_t preview_levels;
    int frames;          /* of a coarse grid: under way, in which it is drawn in a mesh's place */
    leafcast *coarse;    /* a mesh's coarse grid, once a preview wants it; else NULL */
    uint32_t coarse_set; /* of which set */
    atomic_uchar *touched;
    uint8_t *stop;          /* per treelet, for --lod pixel */
    size_t base_bytes;      /* of the budget, before any treelet */
    intersect_fn intersect; /* instead of the scene's, see experiment.h */
    double opened_at, open_s, first_image_s;
};

/* volume_check_set() - ST_USAGE where the file has no such field or step. */
CHECKED status volume_check_set(const leafcast *v, uint32_t field, uint32_t step);

/* volume_check_file() - what becomes of a picture or an answer with this status, now that it is
 * made: ST_CORRUPT if the file changed since it was opened. That is said then rather than which
 * bytes were found wrong. */
CHECKED status volume_check_file(const leafcast *v, status st);

/* What follows is for whoever holds the device's lock.
 *
 * volume_on() - a volume without a file; NULL: no memory. volume_open_file() - all else of one that
 * has its file. volume_release() - what there is of it; it is none of the device's list. */
leafcast *volume_on(leafcast_device *d, const leafcast_options *options);
CHECKED status volume_open_file(leafcast *v);
void volume_release(leafcast *v);

/* volume_show() - from now on, rays look for these surfaces; loading starts. volume_show_beside() -
 * and also for what has these values. */
void volume_show(leafcast *v, uint32_t field, uint32_t step, const leafcast_surface *surfaces,
                 int count);
void volume_show_beside(const leafcast_shown *shown, const interest *beside);

/* volume_tracer() - for rays through what volume_show() said. c: the camera, for levels of detail
 * by pixels; may be NULL. */
CHECKED status volume_tracer(leafcast *v, const leafcast_scene *scene, const camera *c, tracer *tr);

/* volume_tracer_of_all() - likewise, whether a surface is selected or not. */
CHECKED status volume_tracer_of_all(leafcast *v, const leafcast_scene *scene, const camera *c,
                                    tracer *tr);

/* volume_treelet() - treelet t, brought in if need be: what rays have seen may have given way to
 * others since. */
CHECKED status volume_treelet(leafcast *v, uint32_t t, const treelet **out);

#endif
