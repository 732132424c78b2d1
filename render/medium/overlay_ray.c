#include "render/medium/overlay_ray.h"

#include <math.h>

void overlay_begin(overlay_lane lanes[], int count) {
    for (int i = 0; i < count; i++) {
        lanes[i].in_piece = lanes[i].ended = false;
        lanes[i].stretches = 0;
        lanes[i].walk = segments_begin(lanes[i].ahead, OVERLAY_AHEAD);
    }
}

/* Advance a lane to the piece that ends behind `from`. */
static segments_result step(const frame *f, const world_ray *w, overlay_lane *lane, double from,
                            ray_counters *counters) {
    const tracer *tr = &f->tracer[lane->volume];
    segments_result result = SEGMENTS_SOME;
    ray r;
    if (!tracer_ray(tr, w->origin, w->direction, w->t0, w->t1, &r))
        result = SEGMENTS_END;
    lane->walk.ahead = lane->ahead; /* lanes are copied */
    while (result == SEGMENTS_SOME && !(lane->in_piece && lane->piece.t1 > from)) {
        result = segments_next(tr, &r, &lane->walk, &lane->piece, counters);
        lane->in_piece = result == SEGMENTS_SOME && lane->piece.spread >= 0.0; /* no doubt */
    }
    lane->ended = result == SEGMENTS_END;
    return result;
}

/* Make the stretch from the first piece's start, or from `from` in pieces that have begun, to the
 * next start or end of any piece. */
static void stretch_of(const overlay_lane lanes[], int count, double from, overlay_stretch *out) {
    double begin = INFINITY;
    for (int i = 0; i < count; i++)
        if (lanes[i].in_piece)
            begin = fmin(begin, fmax(lanes[i].piece.t0, from));
    *out = (overlay_stretch){.t0 = begin, .t1 = INFINITY};
    for (int i = 0; i < count; i++) {
        const overlay_lane *l = &lanes[i];
        const bool begun = l->in_piece && l->piece.t0 <= begin;
        if (l->in_piece)
            out->t1 = fmin(out->t1, begun ? l->piece.t1 : l->piece.t0);
        if (begun)
            out->lane[out->count++] = l;
    }
}

enum { ASKED_EVERY = 64 }; /* check every so many stretches */

segments_result overlay_next(const frame *f, const world_ray *w, overlay_lane lanes[], int count,
                             double *from, overlay_stretch *out, int *blocked,
                             ray_counters *counters) {
    if (++lanes->stretches % ASKED_EVERY == 0 && !frame_goes_on(f))
        return SEGMENTS_END;
    for (int i = 0; i < count; i++) {
        const bool behind = !lanes[i].ended && !(lanes[i].in_piece && lanes[i].piece.t1 > *from);
        if (!behind || step(f, w, &lanes[i], *from, counters) != SEGMENTS_BLOCKED)
            continue;
        *blocked = i;
        return SEGMENTS_BLOCKED;
    }
    stretch_of(lanes, count, *from, out);
    *from = out->t1;
    return out->count > 0 ? SEGMENTS_SOME : SEGMENTS_END;
}
