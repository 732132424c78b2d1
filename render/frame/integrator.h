/* integrator.h - turns a ray into a pixel: a row of functions for each way of looking.
 *
 * A frame (frame.h) begins a record for each ray that the kernel of tiles did not finish. The
 * integrator asks what is on the ray's way, and turns the answers into a pixel. The frame answers
 * the questions of many rays together (ray_advance.h), and keeps records that wait for a treelet.
 * Of a record, the frame knows only the head. The caller of a frame chooses the integrator and its
 * description: frame.integrator, frame.look.
 */
#ifndef RENDER_FRAME_INTEGRATOR_H
#define RENDER_FRAME_INTEGRATOR_H

#include "render/frame/frame.h"
#include "render/frame/tile.h"
#include "render/ray/extremes.h"
#include "render/ray/ray_bundle.h"
#include "render/ray/segment_batch.h"

/* All that a frame knows of a ray; the integrator's part of the record follows. */
typedef struct ray_record {
    uint32_t pixel;
    uint32_t next;    /* in its bucket, or in the list of free records */
    uint32_t blocked; /* the treelet that it waits for, */
    uint16_t volume;  /* of this volume, */
    uint16_t leg;     /* on this leg of its way; treelets for lower legs load first */
} ray_record;

/* A question about a ray's way through a volume: the next hit (state; tracer_next()), all pieces
 * (walk; segments_next()), or the greatest value (extreme; extreme_next()). The first of these that
 * is not NULL is asked. If all are NULL, the ray just waits for a treelet that the integrator
 * itself has missed. */
typedef struct ray_question {
    const tracer *tracer;
    trace_state *state;   /* of the record */
    segments_state *walk; /* of the record: how far pieces have come, with room for */
    segment *kept;        /* SEGMENTS_KEPT pieces ahead while the record waits */
    extreme_state *extreme;
    uint32_t missed; /* the treelet it waits for, where all are NULL */
    ray ray;
    object_list objects; /* of the integrator: what it knows of a ray's way through the scene. A
                            question of the same ray may find it again, and any other */
} ray_question;

typedef struct integrator {
    size_t record_bytes; /* of head and part; frame.record_more bytes follow */

    /* Fill the record of a pixel's ray before anything is traced. */
    void (*begin)(const frame *f, uint32_t pixel, ray_record *r);
    /* Go on until there is a question (true), or the pixel is written (false). Asking again before
     * the answer gives the same question. */
    bool (*ask)(const frame *f, ray_record *r, ray_question *q, ray_counters *counters);
    /* The question's state has been answered: TRACE_HIT or TRACE_MISS. TRACE_MISS also means that
     * there are no more pieces, or none are wanted, or that the greatest value is certain. */
    void (*answer)(const frame *f, ray_record *r, trace_result result);
    /* Take the next pieces of several rays; r[i] is ray i, and the pieces of each ray come in
     * order. Set stop[i] = true to get no more. scratch: take_scratch bytes, 64-byte aligned, not
     * initialised. A row that asks for no pieces may leave both out. */
    size_t take_scratch;
    void (*take)(const frame *f, ray_record *const r[], const segment_columns *pieces, bool stop[],
                 void *scratch);
    /* Returns the bundle that all rays form on a leg of their way. */
    ray_bundle (*bundle)(const frame *f, uint32_t leg);

    /* Returns the kernel that begins whole tiles of pixels, or NULL. The row may leave it out.
     */
    tile_fn (*tile)(const frame *f);
} integrator;

#endif
