#include "render/surface/ray_integrator.h"

#include <math.h>
#include <string.h>

#include "render/ray/kind.h"
#include "render/surface/surface_search.h"

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
    p->head = (ray_record){.pixel = pixel};
    surface_search_begin(&p->search, !look_of(f)->hits);
}

/* Bound of the error of t. */
static double error_of(const surface_point *point, const double direction[3]) {
    double slope = 0.0;
    for (int a = 0; a < 3; a++)
        slope += point->gradient[a] * direction[a];
    return slope != 0.0 ? point->error / fabs(slope) : INFINITY;
}

static leafcast_ray_hit no_hit(void) {
    return (leafcast_ray_hit){.t = INFINITY, .volume = -1, .surface = -1};
}

/* Describe what a ray has found. */
static leafcast_ray_hit hit_of(const frame *f, const leafcast_ray *from, const surface_search *s) {
    const hit *h = &s->found;
    const surface_point *point = &s->point;
    const int v = s->found_volume;
    leafcast_ray_hit out = {.t = h->t,
                            .object = s->found_object,
                            .volume = v,
                            .surface = look_of(f)->first_id[v] + h->iso,
                            .isovalue = f->tracer[v].isos.isovalues[h->iso],
                            .cell = h->cell,
                            .entering = h->entering,
                            .error_bound = error_of(point, from->direction)};
    memcpy(out.normal, point->normal, sizeof out.normal);
    return out;
}

static leafcast_ray_hit found_by(const frame *f, const leafcast_ray *from,
                                 const surface_search *s) {
    return hit_exists(&s->found) ? hit_of(f, from, s) : no_hit();
}

static bool own_ask(const frame *f, ray_record *r, ray_question *q, ray_counters *counters) {
    const ray_look *look = look_of(f);
    own_ray *p = own_ray_of(r);
    const size_t i = p->head.pixel;
    (void)counters;
    if (i >= look->count)
        return false;
    const leafcast_ray *own = &look->rays[i];
    world_ray w = {.t0 = own->t0, .t1 = own->t1};
    memcpy(w.origin, own->origin, sizeof w.origin);
    memcpy(w.direction, own->direction, sizeof w.direction);
    if (surface_search_ask(f, &w, NULL, &p->head.volume, &p->search, q))
        return true;
    if (look->hits)
        look->hits[i] = found_by(f, own, &p->search);
    else
        look->occluded[i] = hit_exists(&p->search.found);
    return false;
}

static void own_answer(const frame *f, ray_record *r, trace_result result) {
    own_ray *p = own_ray_of(r);
    surface_search_answer(f, NULL, p->head.volume, &p->search, result);
}

/* No order of treelets fits all rays. Use the order along the first ray: it is as good as any. */
static ray_bundle own_bundle(const frame *f, uint32_t leg) {
    const double *d = look_of(f)->rays[0].direction;
    (void)leg;
    return (ray_bundle){RAYS_ALONG, {d[0], d[1], d[2]}};
}

const integrator ray_integrator = {.record_bytes = sizeof(own_ray),
                                   .begin = own_begin,
                                   .ask = own_ask,
                                   .answer = own_answer,
                                   .bundle = own_bundle};
