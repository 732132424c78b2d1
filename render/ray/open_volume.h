/* open_volume.h - the parts of an open volume; for kinds, and for the files that implement
 * leafcast.h. */
#ifndef RENDER_RAY_OPEN_VOLUME_H
#define RENDER_RAY_OPEN_VOLUME_H

#include <pthread.h>

#include "formats/base/world_frame.h"
#include "render/leafcast.h"
#include "render/leafcast_experimental.h"
#include "render/ray/affine.h"
#include "render/ray/isovalue_list.h"
#include "render/ray/ray_kernels.h"
#include "stream/loader.h"

struct leafcast {
    leafcast_device *device;
    leafcast *next;           /* next volume on the device */
    mem *m;                   /* its budget */
    leafcast_options options; /* its experiments: */
    leafcast_experiments experiments;
    leaf_file *file;
    pthread_rwlock_t steps;  /* over what is told of the file's steps: see volume_hold() */
    struct live_steps *live; /* of a live volume (render/door/live_steps.h), or NULL */
    loader *treelets;
    const struct kind *kind;
    void *own; /* the kind's part */
    affine space;
    world_axes axes; /* of the world of `space` */
    ray_kernels kernels;
    const struct walk_choice *choice; /* of an experiment, or NULL */
    int threads;                      /* of the device */
    /* What rays look for now: */
    double isovalues[LEAFCAST_SURFACES_MAX];
    int isovalue_count;
    isovalue_list seek; /* those of them that the next tracer looks for */
    interest beside;
    uint32_t set;
    /* What leafcast_select() and leafcast_select_set() said: */
    leafcast_surface surfaces[LEAFCAST_SURFACES_MAX];
    int surface_count;
    uint32_t field, step; /* of a live volume: the file's step that is shown */
    double share;         /* ... and so much of the way to the next step */
    uint32_t preview_levels, cell_levels;
    int frames;          /* of a coarse grid: frames under way that draw it in a volume's place */
    leafcast *coarse;    /* its coarse grid, once a preview wants it; else NULL */
    uint32_t coarse_set; /* the set it was made from */
    bool coarse_inner;   /* the grid inside the one of that set was asked for */
    bool coarse_is_grid; /* those of sets are of samples; else of the same kind as the volume, with
                            one of samples inside */
    leafcast *between;   /* at times between steps (render/door/between_steps.h), once such a time
                            was asked for; else NULL */
    bool is_between;     /* what was asked for last was such a time */
    atomic_uchar *touched;
    int listed;        /* scratch of scene_check(): the first object of it in a scene */
    uint8_t *stop;     /* per treelet, for --lod pixel */
    size_t base_bytes; /* of the budget, taken before any treelet */
    double opened_at, open_s, first_image_s;
};

/* volume_treelet() - treelet t, loaded again if it has been evicted since rays saw it. */
CHECKED status volume_treelet(leafcast *v, uint32_t t, const treelet **out);

/* volume_check_level() - ST_USAGE if a scene asks for a coarse level of a kind that has none, or
 * only in previews, by coarse grids. Previews of several volumes take of each what it has. */
CHECKED status volume_check_level(const leafcast *v, const leafcast_scene *scene);

#endif
