/* frame.h - one picture: tiles of rays over all threads, suspended rays, passes.
 *
 * Each pixel has a ray, and an integrator (integrator.h) that makes a pixel of it. Wherever that
 * needs a treelet that is absent, its record suspends into the treelet's bucket; when the treelet
 * is resident the bucket is run. Records of suspended rays are limited: tiles wait while there is
 * no room for all their rays. So any budget that holds the directories, one treelet of each volume
 * and one tile's rays a thread finishes, and the picture is the same bits for all of them.
 */
#ifndef RENDER_FRAME_FRAME_H
#define RENDER_FRAME_FRAME_H

#include <stdatomic.h>

#include "formats/base/pool.h"
#include "render/leafcast.h"
#include "render/look/camera.h"
#include "render/look/projection.h"
#include "render/ray/counters.h"
#include "render/ray/tracer.h"

struct integrator;

/* Volumes that a frame shows, at most. */
enum { FRAME_VOLUMES_MAX = 16 };

typedef struct frame {
    mem *m;
    pool *threads;
    const tracer *tracer; /* one a volume */
    int volumes;
    const struct integrator *integrator;
    const void *look;   /* the integrator's part: what it makes of rays */
    size_t record_more; /* bytes that its records have for this look, a multiple of 8 */
    camera camera;
    cpu_isa isa;                  /* of the integrator's own kernels */
    const projection *projection; /* of the first volume, or NULL: where tiles of a kind need it */
    uint32_t width, height;
    leafcast_image image;
    size_t stride;        /* of its planes: from row to row */
    void *scratch;        /* frame_scratch_bytes() for each thread, not initialised */
    uint32_t records_max; /* suspended rays at a time, at least frame_records_min() */
    bool (*watch)(void *ctx, double done); /* see leafcast_trace() */
    void *watch_ctx;
    const atomic_bool *cancel; /* ends it soon with ST_STOPPED once it is true; or NULL */
} frame;

/* frame_goes_on() - whether neither *cancel nor watch() says that it shall end; for rays that take
 * long. watch() is told less than 0: no news. */
static inline bool frame_goes_on(const frame *f) {
    return !(f->cancel && atomic_load_explicit(f->cancel, memory_order_relaxed)) &&
           (!f->watch || f->watch(f->watch_ctx, -1.0));
}

/* frame_plane() - where a pixel is in the image's planes. */
static inline size_t frame_plane(const frame *f, uint32_t pixel) {
    return pixel / f->width * f->stride + pixel % f->width;
}

typedef struct drawing drawing;

/* frame_begin() - a drawing of f, which is used until frame_end(); nothing is drawn yet. All its
 * memory is of f->m. */
CHECKED status frame_begin(const frame *f, drawing **out);

/* frame_advance() - go on. Nothing is begun after `until` (clock_seconds(), INFINITY: never) but
 * what makes some progress, so that any number of calls ends. *done when every pixel is written.
 * In between the loaders may serve others: they must have the same selection again, and forgotten
 * their failures. ST_STOPPED when watch() or *cancel said so; the planes are then partly written.
 * After any error there is only frame_end(). */
CHECKED status frame_advance(drawing *d, double until, bool *done);

/* frame_end() - adds what it took to the counters, which may be NULL. NULL for d is fine. */
void frame_end(drawing *d, ray_counters *total);

/* frame_render() - the three in a row. */
CHECKED status frame_render(const frame *f, ray_counters *counters);

/* The following need of f: tracer (kind, layout), volumes, integrator, threads, width and height.
 *
 * frame_records_min() - the fewest records with which a frame can finish; frame_record_bytes() -
 * memory of one. */
uint32_t frame_records_min(const frame *f);
size_t frame_record_bytes(const frame *f);

/* frame_scratch_bytes() - memory that a thread draws in, whatever the picture; a multiple of 64. */
size_t frame_scratch_bytes(const frame *f);

/* frame_bytes() - memory that a frame needs beside records, treelets and image. */
size_t frame_bytes(const frame *f, uint32_t records_max);

#endif
