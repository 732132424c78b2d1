#include "render/segments.h"

#include <string.h>

#include "render/cubic.h"
#include "render/kind.h"

segments_state segments_begin(segment *ahead, uint32_t room) {
    return (segments_state){.ahead = ahead,
                            .room = room,
                            .t_from = -INFINITY,
                            .blocked = LEAF_NO_TREELET,
                            .entered = LEAF_NO_TREELET,
                            .limit = {.t0 = INFINITY},
                            .last = {.t0 = -INFINITY}};
}

segments_result segments_next(const tracer *tr, const ray *r, segments_state *state, segment *out,
                              ray_counters *counters) {
    if (state->sure == 0) {
        memmove(state->ahead, state->ahead + state->first, state->count * sizeof *state->ahead);
        state->first = 0;
        const segments_result result = tr->kind->segments(tr, r, state, counters);
        if (result != SEGMENTS_SOME)
            return result;
    }
    *out = state->ahead[state->first++];
    state->last = (segment_key){out->t0, out->cell};
    state->sure--;
    state->count--;
    return SEGMENTS_SOME;
}

void segments_move(segments_state *s, segment *to, uint32_t room) {
    if (s->count > room) {
        const segment *lost = &s->ahead[s->first + room];
        const segment_key from = {lost->t0, lost->cell};
        s->limit = segment_key_less(from, s->limit) ? from : s->limit;
        s->count = room;
        s->sure = s->sure < room ? s->sure : room;
    }
    memmove(to, s->ahead + s->first, s->count * sizeof *to);
    s->ahead = to;
    s->room = room;
    s->first = 0;
}

segments_error segments_error_of(const tracer *tr, const ray *r, const double range[2]) {
    return tr->kind->segments_error(tr, r, range);
}

/* ---- A piece ---- */

static double mix(double a, double b, double s) {
    return (1.0 - s) * a + s * b;
}

double segment_at(const segment *s, double at) {
    double b[4];
    memcpy(b, s->b, sizeof b);
    for (uint32_t left = s->degree; left > 0; left--)
        for (uint32_t i = 0; i < left; i++)
            b[i] = mix(b[i], b[i + 1], at);
    return b[0];
}

double segment_t(const segment *s, double at) {
    return at < 1.0 ? fmin(s->t0 + at * (s->t1 - s->t0), s->t1) : s->t1;
}

static void widen(segment_extent *e, double value, double t) {
    if (value < e->least) {
        e->least = value;
        e->least_t = t;
    }
    if (value > e->most) {
        e->most = value;
        e->most_t = t;
    }
}

segment_extent segment_range(const segment *s) {
    segment_extent e = {s->b[0], s->b[0], s->t0, s->t0};
    double at[2];
    const int inner = s->degree == 3 ? cubic_extrema(s->b, at) : 0;
    for (int i = 0; i < inner; i++)
        widen(&e, segment_at(s, at[i]), segment_t(s, at[i]));
    widen(&e, s->b[s->degree], s->t1);
    return e;
}
