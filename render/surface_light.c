#include "render/surface_light.h"

#include <math.h>

static void eye_ray(const frame *f, uint32_t pixel, double origin[3], double direction[3]) {
    camera_ray(&f->camera, pixel % f->width + 0.5, pixel / f->width + 0.5, origin, direction);
}

void lit_at(const frame *f, uint32_t pixel, double t, double at[3]) {
    double direction[3], origin[3];
    eye_ray(f, pixel, origin, direction);
    for (int a = 0; a < 3; a++)
        at[a] = origin[a] + t * direction[a];
}

/* The unit direction from a point to a light, which is the same from everywhere unless it is a
 * point itself; returns its distance. */
static double direction_to(const leafcast_light *light, const double at[3], double to[3]) {
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
    return direction_to(light, at, to);
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

bool lit_faces(const lit_surface *s, const double to[3]) {
    const double slope = slope_towards(s, to);
    return s->found->entering ? !(slope > 0.0) : !(slope < 0.0);
}

bool lit_needs_ray(const frame *f, const lit_surface *s, const double to[3], float *visibility) {
    const float to_light[3] = {(float)to[0], (float)to[1], (float)to[2]};
    const shade_point shading = lit_shading(f, s);
    *visibility = shade_reaches(&shading, to_light) ? 1.0f : 0.0f;
    if (*visibility == 0.0f || !surface_look_of(f)->scene->shadows)
        return false;
    if (!lit_faces(s, to))
        *visibility = 0.0f;
    return *visibility > 0.0f;
}

bool lit_ill_conditioned(const lit_surface *s, const double to[3]) {
    return !(own_error(s, slope_towards(s, to)) <= s->point->span);
}

trace_state lit_search(const frame *f, const lit_surface *s, uint16_t v, const double to[3]) {
    const hit anywhere = hit_before_all();
    trace_state state = trace_begin(&anywhere);
    if (v == s->volume) {
        const double error = own_error(s, slope_towards(s, to)), span = s->point->span;
        state.after = hit_behind(error <= span ? error : span);
        state.origin = s->found->cell;
        state.origin_iso = s->found->iso;
    }
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

/* Put the shadow ray of surface i with the others, if it needs one: so far, in direction `to`. */
static void add_ray(const frame *f, lit_batch *b, unsigned i, const double to[3], double distance,
                    ray_batch *rays) {
    const lit_surface s = {.found = &b->found[i], .point = &b->point[i]};
    if (!lit_faces(&s, to))
        return;
    b->needed[i] = true;
    b->ill_conditioned[i] = lit_ill_conditioned(&s, to);
    b->visibility[i] = 1.0f;
    if (!tracer_ray(f->tracer, b->at[i], to, 0.0, distance, &rays->rays[rays->count]))
        return;
    rays->states[rays->count] = lit_search(f, &s, 0, to);
    b->of[rays->count++] = (uint8_t)i;
}

static void add_rays(const frame *f, lit_batch *b, const leafcast_light *light, ray_batch *rays) {
    double to[3], distance = 0.0;
    rays->count = 0;
    if (!light->point)
        distance = direction_to(light, b->at[0], to); /* as from any other */
    for (unsigned i = 0; i < b->count; i++) {
        b->undone[i] = b->needed[i] = b->ill_conditioned[i] = false;
        b->visibility[i] = 0.0f;
        if (!b->reaches[i])
            continue;
        if (light->point)
            distance = direction_to(light, b->at[i], to);
        add_ray(f, b, i, to, distance, rays);
    }
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
    add_rays(f, b, light, rays);
    while (rays->count > 0) {
        ray_batch_next(f->tracer, f->kernels, rays, scratch, counters);
        keep_going(f, b, rays);
    }
}
