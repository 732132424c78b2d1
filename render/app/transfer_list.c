#include "render/app/transfer_list.h"

#include <math.h>

status transfer_list_add(transfer_list *t, leafcast_transfer_point point) {
    if (t->count == LEAFCAST_TRANSFER_POINTS_MAX)
        return status_describe(ST_UNSUPPORTED, "a transfer function has at most %d points",
                               LEAFCAST_TRANSFER_POINTS_MAX);
    status st = mem_grow(t->m, &t->points, sizeof *t->points, t->count, 32, &t->room);
    if (st == ST_OK)
        t->points[t->count++] = point;
    return st;
}

void transfer_list_release(transfer_list *t) {
    mem_free(t->m, t->points);
    *t = (transfer_list){.m = t->m};
}

/* Returns how many points are below a value, or (and_at) at most it. */
static size_t points_before(const transfer_list *t, double value, bool and_at) {
    size_t lo = 0, hi = t->count;
    while (lo < hi) {
        const size_t middle = lo + (hi - lo) / 2;
        const double v = t->points[middle].value;
        if (v < value || (and_at && v <= value))
            lo = middle + 1;
        else
            hi = middle;
    }
    return lo;
}

/* Returns the share of the way from a to b at which a value lies. Halved, since b - a may
 * overflow. */
static double share_of(double a, double b, double value) {
    return (0.5 * value - 0.5 * a) / (0.5 * b - 0.5 * a);
}

static leafcast_transfer_point between(const leafcast_transfer_point *a,
                                       const leafcast_transfer_point *b, double value) {
    const double s = share_of(a->value, b->value, value);
    leafcast_transfer_point p = {.value = value,
                                 .extinction = (1.0 - s) * a->extinction + s * b->extinction};
    for (int c = 0; c < 3; c++)
        p.rgb[c] = (1.0 - s) * a->rgb[c] + s * b->rgb[c];
    return p;
}

leafcast_transfer_point transfer_list_at(const transfer_list *t, double value, bool after) {
    const size_t behind = points_before(t, value, after);
    const leafcast_transfer_point *next = &t->points[behind];
    leafcast_transfer_point p;
    if (behind == 0)
        p = *next;
    else if (behind == t->count || (after && next[-1].value >= value))
        p = next[-1];
    else if (!after && next->value <= value)
        p = *next;
    else
        return between(next - 1, next, value);
    p.value = value;
    return p;
}

void transfer_list_stretch(transfer_list *t, const double from[2], const double to[2]) {
    double below = to[0];
    for (size_t i = 0; i < t->count; i++) {
        const double v = t->points[i].value;
        const double s = from[0] < from[1] ? share_of(from[0], from[1], v) : 0.0;
        const double moved = s >= 1.0 ? to[1] : (1.0 - s) * to[0] + s * to[1];
        /* Keep values from falling by rounding. */
        below = fmin(fmax(moved, below), to[1]);
        t->points[i].value = below;
    }
}

static status add_joint(transfer_list *out, const transfer_list *colours,
                        const transfer_list *extinctions, double factor, double value, bool after) {
    leafcast_transfer_point p = transfer_list_at(colours, value, after);
    p.extinction = factor * transfer_list_at(extinctions, value, after).extinction;
    p.extinction = fmin(p.extinction, TRANSFER_LIST_MOST);
    return transfer_list_add(out, p);
}

static bool steps_at(const transfer_list *t, size_t i) {
    return i + 1 < t->count && t->points[i + 1].value <= t->points[i].value;
}

status transfer_list_join(transfer_list *out, const transfer_list *colours,
                          const transfer_list *extinctions, double factor) {
    size_t c = 0, e = 0;
    status st = ST_OK;
    while ((c < colours->count || e < extinctions->count) && st == ST_OK) {
        const double of_colours = c < colours->count ? colours->points[c].value : INFINITY;
        const double of_rest = e < extinctions->count ? extinctions->points[e].value : INFINITY;
        const double value = fmin(of_colours, of_rest);
        const bool step = (of_colours <= value && steps_at(colours, c)) ||
                          (of_rest <= value && steps_at(extinctions, e));
        if (step)
            st = add_joint(out, colours, extinctions, factor, value, false);
        if (st == ST_OK)
            st = add_joint(out, colours, extinctions, factor, value, true);
        c = points_before(colours, value, true);
        e = points_before(extinctions, value, true);
    }
    return st;
}
