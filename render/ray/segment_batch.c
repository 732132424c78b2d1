#include "render/ray/segment_batch.h"

#include "render/ray/ray_kernels.h"

enum { AHEAD = 64 }; /* room for pieces; more saves time */

void segment_batch_single(const tracer *tr, segment_batch *b, unsigned i, ray_counters *counters) {
    segment ahead[AHEAD], piece;
    segments_state *s = b->state[i];
    segments_result result = SEGMENTS_SOME;
    segments_move(s, ahead, AHEAD);
    while (!b->stop[i] && result == SEGMENTS_SOME) {
        result = segments_next(tr, &b->rays[i], s, &piece, counters);
        if (result == SEGMENTS_SOME)
            segment_batch_add(b, i, &piece);
        /* Let a lenient ray stop before it meets what is lost behind: its pixel is exact. */
        if (b->columns.count == SEGMENT_COLUMNS || tr->lenient)
            segment_batch_flush(b);
    }
    segments_move(s, b->kept[i], SEGMENTS_KEPT);
    b->result[i] = result == SEGMENTS_BLOCKED ? SEGMENTS_BLOCKED : SEGMENTS_END;
}

void segment_batch_walk(const tracer *tr, segment_batch *b, void *scratch, ray_counters *counters) {
    const segment_batch_fn walk = tr->lenient ? NULL : tr->kernels->segment_batch;
    b->columns.count = 0;
    for (unsigned i = 0; i < b->count; i++)
        b->stop[i] = false;
    if (walk)
        walk(tr, b, scratch, counters);
    for (unsigned i = 0; i < b->count && !walk; i++)
        segment_batch_single(tr, b, i, counters);
    segment_batch_flush(b);
}
