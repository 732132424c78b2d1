#include "render/surface/surface_light.h"

#include <math.h>
#include <string.h>

static void eye_ray(const frame *f, uint32_t pixel, double origin[3], double direction[3]) {
    camera_ray(&f->camera, pixel % f->width + 0.5, pixel / f->width + 0.5, origin, direction);
}

void lit_at(const frame *f, uint32_t pixel, double t, double at[3]) {
    double direction[3], origin[3];
    eye_ray(f, pixel, origin, direction);
    for (int a = 0; a < 3; a++)
        at[a] = origin[a] + t * direction[a];
}

double light_from(const leafcast_light *light, const double at[3], double to[3]) {
    double length = 0.0;
    for (int a = 0; a < 3; a++) {
        to[a] = light->point ? light->vector[a] - at[a] : light->vector[a];
        length += to[a] * to[a];
    }
    length = sqrt(length);
    for (int a = 0; a < 3; a++)
        to[a] = length > 0.0 ? to[a] / length : 0.0;
    return light->point ? length : INFINITY;
}

double light_towards(const frame *f, uint32_t pixel, double t, const leafcast_light *light,
                     double at[3], double to[3]) {
    lit_at(f, pixel, t, at);
    return light_from(light, at, to);
}

static const leafcast_surface *look_of(const frame *f, uint16_t volume, const hit *h) {
    return &surface_look_of(f)->surfaces[volume][h->iso];
}

shade_point lit_shading(const frame *f, const lit_surface *s) {
    const double *d = s->direction;
    const float eye[3] = {(float)-d[0], (float)-d[1], (float)-d[2]};
    float rgb[3];
    surface_colour(f, s->volume, s->found, s->point, rgb);
    return shade_point_of(surface_look_of(f)->scene, rgb, s->point->normal, eye);
}

/* The start of a shadow ray at its surface. */
typedef struct departure {
    bool faces;
    bool ill_conditioned;
    double behind; /* t up to which roots count as the surface itself, by the error bound */
} departure;

static departure depart(const surface_point *p, bool entering, const double to[3]) {
    const double *g = p->gradient;
    const double slope = g[0] * to[0] + g[1] * to[1] + g[2] * to[2];
    const double error = p->error / fabs(slope);
    const bool known = error <= p->span;
    return (departure){entering ? !(slope > 0.0) : !(slope < 0.0), !known, known ? error : p->span};
}

bool lit_faces(const lit_surface *s, const double to[3]) {
    return depart(s->point, s->found->entering, to).faces;
}

double lit_behind(const lit_surface *s, const double to[3]) {
    return depart(s->point, s->found->entering, to).behind;
}

bool lit_ill_conditioned(const lit_surface *s, const double to[3]) {
    return depart(s->point, s->found->entering, to).ill_conditioned;
}

static void begin_behind(const hit *surface, double t, trace_state *to) {
    const hit behind = hit_behind(t);
    trace_begin_at(to, &behind);
    to->origin = surface->cell;
    to->origin_iso = surface->iso;
}

trace_state lit_search(const frame *f, const lit_surface *s, uint32_t object, const double to[3]) {
    const hit anywhere = hit_before_all();
    trace_state state = trace_begin(&anywhere);
    if (object == s->object)
        begin_behind(s->found, lit_behind(s, to), &state);
    state.any = surface_opaque(f);
    return state;
}

bool lit_dim(const frame *f, uint16_t v, const hit *met, float *visibility) {
    *visibility *= 1.0f - look_of(f, v, met)->opacity;
    if (!(*visibility > 1.0f - surface_opaque_enough))
        *visibility = 0.0f;
    return *visibility > 0.0f;
}

/* ---- Many surfaces ---- */

/* Direction and distance to a light: for a point light from the surface handled last, else the same
 * from all surfaces. */
typedef struct light_way {
    double to[3], in_grid[3], distance;
} light_way;

static light_way way_to(const frame *f, const leafcast_light *light, const double at[3]) {
    light_way w;
    w.distance = light_from(light, at, w.to);
    tracer_direction(f->tracer, w.to, w.in_grid);
    return w;
}

/* Add the shadow ray of surface i to the batch, if it needs one. */
static void add_ray(const frame *f, lit_batch *b, unsigned i, const light_way *w, bool any,
                    ray_batch *rays) {
    const departure d = depart(&b->point[i], b->found[i].entering, w->to);
    ray *r = &rays->rays[rays->count];
    trace_state *state = &rays->states[rays->count];
    if (!d.faces)
        return;
    b->needed[i] = true;
    b->ill_conditioned[i] = d.ill_conditioned;
    b->visibility[i] = 1.0f;
    memcpy(r->d, w->in_grid, sizeof r->d);
    if (!tracer_ray_along(f->tracer, b->at[i], w->to, 0.0, w->distance, r))
        return;
    begin_behind(&b->found[i], d.behind, state);
    state->any = any;
    b->of[rays->count++] = (uint8_t)i;
}

static void add_rays(const frame *f, lit_batch *b, const leafcast_light *light, ray_batch *rays) {
    const bool any = surface_opaque(f);
    light_way w = way_to(f, light, b->at[0]);
    rays->count = 0;
    for (unsigned i = 0; i < b->count; i++) {
        b->undone[i] = b->needed[i] = b->ill_conditioned[i] = false;
        b->visibility[i] = 0.0f;
        if (!b->reaches[i])
            continue;
        if (light->point)
            w = way_to(f, light, b->at[i]);
        add_ray(f, b, i, &w, any, rays);
    }
}

/* Take the result of ray k. Returns whether it must go on behind the surface it has met. */
static bool look_at_result(const frame *f, lit_batch *b, ray_batch *rays, unsigned k) {
    const unsigned i = b->of[k];
    trace_state *state = &rays->states[k];
    if (rays->results[k] == TRACE_BLOCKED || state->provisional) {
        b->undone[i] = true;
        b->absent[i] = state->blocked;
        return false;
    }
    if (rays->results[k] != TRACE_HIT || !lit_dim(f, 0, &state->best, &b->visibility[i]))
        return false;
    const hit behind = state->best;
    *state = trace_begin(&behind);
    return true;
}

/* Keep in the batch only the rays that go on, without gaps. */
static void keep_going(const frame *f, lit_batch *b, ray_batch *rays) {
    unsigned kept = 0;
    for (unsigned k = 0; k < rays->count; k++) {
        if (!look_at_result(f, b, rays, k))
            continue;
        rays->rays[kept] = rays->rays[k];
        rays->states[kept] = rays->states[k];
        b->of[kept++] = b->of[k];
    }
    rays->count = kept;
}

void lit_batch_trace(const frame *f, lit_batch *b, const leafcast_light *light, ray_batch *rays,
                     void *scratch, ray_counters *counters) {
    add_rays(f, b, light, rays);
    while (rays->count > 0) {
        ray_batch_next(f->tracer, rays, scratch, counters);
        keep_going(f, b, rays);
    }
}
