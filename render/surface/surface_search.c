#include "render/surface/surface_search.h"

#include <math.h>

/* Where the search begins in volume v. Of two surfaces at the same t, the one of the lower volume
 * comes first. */
static hit begins_at(const surface_search *s, uint16_t v) {
    const hit *last = &s->behind;
    if (v == s->behind_volume || last->t == -INFINITY)
        return *last;
    return v < s->behind_volume ? hit_behind(last->t) : hit_from(last->t);
}

/* Whether nothing behind the surface that the ray starts on is known to be passed. */
static bool leaves(const surface_search *s, const world_ray *w, uint16_t v) {
    return w->from && v == w->from_volume && !(s->behind.t > w->behind);
}

static void begin(surface_search *s, const world_ray *w, uint16_t volume) {
    const bool start = leaves(s, w, volume);
    const hit after = start ? hit_behind(w->behind) : begins_at(s, volume);
    trace_begin_at(&s->state, &after);
    if (start) {
        s->state.origin = w->from->cell;
        s->state.origin_iso = w->from->iso;
    }
    s->state.any = s->any;
    /* At the same t as what was found, a surface of a lower volume comes first. */
    if (hit_exists(&s->found))
        s->state.best =
            hit_from(volume < s->found_volume ? nextafter(s->found.t, INFINITY) : s->found.t);
    s->searching = true;
}

/* Whether *volume is to be searched: go on to the next one that is, if need be. */
static bool reach(const frame *f, const world_ray *w, uint16_t *volume, surface_search *s) {
    if (s->searching)
        return true;
    if (s->any && hit_exists(&s->found))
        return false;
    if (!f->objects) {
        while (*volume < f->volumes && f->tracer[*volume].isos.count == 0)
            ++*volume;
        return *volume < f->volumes;
    }
    const object_ray r = {w->origin, w->direction, fmax(w->t0, s->behind.t),
                          fmin(w->t1, s->found.t)};
    object_entry at = {-INFINITY, 0};
    if (*volume > 0) /* behind the one before it */
        at = object_tree_entry(f->objects, &r, *volume - 1u);
    bool any = object_tree_after(f->objects, &r, &at);
    while (any && f->tracer[at.object].isos.count == 0)
        any = object_tree_after(f->objects, &r, &at);
    *volume = (uint16_t)at.object;
    return any;
}

bool surface_search_ask(const frame *f, const world_ray *w, const tracer *const coarse[],
                        uint16_t *volume, surface_search *s, ray_question *q) {
    for (; reach(f, w, volume, s); ++*volume) {
        if (!s->searching)
            begin(s, w, *volume);
        q->tracer = s->stand_in ? coarse[*volume] : &f->tracer[*volume];
        q->state = &s->state;
        /* Skip the volume where clip planes leave nothing of the ray. */
        if (tracer_ray(q->tracer, w->origin, w->direction, w->t0, w->t1, &q->ray))
            return true;
        s->searching = s->stand_in = false;
    }
    *volume = 0;
    return false;
}

void surface_search_answer(const tracer *const coarse[], uint16_t *volume, surface_search *s,
                           trace_result result) {
    s->provisional |= s->state.provisional;
    if (coarse && coarse[*volume] && !s->stand_in && s->state.provisional) {
        s->stand_in = true;
        s->searching = false;
        return;
    }
    s->searching = s->stand_in = false;
    if (result == TRACE_HIT && !hit_is_bound(&s->state.best)) {
        s->found = s->state.best;
        s->point = s->state.point;
        s->found_volume = *volume;
    }
    ++*volume;
}
