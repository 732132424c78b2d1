#include "render/ray_integrator.h"

#include <math.h>
#include <string.h>

#include "render/surface_search.h"

typedef struct own_ray {
    ray_record head;
    surface_search search;
} own_ray;

static own_ray *own_ray_of(ray_record *r) {
    return (own_ray *)r;
}

static const ray_look *look_of(const frame *f) {
    return f->look;
}

static void own_begin(const frame *f, uint32_t pixel, ray_record *r) {
    own_ray *p = own_ray_of(r);
    *p = (own_ray){.head = {.pixel = pixel}, .search = surface_search_first()};
    p->search.any = !look_of(f)->hits;
}

/* How far t may be off. */
static double error_of(const surface_point *point, const double direction[3]) {
    double slope = 0.0;
    for (int a = 0; a < 3; a++)
        slope += point->gradient[a] * direction[a];
    return slope != 0.0 ? point->error / fabs(slope) : INFINITY;
}

static leafcast_ray_hit hit_of(const frame *f, const leafcast_ray *from, const surface_search *s) {
    const hit *h = &s->found;
    if (!hit_exists(h))
        return (leafcast_ray_hit){.t = INFINITY, .volume = -1, .surface = -1};
    const int v = s->found_volume;
    leafcast_ray_hit out = {.t = h->t,
                            .volume = v,
                            .surface = look_of(f)->first_id[v] + h->iso,
                            .isovalue = f->tracer[v].isos.isovalues[h->iso],
                            .cell = h->cell,
                            .entering = h->entering,
                            .error_bound = error_of(&s->point, from->direction)};
    memcpy(out.normal, s->point.normal, sizeof out.normal);
    return out;
}

static bool own_advance(const frame *f, ray_record *r, ray_counters *counters) {
    const ray_look *look = look_of(f);
    own_ray *p = own_ray_of(r);
    const size_t i = p->head.pixel;
    if (i >= look->count)
        return true;
    const leafcast_ray *own = &look->rays[i];
    world_ray w = {.t0 = own->t0, .t1 = own->t1};
    memcpy(w.origin, own->origin, sizeof w.origin);
    memcpy(w.direction, own->direction, sizeof w.direction);
    if (!surface_search_next(f, &w, NULL, &p->head.volume, &p->search, counters)) {
        p->head.blocked = p->search.state.blocked;
        return false;
    }
    if (look->hits)
        look->hits[i] = hit_of(f, own, &p->search);
    else
        look->occluded[i] = hit_exists(&p->search.found);
    return true;
}

/* They have no order in common; that of the first is as good as any. */
static ray_bundle own_bundle(const frame *f, uint32_t leg) {
    const double *d = look_of(f)->rays[0].direction;
    (void)leg;
    return (ray_bundle){RAYS_ALONG, {d[0], d[1], d[2]}};
}

static tile_fn own_tile(const frame *f) {
    (void)f;
    return NULL;
}

const integrator ray_integrator = {.record_bytes = sizeof(own_ray),
                                   .begin = own_begin,
                                   .advance = own_advance,
                                   .bundle = own_bundle,
                                   .tile = own_tile};
