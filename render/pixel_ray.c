#include "render/pixel_ray.h"

#include <math.h>

#include "render/priority.h"
#include "render/shade.h"

/* What is left of the light behind surfaces that hide this much no longer counts: a twelfth bit. */
static const float opaque_enough = 1.0f - 1.0f / 4096.0f;

enum { NO_LIGHT = PRIORITY_PRIMARY };

pixel_ray pixel_ray_start(uint32_t pixel) {
    const hit before = hit_before_all();
    return (pixel_ray){.pixel = pixel, .light = NO_LIGHT, .search = trace_begin(&before)};
}

/* ---- Rays from states ---- */

static bool primary_ray(const frame *f, uint32_t pixel, double direction[3], ray *r) {
    double origin[3];
    camera_ray(&f->camera, pixel % f->width + 0.5, pixel / f->width + 0.5, origin, direction);
    return tracer_ray(f->tracer, origin, direction, 0.0, INFINITY, r);
}

pixel_ray pixel_ray_found(const frame *f, uint32_t pixel, const hit *h, const treelet *at) {
    double direction[3];
    ray r;
    pixel_ray p = pixel_ray_start(pixel);
    p.found = primary_ray(f, pixel, direction, &r);
    p.search.best = *h;
    p.search.point = tracer_surface(f->tracer, at, &r, h);
    return p;
}

static void point_at(const frame *f, uint32_t pixel, double t, double at[3]) {
    double direction[3], origin[3];
    camera_ray(&f->camera, pixel % f->width + 0.5, pixel / f->width + 0.5, origin, direction);
    for (int a = 0; a < 3; a++)
        at[a] = origin[a] + t * direction[a];
}

/* The unit direction from a point to a light; returns its distance. */
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

void pixel_ray_towards(const frame *f, uint32_t pixel, double t, const leafcast_light *light,
                       double to[3]) {
    double at[3];
    point_at(f, pixel, t, at);
    (void)direction_to(light, at, to);
}

/* The same from the current hit, and where that is. */
static double towards_light(const frame *f, const pixel_ray *p, const leafcast_light *light,
                            double at[3], double to[3]) {
    point_at(f, p->pixel, p->current.t, at);
    return direction_to(light, at, to);
}

static shade_point shading_of(const frame *f, const pixel_ray *p) {
    double origin[3], direction[3];
    camera_ray(&f->camera, p->pixel % f->width + 0.5, p->pixel / f->width + 0.5, origin, direction);
    const float eye[3] = {(float)-direction[0], (float)-direction[1], (float)-direction[2]};
    return shade_point_of(f->scene, f->surfaces[p->current.iso].rgb, p->point.normal, eye);
}

/* ---- Steps ---- */

static void write_first_hit(const frame *f, const pixel_ray *p, ray_counters *counters) {
    const leafcast_image *image = &f->image;
    const bool any = hit_exists(&p->current);
    counters->covered_pixels += any;
    if (image->z)
        image->z[p->pixel] = any ? p->current.t : INFINITY;
    if (image->id)
        image->id[p->pixel] = any ? p->current.iso : -1;
    for (int a = 0; a < 3; a++)
        if (image->normal[a])
            image->normal[a][p->pixel] = any ? p->point.normal[a] : 0.0f;
}

static void write_colour(const frame *f, pixel_ray *p, ray_counters *counters) {
    const leafcast_image *image = &f->image;
    float *const planes[4] = {image->r, image->g, image->b, image->a};
    shade_background(p->rgba, f->scene->background);
    for (int c = 0; c < 4; c++)
        if (planes[c])
            planes[c][p->pixel] = p->rgba[c];
    if (image->provisional)
        image->provisional[p->pixel] = p->provisional;
    counters->provisional_pixels += p->provisional;
}

/* Then whatever surface is on its way hides a light. */
static bool all_opaque(const frame *f) {
    for (int i = 0; i < f->tracer->isos.count; i++)
        if (f->surfaces[i].opacity < 1.0f)
            return false;
    return true;
}

/* Look for what hides the light from the current hit. False: visibility is known without a ray. */
static bool begin_shadow(const frame *f, pixel_ray *p, const leafcast_light *light,
                         ray_counters *counters) {
    double at[3], to[3];
    towards_light(f, p, light, at, to);
    const float to_light[3] = {(float)to[0], (float)to[1], (float)to[2]};
    const shade_point shading = shading_of(f, p);
    p->visibility = shade_reaches(&shading, to_light) ? 1.0f : 0.0f;
    if (p->visibility == 0.0f || !f->scene->shadows)
        return false;
    /* The shadow ray starts on the side the primary ray came from: a light on the other one is
     * behind the surface itself. */
    const double *g = p->point.gradient;
    const double slope = g[0] * to[0] + g[1] * to[1] + g[2] * to[2];
    if (p->current.entering ? slope > 0.0 : slope < 0.0) {
        p->visibility = 0.0f;
        return false;
    }
    /* Roots within the solver's own error of the start are the surface itself. */
    double bound = p->point.error / fabs(slope);
    if (!(bound <= p->point.span)) {
        counters->ill_conditioned++;
        bound = p->point.span;
    }
    const hit start = hit_behind(bound);
    p->search = trace_begin(&start);
    p->search.any = all_opaque(f);
    counters->shadow_rays++;
    return true;
}

/* Returns false when suspended; true when the light's visibility is known. */
static bool trace_shadow(const frame *f, pixel_ray *p, const leafcast_light *light,
                         ray_counters *counters) {
    double at[3], to[3];
    ray r;
    const double distance = towards_light(f, p, light, at, to);
    if (!tracer_ray(f->tracer, at, to, 0.0, distance, &r))
        return true;
    for (;;) {
        const trace_result result = tracer_next(f->tracer, &r, &p->search, counters);
        if (result == TRACE_BLOCKED)
            return false;
        p->provisional |= p->search.provisional;
        if (result == TRACE_MISS)
            return true;
        p->visibility *= 1.0f - f->surfaces[p->search.best.iso].opacity;
        if (!(p->visibility > 1.0f - opaque_enough)) {
            p->visibility = 0.0f;
            return true;
        }
        const hit behind = p->search.best;
        p->search = trace_begin(&behind);
    }
}

/* All lights from p->light on. Returns false when suspended. */
static bool light_hit(const frame *f, pixel_ray *p, bool resumed, ray_counters *counters) {
    for (; p->light < f->scene->light_count; p->light++, resumed = false) {
        const leafcast_light *light = &f->scene->lights[p->light];
        if ((resumed || begin_shadow(f, p, light, counters)) &&
            !trace_shadow(f, p, light, counters))
            return false;
        double at[3], to[3];
        towards_light(f, p, light, at, to);
        const float to_light[3] = {(float)to[0], (float)to[1], (float)to[2]};
        const shade_point shading = shading_of(f, p);
        shade_light(&shading, to_light, light->rgb, p->visibility, p->rgb);
    }
    p->light = NO_LIGHT;
    return true;
}

static void begin_lighting(const frame *f, pixel_ray *p) {
    const shade_point shading = shading_of(f, p);
    shade_ambient(&shading, p->rgb);
    if (f->scene->light_count == 0) {
        static const float white[3] = {1.0f, 1.0f, 1.0f};
        shade_light(&shading, shading.eye, white, 1.0f, p->rgb);
    }
    p->light = 0;
}

/* A preview met a treelet of a mesh that is not there: what its coarse grid shows instead. */
static trace_result trace_coarse(const frame *f, pixel_ray *p, ray_counters *counters) {
    double origin[3], direction[3];
    ray r;
    const hit after = p->search.after;
    p->search = trace_begin(&after);
    camera_ray(&f->camera, p->pixel % f->width + 0.5, p->pixel / f->width + 0.5, origin, direction);
    const trace_result result = tracer_ray(f->coarse, origin, direction, 0.0, INFINITY, &r)
                                    ? tracer_next(f->coarse, &r, &p->search, counters)
                                    : TRACE_MISS;
    p->search.provisional = true;
    return result;
}

bool pixel_ray_advance(const frame *f, pixel_ray *p, ray_counters *counters) {
    bool resumed = p->light != NO_LIGHT;
    for (;; resumed = false) {
        if (!resumed) {
            double direction[3];
            ray r;
            trace_result result =
                TRACE_MISS; /* also when the clip planes leave nothing of the ray */
            if (p->found)
                result = TRACE_HIT;
            else if (primary_ray(f, p->pixel, direction, &r))
                result = tracer_next(f->tracer, &r, &p->search, counters);
            if (result == TRACE_BLOCKED)
                return false;
            if (f->coarse && p->search.provisional && !p->found)
                result = trace_coarse(f, p, counters);
            p->found = false;
            p->provisional |= p->search.provisional;
            p->current = p->search.best;
            p->point = p->search.point;
            if (p->layers == 0)
                write_first_hit(f, p, counters);
            if (result == TRACE_MISS)
                break;
            begin_lighting(f, p);
        }
        if (!light_hit(f, p, resumed, counters))
            return false;
        const float opacity = f->surfaces[p->current.iso].opacity;
        shade_composite(p->rgba, p->rgb, opacity);
        p->layers++;
        if (p->rgba[3] >= opaque_enough || opacity >= 1.0f || p->layers == f->scene->layers_max)
            break;
        p->search = trace_begin(&p->current);
    }
    write_colour(f, p, counters);
    return true;
}

uint64_t pixel_ray_priority(const frame *f, const pixel_ray *p) {
    return priority_of(f, p->search.blocked, p->light);
}

uint64_t pixel_ray_first_priority(const frame *f, uint32_t t) {
    return priority_of(f, t, NO_LIGHT);
}
