/* leafcast_volume.h - what an open volume is made of: for the files that implement leafcast.h. */
#ifndef RENDER_LEAFCAST_VOLUME_H
#define RENDER_LEAFCAST_VOLUME_H

#include "render/frame.h"
#include "render/grid/intersect.h"
#include "render/kernels.h"

struct leafcast {
    mem budget;
    leafcast_options options;
    leaf_file *file;
    pool *threads;
    readers *readers; /* whose threads read for it; NULL: it has some of its own */
    loader *treelets;
    const struct kind *kind;
    void *own; /* the kind's part */
    affine space;
    kernels kernels;
    projection projection; /* of the frame that is being drawn */
    leafcast_surface surfaces[LEAFCAST_SURFACES_MAX];
    double isovalues[LEAFCAST_SURFACES_MAX];
    int surface_count;
    uint32_t field, step;
    leafcast *coarse;    /* a mesh's coarse grid, once a preview wants it; else NULL */
    uint32_t coarse_set; /* of which set */
    atomic_uchar *touched;
    uint8_t *stop;          /* per treelet, for --lod pixel */
    void *scratch;          /* of all threads, for frames */
    size_t base_bytes;      /* of the budget, before any treelet */
    size_t beside;          /* of the budget, the caller's: leafcast_check_room() */
    intersect_fn intersect; /* instead of the scene's, see experiment.h */
    double opened_at, open_s, first_image_s;
};

/* volume_public_status() - an internal status as the interface has it. */
leafcast_status volume_public_status(status st);

/* volume_check_set() - ST_USAGE where the file has no such field or step. */
CHECKED status volume_check_set(const leafcast *v, uint32_t field, uint32_t step);

/* volume_check_file() - what becomes of a picture or an answer with this status, now that it is
 * made: ST_CORRUPT if the file changed since it was opened. That is said then rather than which
 * bytes were found wrong. */
CHECKED status volume_check_file(const leafcast *v, status st);

/* volume_open_file() - all else of v, whose budget, options, kernels and file are there. */
CHECKED status volume_open_file(leafcast *v);

/* volume_tracer() - for rays through what is selected. c: the camera, for levels of detail by
 * pixels; may be NULL. */
CHECKED status volume_tracer(leafcast *v, const leafcast_scene *scene, const camera *c, tracer *tr);

/* volume_tracer_of_all() - likewise, whether a surface is selected or not. */
CHECKED status volume_tracer_of_all(leafcast *v, const leafcast_scene *scene, const camera *c,
                                    tracer *tr);

/* volume_treelet() - treelet t, brought in if need be: what rays have seen may have given way to
 * others since. */
CHECKED status volume_treelet(leafcast *v, uint32_t t, const treelet **out);

#endif
