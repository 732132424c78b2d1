#include "render/medium/medium_ray.h"

#include "render/medium/medium_pixel.h"
#include "render/ray/kind.h"

world_ray medium_ray_way(const frame *f, const medium_ray *p) {
    world_ray w = surface_ray_primary(f, p->way.head.pixel);
    w.t0 = p->from;
    w.t1 = p->way.search.found.t;
    return w;
}

void medium_ray_join(const frame *f, const medium_ray *p, medium_stretch *front,
                     const medium_stretch *behind) {
    if (p->doubted)
        medium_doubt_join(front, behind, medium_ray_look(f)->brightest);
    else
        medium_join(front, behind, medium_ray_look(f)->brightest);
}

void medium_ray_end_run(const frame *f, medium_ray *p) {
    medium_pixel_limit(&p->run, medium_ray_look(f)->brightest);
    medium_ray_join(f, p, &p->front, &p->run);
    medium_pixel_limit(&p->front, medium_ray_look(f)->brightest);
    p->run = medium_nothing();
}

shaded_piece medium_ray_lit(const frame *f, int v, const treelet *at, const ray *r,
                            const segment *s) {
    const tracer *tr = &f->tracer[v];
    shaded_piece p = {.t0 = s->t0, .t1 = s->t1};
    if (!at || s->spread >= SEGMENT_EXACT)
        return p;
    p.steepness = medium_ray_look(f)->shade->steepness[v];
    tracer_gradient(tr, at, r, s, &p.gradient);
    return p;
}
