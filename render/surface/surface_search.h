/* surface_search.h - the next surface on a ray through all objects of a frame, resumable.
 *
 * Objects are searched one after the other; the nearest surface found so far bounds the search.
 * With a tree of objects (frame.objects) a ray asks only those whose boxes it meets, in the order
 * in which it enters these, up to the nearest surface. Surfaces are ordered by (t, object), then as
 * their kind orders hits, whatever the order of the search.
 */
#ifndef RENDER_SURFACE_SURFACE_SEARCH_H
#define RENDER_SURFACE_SURFACE_SEARCH_H

#include "render/frame/integrator.h"

/* A ray in world space, for t0 <= t <= t1. */
typedef struct world_ray {
    double origin[3], direction[3], t0, t1;
    const hit
        *from;     /* NULL, or the surface that it starts on, of object from_object: there, roots */
    double behind; /* up to this t are the surface itself */
    uint32_t from_object;
} world_ray;

typedef struct surface_search {
    hit behind;          /* look for the next surface behind this one */
    hit found;           /* the nearest of the objects searched so far */
    surface_point point; /* of found */
    uint32_t object;     /* searched now; 0 at first, and again at the end */
    uint32_t behind_object, found_object;
    uint16_t found_volume; /* that object's */
    bool searching;        /* the search of the current object has begun, */
    bool stand_in;         /* or that of its coarse substitute */
    bool own;              /* the point is yet as the volume's own world has it */
    bool any;              /* any surface will do, and its point does not matter */
    bool provisional;      /* something on the way was coarser than asked, or absent */
    trace_state state;     /* of the search in the current object */
} surface_search;

/* surface_search_begin() - start before all surfaces. any: see surface_search. Leaves members unset
 * that are not needed yet, since many rays meet nothing. surface_search_behind() - start again,
 * behind the surface that was found. */
static inline void surface_search_begin(surface_search *s, bool any) {
    s->behind = hit_before_all();
    s->found = hit_none();
    s->object = s->behind_object = s->found_object = 0;
    s->found_volume = 0;
    s->any = any;
    s->searching = s->stand_in = s->own = s->provisional = false;
}

static inline void surface_search_behind(surface_search *s) {
    s->behind = s->found;
    s->behind_object = s->found_object;
    s->found = hit_none();
}

/* surface_search_ask() - set *q to the next question. Returns false when s->found is certain;
 * hit_none(): there is none. *volume: set to that of the question. coarse: for each volume, a
 * substitute where a preview's treelets are absent, or NULL. */
bool surface_search_ask(const frame *f, const world_ray *ray, const tracer *const coarse[],
                        uint16_t *volume, surface_search *s, ray_question *q);

/* surface_search_answer() - take the answer to that question, which was of this volume; coarse as
 * there. */
void surface_search_answer(const frame *f, const tracer *const coarse[], uint16_t volume,
                           surface_search *s, trace_result result);

#endif
