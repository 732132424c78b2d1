/* integrator.h - what makes a pixel of a ray: a row of functions for each way of looking.
 *
 * A frame (frame.h) begins a record for each ray that tiles leave over. An integrator asks what is
 * on the ray's way and writes what comes of it; the frame has the questions of many rays answered
 * together (ray_advance.h), keeps records that wait for a treelet, and knows no more of them than
 * their heads. Whoever makes a frame says which integrator, and gives it its description:
 * frame.integrator, frame.look.
 */
#ifndef RENDER_FRAME_INTEGRATOR_H
#define RENDER_FRAME_INTEGRATOR_H

#include "render/frame/frame.h"
#include "render/frame/tile.h"
#include "render/ray/extremes.h"
#include "render/ray/ray_bundle.h"
#include "render/ray/segment_batch.h"

/* All that a frame knows of a ray; the integrator's part follows. */
typedef struct ray_record {
    uint32_t pixel;
    uint32_t next;    /* in its bucket, or among those that are free */
    uint32_t blocked; /* the treelet that it waits for, */
    uint16_t volume;  /* of this volume, */
    uint16_t leg;     /* on this leg of its way; treelets for lower ones come first */
} ray_record;

/* What is on a way through a volume: the next hit, which tracer_next() is to find, all pieces
 * (segments_next()), or the greatest value (extreme_next()). Of the three states one is asked for,
 * and those before it are NULL. Or nothing, until a treelet is there that an integrator has missed
 * by itself: none is asked for. */
typedef struct ray_question {
    const tracer *tracer;
    trace_state *state;   /* of the record */
    segments_state *walk; /* of the record: how far they have come, with room for */
    segment *kept;        /* SEGMENTS_KEPT pieces ahead while the record waits */
    extreme_state *extreme;
    uint32_t missed; /* the treelet, where all are NULL */
    ray ray;
} ray_question;

typedef struct integrator {
    size_t record_bytes; /* head and part; frame.record_more bytes follow */

    /* The ray of a pixel before anything is traced. */
    void (*begin)(const frame *f, uint32_t pixel, ray_record *r);
    /* Go on to the next question, or until the pixel is written (false). Until it is answered the
     * question stays the same. */
    bool (*ask)(const frame *f, ray_record *r, ray_question *q, ray_counters *counters);
    /* Its state has been answered: TRACE_HIT or TRACE_MISS; the latter where there are no more
     * pieces, or none are wanted, and where the greatest value is certain. */
    void (*answer)(const frame *f, ray_record *r, trace_result result);
    /* The next pieces of several rays, those of each in order: of ray i, r[i]; stop[i] = true where
     * no more are wanted. scratch: so many bytes, 64-byte aligned, whatever is in them. The row may
     * leave them out if it asks for none. */
    size_t take_scratch;
    void (*take)(const frame *f, ray_record *const r[], const segment_columns *pieces, bool stop[],
                 void *scratch);
    /* The bundle of all rays on a leg of their way. */
    ray_bundle (*bundle)(const frame *f, uint32_t leg);

    /* Returns what begins whole tiles of pixels, or NULL: nothing does. The row may leave it out.
     */
    tile_fn (*tile)(const frame *f);
} integrator;

#endif
