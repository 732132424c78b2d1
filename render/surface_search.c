#include "render/surface_search.h"

/* Where the search begins in volume v: of two surfaces at the same t, that of the lower volume
 * comes first. */
static hit begins_at(const surface_search *s, uint16_t v) {
    const hit *last = &s->behind;
    if (v == s->behind_volume || last->t == -INFINITY)
        return *last;
    return v < s->behind_volume ? hit_behind(last->t) : hit_from(last->t);
}

static void begin(surface_search *s, uint16_t volume) {
    const hit after = begins_at(s, volume);
    trace_begin_at(&s->state, &after);
    s->state.any = s->any;
    if (hit_exists(&s->found))
        s->state.best = hit_from(s->found.t);
    s->searching = true;
}

static trace_result trace(const tracer *tr, const world_ray *w, surface_search *s,
                          ray_counters *counters) {
    ray r;
    /* Clip planes may leave nothing of it. */
    return tracer_ray(tr, w->origin, w->direction, w->t0, w->t1, &r)
               ? tracer_next(tr, &r, &s->state, counters)
               : TRACE_MISS;
}

/* In one volume. */
static trace_result search(const tracer *tr, const tracer *coarse, const world_ray *w, uint16_t v,
                           surface_search *s, ray_counters *counters) {
    if (!s->searching)
        begin(s, v);
    trace_result result = trace(tr, w, s, counters);
    if (coarse && s->state.provisional) {
        begin(s, v);
        result = trace(coarse, w, s, counters);
        s->state.provisional = true;
    }
    return result;
}

bool surface_search_next(const frame *f, const world_ray *w, const tracer *const coarse[],
                         uint16_t *volume, surface_search *s, ray_counters *counters) {
    for (; *volume < f->volumes; ++*volume) {
        const tracer *stand_in = coarse ? coarse[*volume] : NULL;
        const trace_result result = search(&f->tracer[*volume], stand_in, w, *volume, s, counters);
        if (result == TRACE_BLOCKED)
            return false;
        s->searching = false;
        s->provisional |= s->state.provisional;
        if (result == TRACE_MISS || hit_is_bound(&s->state.best))
            continue;
        s->found = s->state.best;
        s->point = s->state.point;
        s->found_volume = *volume;
    }
    *volume = 0;
    return true;
}
