#include "render/ray/segments.h"

#include <string.h>

#include "render/ray/cubic.h"
#include "render/ray/kind.h"

segments_state segments_begin(segment *ahead, uint32_t room) {
    return (segments_state){.ahead = ahead,
                            .room = room,
                            .t_from = -INFINITY,
                            .blocked = LEAF_NO_TREELET,
                            .doubted = LEAF_NO_TREELET,
                            .entered = LEAF_NO_TREELET,
                            .limit = {.t0 = INFINITY},
                            .last = {.t0 = -INFINITY}};
}

segments_result segments_next(const tracer *tr, const ray *r, segments_state *state, segment *out,
                              ray_counters *counters) {
    if (state->sure == 0) {
        memmove(state->ahead, state->ahead + state->first, state->count * sizeof *state->ahead);
        state->first = 0;
        const segments_result result = tr->kind->walks->segments(tr, r, state, counters);
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

double segment_value_error(const segment *s, const segments_error *error) {
    double largest = fabs(s->b[0]), step = 0.0;
    for (uint32_t i = 0; i < s->degree; i++) {
        largest = fmax(largest, fabs(s->b[i + 1]));
        step = fmax(step, fabs(s->b[i + 1] - s->b[i]));
    }
    /* The slope is a weighted mean of its Bernstein coefficients; the value stays within the range
     * of its own. */
    if (s->spread == SEGMENT_EVEN)
        return 0.0;
    const double by_t = s->degree * step * fmin(error->t / (s->t1 - s->t0), 1.0);
    return error->value + by_t + 16.0 * 0x1p-53 * largest;
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

segment_gradient segment_gradient_of(const double b[3][4]) {
    segment_gradient g;
    for (int a = 0; a < 3; a++) {
        g.power[a][0] = b[a][0];
        g.power[a][1] = 3.0 * (b[a][1] - b[a][0]);
        g.power[a][2] = 3.0 * ((b[a][2] - b[a][1]) - (b[a][1] - b[a][0]));
        g.power[a][3] = (b[a][3] - b[a][0]) - 3.0 * (b[a][2] - b[a][1]);
    }
    return g;
}

segment_gradient segment_gradient_through(const double values[3][4]) {
    double b[3][4];
    for (int a = 0; a < 3; a++) {
        const double f0 = values[a][0], f1 = values[a][1], f2 = values[a][2], f3 = values[a][3];
        b[a][0] = f0;
        b[a][1] = (-5.0 * f0 + 18.0 * f1 - 9.0 * f2 + 2.0 * f3) / 6.0;
        b[a][2] = (2.0 * f0 - 9.0 * f1 + 18.0 * f2 - 5.0 * f3) / 6.0;
        b[a][3] = f3;
    }
    return segment_gradient_of((const double(*)[4])b);
}

/* Use the blossom: take the part left of b first, then the part of the result right of a. */
void segment_part(const segment *s, double a, double b, double out[4]) {
    const int n = (int)s->degree;
    double p[4], at = b > 0.0 ? a / b : 0.0;
    memcpy(p, s->b, sizeof p);
    for (int i = 0; i <= n; i++) {
        out[i] = p[0];
        for (int k = 0; k < n - i; k++)
            p[k] = (1.0 - b) * p[k] + b * p[k + 1];
    }
    memcpy(p, out, sizeof p);
    for (int i = 0; i <= n; i++) {
        out[n - i] = p[n - i];
        for (int k = 0; k < n - i; k++)
            p[k] = (1.0 - at) * p[k] + at * p[k + 1];
    }
}

bool segment_cut(segment *s, const ray *r) {
    const double t0 = fmax(s->t0, r->t0), t1 = fmin(s->t1, r->t1), length = s->t1 - s->t0;
    if (!(t0 < t1))
        return false;
    if (t0 > s->t0 || t1 < s->t1) {
        double b[4];
        segment_part(s, (t0 - s->t0) / length, (t1 - s->t0) / length, b);
        memcpy(s->b, b, sizeof b);
    }
    s->t0 = t0;
    s->t1 = t1;
    return true;
}

double segment_spread(const double range[2], double middle) {
    double spread = fmax(range[1] - middle, middle - range[0]);
    while (middle - spread > range[0] || middle + spread < range[1])
        spread = nextafter(spread, INFINITY);
    return fmax(spread, SEGMENT_EXACT);
}

void segment_values(double middle, double spread, double range[2]) {
    range[0] = range[1] = middle;
    if (spread > SEGMENT_EXACT) {
        range[0] -= spread;
        range[1] += spread;
    }
}

bool segment_doubted(const tracer *tr, uint32_t t, double range[2]) {
    const leaf_file *f = tr->treelets->file;
    const uint32_t at = leaf_layout_samples(tr->layout, tr->set, t);
    range[0] = (double)f->own[at][0];
    range[1] = (double)f->own[at][1];
    return f->flags[at] & LEAF_FLAG_NON_FINITE;
}

segment segment_doubt(const tracer *tr, uint32_t t, double spread, double t0, double t1) {
    double range[2];
    (void)segment_doubted(tr, t, range);
    return (segment){.t0 = t0 + 0.0,
                     .t1 = t1 + 0.0,
                     .b = {range[0], range[0], range[0], range[0]},
                     .spread = spread,
                     .cell = UINT64_C(1) << 63 | t,
                     .treelet = t,
                     .degree = tr->kind->degree};
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
