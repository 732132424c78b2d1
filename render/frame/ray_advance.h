/* ray_advance.h - rays of many pixels advance together: their questions are answered in batches.
 *
 * A ray gets the same answers as alone, to the bit, whatever the other rays ask.
 */
#ifndef RENDER_FRAME_RAY_ADVANCE_H
#define RENDER_FRAME_RAY_ADVANCE_H

#include "render/frame/integrator.h"
#include "render/ray/extreme_batch.h"
#include "render/ray/ray_batch.h"

typedef struct ray_group {
    unsigned count;                /* at most RAY_BATCH */
    ray_record *record[RAY_BATCH]; /* the caller's */
    bool blocked[RAY_BATCH];       /* needs the treelet that its head names; false: it is done */
    bool asks[RAY_BATCH];          /* this and the rest are only used within ray_advance() */
    ray_question question[RAY_BATCH];
    uint8_t asked[RAY_BATCH]; /* numbers of the rays in the current batch */
} ray_group;

/* Room for the pieces for integrator.take(), or for rays that look for the greatest value. */
typedef struct ray_pieces {
    union {
        segment_batch batch;
        extreme_batch extremes;
    };
    const frame *f;
    ray_record *record[RAY_BATCH];
    _Alignas(64) char scratch[]; /* integrator.take_scratch bytes */
} ray_pieces;

/* ray_pieces_bytes() - size of a ray_pieces for this integrator, a multiple of 64. */
size_t ray_pieces_bytes(const integrator *by);

/* ray_advance() - let all rays go on, blocked ones too, until each is blocked or its pixel is
 * written. *b, *pieces and scratch: room, see ray_batch.h. pieces may be NULL for an integrator
 * that asks for none. */
void ray_advance(const frame *f, ray_group *c, ray_batch *b, ray_pieces *pieces, void *scratch,
                 ray_counters *counters);

#endif
