#include "render/surface_light.h"

#include <math.h>

static void eye_ray(const frame *f, uint32_t pixel, double origin[3], double direction[3]) {
    camera_ray(&f->camera, pixel % f->width + 0.5, pixel / f->width + 0.5, origin, direction);
}

double light_towards(const frame *f, uint32_t pixel, double t, const leafcast_light *light,
                     double at[3], double to[3]) {
    double direction[3], origin[3], length = 0.0;
    eye_ray(f, pixel, origin, direction);
    for (int a = 0; a < 3; a++) {
        at[a] = origin[a] + t * direction[a];
        to[a] = light->point ? light->vector[a] - at[a] : light->vector[a];
        length += to[a] * to[a];
    }
    length = sqrt(length);
    for (int a = 0; a < 3; a++)
        to[a] = length > 0.0 ? to[a] / length : 0.0;
    return light->point ? length : INFINITY;
}

static const leafcast_surface *look_of(const frame *f, uint16_t volume, const hit *h) {
    return &surface_look_of(f)->surfaces[volume][h->iso];
}

shade_point lit_shading(const frame *f, const lit_surface *s) {
    double origin[3], direction[3];
    eye_ray(f, s->pixel, origin, direction);
    const float eye[3] = {(float)-direction[0], (float)-direction[1], (float)-direction[2]};
    return shade_point_of(surface_look_of(f)->scene, look_of(f, s->volume, s->found)->rgb,
                          s->point->normal, eye);
}

/* Along how much of a shadow ray roots are the surface itself, for all that the solver knows. */
static double own_error(const lit_surface *s, double slope) {
    return s->point->error / fabs(slope);
}

static double slope_towards(const lit_surface *s, const double to[3]) {
    const double *g = s->point->gradient;
    return g[0] * to[0] + g[1] * to[1] + g[2] * to[2];
}

bool lit_needs_ray(const frame *f, const lit_surface *s, const double to[3], float *visibility) {
    const float to_light[3] = {(float)to[0], (float)to[1], (float)to[2]};
    const shade_point shading = lit_shading(f, s);
    *visibility = shade_reaches(&shading, to_light) ? 1.0f : 0.0f;
    if (*visibility == 0.0f || !surface_look_of(f)->scene->shadows)
        return false;
    /* The shadow ray starts on the side the primary ray came from: a light on the other one is
     * behind the surface itself. */
    const double slope = slope_towards(s, to);
    if (s->found->entering ? slope > 0.0 : slope < 0.0)
        *visibility = 0.0f;
    return *visibility > 0.0f;
}

bool lit_ill_conditioned(const lit_surface *s, const double to[3]) {
    return !(own_error(s, slope_towards(s, to)) <= s->point->span);
}

trace_state lit_search(const frame *f, const lit_surface *s, uint16_t v, const double to[3]) {
    hit start = hit_before_all();
    if (v == s->volume) {
        const double error = own_error(s, slope_towards(s, to)), span = s->point->span;
        start = hit_behind(error <= span ? error : span);
    }
    trace_state state = trace_begin(&start);
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

/* Put the shadow ray of surface i with the others. */
static void add_ray(const frame *f, lit_batch *b, unsigned i, const leafcast_light *light,
                    ray_batch *rays) {
    const lit_surface s = {b->pixel[i], 0, &b->found[i], &b->point[i]};
    double at[3], to[3];
    const double distance = light_towards(f, s.pixel, s.found->t, light, at, to);
    b->undone[i] = false;
    b->needed[i] = lit_needs_ray(f, &s, to, &b->visibility[i]);
    b->ill_conditioned[i] = b->needed[i] && lit_ill_conditioned(&s, to);
    if (!b->needed[i] || !tracer_ray(f->tracer, at, to, 0.0, distance, &rays->rays[rays->count]))
        return;
    rays->states[rays->count] = lit_search(f, &s, 0, to);
    b->of[rays->count++] = (uint8_t)i;
}

/* Whether ray k has to go on behind what it has met. */
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

/* The rays that go on, side by side. */
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
    rays->count = 0;
    for (unsigned i = 0; i < b->count; i++)
        add_ray(f, b, i, light, rays);
    while (rays->count > 0) {
        ray_batch_next(f->tracer, f->kernels, rays, scratch, counters);
        keep_going(f, b, rays);
    }
}
