/* frame.h - one picture: tiles of rays over all threads, suspended rays, passes.
 *
 * Each pixel has a ray. An integrator (integrator.h) turns the ray into the pixel. If this needs an
 * absent treelet, the ray is suspended: its record waits in the treelet's bucket, and goes on when
 * the treelet is resident. The number of records is limited, so a tile begins only when there are
 * enough for all its rays. So a frame finishes with any budget that holds the directories, one
 * treelet per volume and one tile's rays per thread. The picture is the same, to the bit, for all
 * budgets.
 */
#ifndef RENDER_FRAME_FRAME_H
#define RENDER_FRAME_FRAME_H

#include <stdatomic.h>

#include "formats/base/pool.h"
#include "render/frame/object_tree.h"
#include "render/leafcast.h"
#include "render/look/camera.h"
#include "render/look/projection.h"
#include "render/ray/counters.h"
#include "render/ray/tracer.h"

struct integrator;

typedef struct frame {
    mem *m;
    pool *threads;
    const tracer *tracer; /* one a volume of the scene, and of its groups. Objects are volumes; but
                             one of a group is many objects, and its tracer has no place */
    int volumes;
    int lookups; /* more tracers, behind the objects': rays do not meet them, but ask for values */
    const object_tree *objects;     /* over the boxes of all; NULL: rays ask each, object i is of
                                       volume i, and no volume is of a group */
    bool coarse;                    /* some tracer is `coarse` */
    const tracer *const *stand_ins; /* one a volume, of any kind: what is asked where its treelets
                                       are absent; NULL for none, and for all of them */
    const struct integrator *integrator;
    const void *look;   /* description for the integrator */
    size_t record_more; /* bytes that records need more for this look, a multiple of 8 */
    camera camera;
    cpu_isa isa;                  /* of the integrator's own kernels */
    const projection *projection; /* of the first volume; NULL unless its kind's tiles need one */
    uint32_t width, height;
    uint32_t sample, samples; /* it draws this one of so many rays a pixel; 0, 0: the only one */
    leafcast_image image;
    size_t stride;        /* of the image's planes, from row to row */
    void *scratch;        /* frame_scratch_bytes() for each thread, not initialised */
    uint32_t records_max; /* most suspended rays, at least frame_records_min() */
    bool (*watch)(void *ctx, double done); /* see leafcast_trace() */
    void *watch_ctx;
    const atomic_bool *cancel; /* once true, the frame soon ends with ST_STOPPED; or NULL */
} frame;

/* frame_goes_on() - for rays that take long: returns false when *cancel or watch() ask to stop.
 * Calls watch() with a negative number, which tells no progress. */
static inline bool frame_goes_on(const frame *f) {
    return !(f->cancel && atomic_load_explicit(f->cancel, memory_order_relaxed)) &&
           (!f->watch || f->watch(f->watch_ctx, -1.0));
}

/* frame_objects() - how many objects there are. frame_object() - returns the first one, from `from`
 * on, that a ray of the scene may meet in [t0, t1]; frame_objects(): there is none.
 * frame_grouped() - whether an object is of a group. */
static inline uint32_t frame_objects(const frame *f) {
    return f->objects ? f->objects->objects : (uint32_t)f->volumes;
}
static inline uint32_t frame_object(const frame *f, const double origin[3],
                                    const double direction[3], double t0, double t1,
                                    uint32_t from) {
    if (!f->objects || from >= f->objects->objects)
        return from;
    const object_ray r = {origin, direction, t0, t1};
    return object_tree_from(f->objects, &r, from);
}
static inline bool frame_grouped(const frame *f, uint32_t object) {
    return f->objects && object_tree_grouped(f->objects, object);
}

/* frame_volume() - returns the number of an object's volume. *place: set to where it is, if it is
 * of a group; else its tracer knows. */
static inline uint16_t frame_volume(const frame *f, uint32_t object, placement *place) {
    return (uint16_t)(frame_grouped(f, object) ? object_tree_place(f->objects, object, place)
                                               : object);
}

/* frame_plane() - index of a pixel in the image's planes. */
static inline size_t frame_plane(const frame *f, uint32_t pixel) {
    return pixel / f->width * f->stride + pixel % f->width;
}

typedef struct drawing drawing;

/* frame_begin() - make a drawing of f, which must live until frame_end(). Draws nothing yet. All
 * its memory comes from f->m. */
CHECKED status frame_begin(const frame *f, drawing **out);

/* frame_advance() - draw until clock_seconds() is `until`; INFINITY: to the end. Each call makes
 * some progress, even if that time is over, so repeated calls finish. *done: every pixel is
 * written. Between calls the loaders may serve other frames. Before the next call they must have
 * the same selection again, and no failures. ST_STOPPED when watch() or *cancel ask to stop; the
 * planes are then partly written. After an error only frame_end() may be called. */
CHECKED status frame_advance(drawing *d, double until, bool *done);

/* frame_end() - free the drawing, and add its costs to the counters. Both may be NULL. */
void frame_end(drawing *d, ray_counters *total);

/* frame_render() - frame_begin(), frame_advance() and frame_end() in a row. */
CHECKED status frame_render(const frame *f, ray_counters *counters);

/* The following functions use only these members of f: tracer (kind, layout), volumes, integrator,
 * threads, width and height.
 *
 * frame_records_min() - the fewest records with which a frame can finish. */
uint32_t frame_records_min(const frame *f);

/* frame_record_bytes() - memory of one record. */
size_t frame_record_bytes(const frame *f);

/* frame_scratch_bytes() - scratch memory per thread, for any size of the picture; a multiple of 64.
 */
size_t frame_scratch_bytes(const frame *f);

/* frame_bytes() - memory of a frame beside records, treelets and image. */
size_t frame_bytes(const frame *f, uint32_t records_max);

#endif
