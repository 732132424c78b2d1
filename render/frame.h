/* frame.h - one picture: tiles of rays over all threads, suspended rays, passes.
 *
 * A pixel's ray is a small state machine: find the next surface, then for each light whether it is
 * seen, then composite and go on behind the surface. Wherever it meets a treelet that is needed and
 * absent it suspends into that treelet's bucket; when the treelet is resident the bucket is run.
 * Records of suspended rays are limited: tiles wait while there is no room for all their rays. So
 * any budget that holds the directory, one treelet and one tile's rays a thread finishes, and the
 * picture is the same bits for all of them.
 */
#ifndef RENDER_FRAME_H
#define RENDER_FRAME_H

#include "formats/base/pool.h"
#include "render/camera.h"
#include "render/counters.h"
#include "render/leafcast.h"
#include "render/projection.h"
#include "render/tracer.h"

struct kernels;

typedef struct frame {
    mem *m;
    pool *threads;
    loader *treelets;
    const tracer *tracer;
    const tracer *coarse; /* drawn by a preview where treelets are absent; or NULL */
    const leafcast_scene *scene;
    const leafcast_surface *surfaces; /* one an isovalue */
    camera camera;
    const struct kernels *kernels;
    const projection *projection; /* NULL: every ray by itself, else tiles of them; see tile.h */
    uint32_t width, height;
    leafcast_image image;
    void *scratch;        /* frame_scratch_bytes() for each thread, not initialised */
    uint32_t records_max; /* suspended rays at a time, at least frame_records_min() */
    bool (*watch)(void *ctx, double done); /* see leafcast_trace() */
    void *watch_ctx;
} frame;

/* frame_render() - draw into f->image. ST_STOPPED when watch() said so; the planes are then partly
 * written. */
CHECKED status frame_render(const frame *f, ray_counters *counters);

/* frame_records_min() - the fewest records with which a frame can finish; frame_record_bytes() -
 * memory of one. */
uint32_t frame_records_min(const struct kind *k, int threads);
size_t frame_record_bytes(void);

/* frame_scratch_bytes() - memory that a thread draws in, whatever the picture; a multiple of 64. */
size_t frame_scratch_bytes(const struct kind *k);

/* frame_bytes() - memory that a frame needs beside records, treelets and image. */
size_t frame_bytes(const struct kind *k, uint32_t treelets, uint32_t records_max, uint32_t width,
                   uint32_t height, int threads);

#endif
