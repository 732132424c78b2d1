/* segment_batch.h - the pieces of many rays through one volume (segments.h), in columns for
 * vectors.
 *
 * Each ray has the same pieces as alone, to the bit and in order. Pieces of different rays come
 * mixed.
 */
#ifndef RENDER_RAY_SEGMENT_BATCH_H
#define RENDER_RAY_SEGMENT_BATCH_H

#include "render/ray/ray_batch.h"
#include "render/ray/segments.h"

enum { SEGMENT_COLUMNS = 512 }; /* most pieces at a time */

typedef struct segment_columns {
    unsigned count;
    int degree; /* of all pieces */
    _Alignas(64) double t0[SEGMENT_COLUMNS], t1[SEGMENT_COLUMNS];
    double b[4][SEGMENT_COLUMNS]; /* b[0] .. b[degree] */
    double spread[SEGMENT_COLUMNS];
    uint32_t treelet[SEGMENT_COLUMNS];
    uint8_t ray[SEGMENT_COLUMNS]; /* its number in the batch */
} segment_columns;

typedef struct segment_batch {
    unsigned count; /* 1 to RAY_BATCH */
    ray rays[RAY_BATCH];
    segments_state *state[RAY_BATCH]; /* as of segments_begin(), or where a treelet was absent */
    segment *kept[RAY_BATCH];         /* room for SEGMENTS_KEPT pieces ahead, while the ray waits */
    segments_result
        result[RAY_BATCH]; /* SEGMENTS_END, or SEGMENTS_BLOCKED: state->blocked is needed */
    bool stop[RAY_BATCH];  /* set by take(): this ray wants no more pieces */
    /* take() - consume the next pieces: columns.count of them, at least 1. */
    void (*take)(void *ctx, struct segment_batch *b);
    void *ctx;
    segment_columns columns;
} segment_batch;

enum { SEGMENTS_KEPT = 4 };

/* segment_batch_fn - a kind's kernel: walks all rays of *b. scratch: kind_batches.scratch bytes of
 * the caller's, 64-byte aligned, not initialised. */
typedef void (*segment_batch_fn)(const tracer *tr, segment_batch *b, void *scratch,
                                 ray_counters *counters);

/* segment_batch_walk() - hand all pieces of all rays to take(), until each ray ends, stops or is
 * blocked: by the kind's kernel, or ray by ray where it has none. */
void segment_batch_walk(const tracer *tr, segment_batch *b, void *scratch, ray_counters *counters);

/* ---- For kinds ---- */

/* segment_batch_flush() - hand the pieces in the columns to take(). */
static inline void segment_batch_flush(segment_batch *b) {
    if (b->columns.count > 0)
        b->take(b->ctx, b);
    b->columns.count = 0;
}

/* segment_batch_add() - append a piece of ray i; the caller makes sure of room. */
static inline void segment_batch_add(segment_batch *b, unsigned i, const segment *s) {
    segment_columns *c = &b->columns;
    const unsigned at = c->count++;
    c->degree = (int)s->degree;
    c->t0[at] = s->t0;
    c->t1[at] = s->t1;
    for (uint32_t k = 0; k <= s->degree; k++)
        c->b[k][at] = s->b[k];
    c->spread[at] = s->spread;
    c->treelet[at] = s->treelet;
    c->ray[at] = (uint8_t)i;
}

/* segment_batch_single() - walk ray i alone; its pieces follow those in the columns. */
void segment_batch_single(const tracer *tr, segment_batch *b, unsigned i, ray_counters *counters);

#endif
