#include "render/surface/surface_search.h"

#include <math.h>

/* Where the search begins in an object. Of two surfaces at the same t, the one of the lower object
 * comes first. */
static hit begins_at(const surface_search *s) {
    const hit *last = &s->behind;
    if (s->object == s->behind_object || last->t == -INFINITY)
        return *last;
    return s->object < s->behind_object ? hit_behind(last->t) : hit_from(last->t);
}

/* Whether nothing behind the surface that the ray starts on is known to be passed. */
static bool leaves(const surface_search *s, const world_ray *w) {
    return w->from && s->object == w->from_object && !(s->behind.t > w->behind);
}

static void begin(surface_search *s, const world_ray *w) {
    const bool start = leaves(s, w);
    const hit after = start ? hit_behind(w->behind) : begins_at(s);
    trace_begin_at(&s->state, &after);
    if (start) {
        s->state.origin = w->from->cell;
        s->state.origin_iso = w->from->iso;
    }
    s->state.any = s->any;
    /* At the same t as what was found, a surface of a lower object comes first. */
    if (hit_exists(&s->found))
        s->state.best =
            hit_from(s->object < s->found_object ? nextafter(s->found.t, INFINITY) : s->found.t);
    s->searching = true;
}

/* Whether the object has surfaces: those of groups all have. */
static bool has_surfaces(const frame *f, uint32_t object) {
    return frame_grouped(f, object) || f->tracer[object].isos.count > 0;
}

/* Whether s->object is to be searched: go on to the next one that is, if need be. */
static bool reach(const frame *f, const world_ray *w, object_list *list, surface_search *s) {
    if (s->searching || s->stand_in)
        return true;
    if (s->any && hit_exists(&s->found))
        return false;
    if (!f->objects) {
        while (s->object < (uint32_t)f->volumes && !has_surfaces(f, s->object))
            ++s->object;
        return s->object < (uint32_t)f->volumes;
    }
    const object_ray r = {w->origin, w->direction, fmax(w->t0, s->behind.t),
                          fmin(w->t1, s->found.t)};
    uint32_t at = s->object > 0 ? s->object - 1 : object_none;
    do
        at = object_tree_next(f->objects, &r, at, list);
    while (at != object_none && !has_surfaces(f, at));
    s->object = at != object_none ? at : s->object;
    return at != object_none;
}

/* Make the ray of the object's volume, by a tracer of it. Returns false where clip planes leave
 * nothing of it. */
static bool ray_in(const frame *f, const world_ray *w, uint32_t object, const tracer *tr,
                   const placement *place, ray *out) {
    return tracer_ray_at(tr, frame_grouped(f, object) ? place : &tr->place, w->origin, w->direction,
                         w->t0, w->t1, out);
}

/* Take the point of what was found in an object of a group to the scene's world, once. */
static void take_back(const frame *f, const world_ray *w, surface_search *s) {
    placement place;
    ray r;
    const tracer *tr = &f->tracer[frame_volume(f, s->found_object, &place)];
    (void)ray_in(f, w, s->found_object, tr, &place, &r);
    tracer_take_back_from(tr, &place, &r, s->found.t, &s->point);
    s->own = false;
}

bool surface_search_ask(const frame *f, const world_ray *w, const tracer *const coarse[],
                        uint16_t *volume, surface_search *s, ray_question *q) {
    for (; reach(f, w, &q->objects, s); ++s->object) {
        placement place;
        *volume = frame_volume(f, s->object, &place);
        if (s->stand_in && !(coarse && coarse[*volume])) /* closed while the ray waited */
            s->searching = s->stand_in = false;
        if (!s->searching)
            begin(s, w);
        q->tracer = s->stand_in ? coarse[*volume] : &f->tracer[*volume];
        q->state = &s->state;
        if (ray_in(f, w, s->object, q->tracer, &place, &q->ray))
            return true;
        s->searching = s->stand_in = false;
    }
    s->object = 0;
    *volume = 0;
    if (s->own && !s->any)
        take_back(f, w, s);
    return false;
}

void surface_search_answer(const frame *f, const tracer *const coarse[], uint16_t volume,
                           surface_search *s, trace_result result) {
    s->provisional |= s->state.provisional;
    if (coarse && coarse[volume] && !s->stand_in && s->state.provisional) {
        s->stand_in = true;
        s->searching = false;
        return;
    }
    s->searching = s->stand_in = false;
    if (result == TRACE_HIT && !hit_is_bound(&s->state.best)) {
        s->found = s->state.best;
        s->point = s->state.point;
        s->found_object = s->object;
        s->found_volume = volume;
        s->own = frame_grouped(f, s->object);
    }
    ++s->object;
}
