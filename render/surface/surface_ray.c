#include "render/surface/surface_ray.h"

#include <math.h>
#include <string.h>

#include "render/ray/kind.h"
#include "render/surface/shade.h"
#include "render/surface/surface_light.h"

void surface_ray_begin(uint32_t pixel, surface_ray *p) {
    p->head = (ray_record){.pixel = pixel};
    p->layers = 0;
    p->provisional = p->shadow = false;
    surface_search_begin(&p->search, false);
}

/* The current surface, for lights. */
static lit_surface current(const surface_ray *p) {
    return (lit_surface){p->head.pixel, p->search.found_volume, &p->search.found, &p->search.point};
}

world_ray surface_ray_primary(const frame *f, uint32_t pixel) {
    world_ray w = {.t1 = INFINITY};
    camera_ray(&f->camera, pixel % f->width + 0.5, pixel / f->width + 0.5, w.origin, w.direction);
    return w;
}

bool surface_ray_find(const frame *f, surface_ray *p, ray_question *q) {
    const world_ray w = surface_ray_primary(f, p->head.pixel);
    return surface_search_ask(f, &w, f->stand_ins, &p->head.volume, &p->search, q);
}

/* ---- Lights ---- */

/* Ask the next volume for what hides the light. Returns false once the visibility is known. */
static bool ask_for_shadow(const frame *f, surface_ray *p, const double at[3], const double to[3],
                           double distance, ray_question *q) {
    for (; p->head.volume < f->volumes && p->visibility > 0.0f; p->head.volume++) {
        const uint16_t v = p->head.volume;
        q->tracer = &f->tracer[v];
        q->state = &p->search.state;
        if (!tracer_ray(q->tracer, at, to, 0.0, distance, &q->ray))
            continue;
        if (!p->search.searching) {
            const lit_surface s = current(p);
            p->search.state = lit_search(f, &s, v, to);
            p->search.searching = true;
        }
        return true;
    }
    p->head.volume = 0;
    p->shadow = false;
    return false;
}

static void answer_shadow(const frame *f, surface_ray *p, trace_result result) {
    trace_state *state = &p->search.state;
    p->provisional |= state->provisional;
    if (result == TRACE_HIT && lit_dim(f, p->head.volume, &state->best, &p->visibility)) {
        const hit behind = state->best;
        trace_begin_at(state, &behind);
        return;
    }
    p->search.searching = false;
    p->head.volume++;
}

/* Returns whether a light needs a shadow ray, and counts it. */
static bool begin_shadow(const frame *f, const lit_surface *s, const double to[3],
                         float *visibility, ray_counters *counters) {
    if (!lit_needs_ray(f, s, to, visibility))
        return false;
    counters->ill_conditioned += lit_ill_conditioned(s, to);
    counters->shadow_rays++;
    return true;
}

bool surface_ray_light(const frame *f, surface_ray *p, ray_question *q, ray_counters *counters) {
    const leafcast_scene *scene = surface_look_of(f)->scene;
    const lit_surface s = current(p);
    for (; p->head.leg <= scene->light_count; p->head.leg++) {
        const leafcast_light *light = &scene->lights[p->head.leg - 1];
        double at[3], to[3];
        const double distance = light_towards(f, s.pixel, s.found->t, light, at, to);
        if (!p->shadow)
            p->shadow = begin_shadow(f, &s, to, &p->visibility, counters);
        if (p->shadow && ask_for_shadow(f, p, at, to, distance, q))
            return true;
        const float to_light[3] = {(float)to[0], (float)to[1], (float)to[2]};
        const shade_point shading = lit_shading(f, &s);
        shade_light(&shading, to_light, light->rgb, p->visibility, p->rgb);
    }
    p->head.leg = SURFACE_PRIMARY;
    return false;
}

static void begin_lighting(const frame *f, surface_ray *p) {
    const lit_surface s = current(p);
    const shade_point shading = lit_shading(f, &s);
    shade_ambient(&shading, p->rgb);
    if (surface_look_of(f)->scene->light_count == 0) {
        static const float white[3] = {1.0f, 1.0f, 1.0f};
        shade_light(&shading, shading.eye, white, 1.0f, p->rgb);
    }
    p->head.leg = SURFACE_PRIMARY + 1;
}

/* ---- Pixels ---- */

static void write_first(const frame *f, const surface_ray *p, ray_counters *counters) {
    const leafcast_image *image = &f->image;
    const size_t at = frame_plane(f, p->head.pixel);
    const hit *h = &p->search.found;
    const bool any = hit_exists(h);
    counters->covered_pixels += any;
    if (image->z)
        image->z[at] = any ? h->t : INFINITY;
    if (image->id)
        image->id[at] = any ? surface_look_of(f)->first_id[p->search.found_volume] + h->iso : -1;
    for (int a = 0; a < 3; a++)
        if (image->normal[a])
            image->normal[a][at] = any ? p->search.point.normal[a] : 0.0f;
}

bool surface_ray_meet(const frame *f, surface_ray *p, ray_counters *counters) {
    p->provisional |= p->search.provisional;
    if (p->layers == 0)
        write_first(f, p, counters);
    if (!hit_exists(&p->search.found))
        return false;
    begin_lighting(f, p);
    return true;
}

float surface_ray_opacity(const frame *f, const surface_ray *p) {
    return surface_look_of(f)->surfaces[p->search.found_volume][p->search.found.iso].opacity;
}

bool surface_ray_pass(const frame *f, surface_ray *p) {
    p->layers++;
    surface_search_behind(&p->search);
    return p->layers != surface_look_of(f)->scene->layers_max;
}

void surface_ray_write(const frame *f, const surface_ray *p, const float rgba[4],
                       ray_counters *counters) {
    const leafcast_image *image = &f->image;
    const size_t at = frame_plane(f, p->head.pixel);
    float *const planes[4] = {image->r, image->g, image->b, image->a};
    for (int c = 0; c < 4; c++)
        if (planes[c])
            planes[c][at] = rgba[c];
    if (image->provisional)
        image->provisional[at] = p->provisional;
    counters->provisional_pixels += p->provisional;
}

/* ---- The machine ---- */

void surface_ray_answer(const frame *f, surface_ray *p, trace_result result) {
    if (p->head.leg == SURFACE_PRIMARY)
        surface_search_answer(f->stand_ins, &p->head.volume, &p->search, result);
    else
        answer_shadow(f, p, result);
}

ray_bundle surface_ray_bundle(const frame *f, uint32_t leg) {
    if (leg == SURFACE_PRIMARY)
        return camera_bundle(&f->camera);
    const leafcast_light *light = &surface_look_of(f)->scene->lights[leg - 1];
    return (ray_bundle){light->point ? RAYS_TOWARDS : RAYS_ALONG,
                        {light->vector[0], light->vector[1], light->vector[2]}};
}
