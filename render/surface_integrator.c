#include "render/surface_integrator.h"

#include <math.h>

#include "render/kind.h"
#include "render/shade.h"

/* What is left of the light behind surfaces that hide this much no longer counts: a twelfth bit. */
static const float opaque_enough = 1.0f - 1.0f / 4096.0f;

/* Legs of a ray's way: from the eye, then towards each light. */
enum { PRIMARY = 0 };

typedef struct surface_ray {
    ray_record head;         /* volume: the one that is being searched */
    int32_t layers;          /* surfaces composited so far */
    bool found;              /* the search has been done: current is the first surface */
    bool searching;          /* in this volume already */
    bool provisional;        /* something on the way was drawn coarser than asked for */
    uint16_t behind_volume;  /* whose surface is `behind` */
    uint16_t current_volume; /* ... `current` */
    float visibility;        /* of the leg's light */
    float rgb[3];            /* shading of the current surface so far */
    float rgba[4];           /* composited so far, premultiplied */
    hit behind;              /* the surface behind which the next one is looked for */
    hit current;             /* the surface being shaded; or the nearest of the volumes searched */
    surface_point point;     /* there */
    trace_state search;      /* for the next surface, or for what shadows the light */
} surface_ray;

static surface_ray *surface_ray_of(ray_record *r) {
    return (surface_ray *)r;
}

static void surface_begin(const frame *f, uint32_t pixel, ray_record *r) {
    (void)f;
    *surface_ray_of(r) =
        (surface_ray){.head = {.pixel = pixel}, .behind = hit_before_all(), .current = hit_none()};
}

/* ---- Rays from states ---- */

static void eye_ray(const frame *f, uint32_t pixel, double origin[3], double direction[3]) {
    camera_ray(&f->camera, pixel % f->width + 0.5, pixel / f->width + 0.5, origin, direction);
}

static bool primary_ray(const frame *f, const tracer *tr, uint32_t pixel, ray *r) {
    double origin[3], direction[3];
    eye_ray(f, pixel, origin, direction);
    return tracer_ray(tr, origin, direction, 0.0, INFINITY, r);
}

static void surface_found(const frame *f, uint32_t pixel, const hit *h, const treelet *at,
                          ray_record *record) {
    ray r;
    surface_begin(f, pixel, record);
    surface_ray *p = surface_ray_of(record);
    p->found = primary_ray(f, f->tracer, pixel, &r);
    p->current = *h;
    p->point = tracer_surface(f->tracer, at, &r, h);
}

static void point_at(const frame *f, uint32_t pixel, double t, double at[3]) {
    double direction[3], origin[3];
    eye_ray(f, pixel, origin, direction);
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

void surface_towards(const frame *f, uint32_t pixel, double t, const leafcast_light *light,
                     double to[3]) {
    double at[3];
    point_at(f, pixel, t, at);
    (void)direction_to(light, at, to);
}

/* The same from the current surface, and where that is. */
static double towards_light(const frame *f, const surface_ray *p, const leafcast_light *light,
                            double at[3], double to[3]) {
    point_at(f, p->head.pixel, p->current.t, at);
    return direction_to(light, at, to);
}

static const leafcast_surface *surface_met(const frame *f, uint16_t volume, const hit *h) {
    return &surface_look_of(f)->volume[volume].surfaces[h->iso];
}

static shade_point shading_of(const frame *f, const surface_ray *p) {
    double origin[3], direction[3];
    eye_ray(f, p->head.pixel, origin, direction);
    const float eye[3] = {(float)-direction[0], (float)-direction[1], (float)-direction[2]};
    const leafcast_surface *s = surface_met(f, p->current_volume, &p->current);
    return shade_point_of(surface_look_of(f)->scene, s->rgb, p->point.normal, eye);
}

/* ---- The next surface ---- */

/* Where the search begins in volume v: of two surfaces at the same t, that of the lower volume
 * comes first. */
static hit search_from(const surface_ray *p, uint16_t v) {
    const hit *last = &p->behind;
    if (v == p->behind_volume || last->t == -INFINITY)
        return *last;
    return v < p->behind_volume ? hit_behind(last->t) : hit_from(last->t);
}

/* What has been found in other volumes bounds the search. */
static void begin_search(surface_ray *p) {
    const hit after = search_from(p, p->head.volume);
    p->search = trace_begin(&after);
    if (hit_exists(&p->current))
        p->search.best = hit_from(p->current.t);
    p->searching = true;
}

static trace_result search(const frame *f, const tracer *tr, surface_ray *p,
                           ray_counters *counters) {
    ray r;
    /* Clip planes may leave nothing of it. */
    return primary_ray(f, tr, p->head.pixel, &r) ? tracer_next(tr, &r, &p->search, counters)
                                                 : TRACE_MISS;
}

/* In one volume. */
static trace_result search_volume(const frame *f, surface_ray *p, ray_counters *counters) {
    const tracer *coarse = surface_look_of(f)->volume[p->head.volume].coarse;
    if (!p->searching)
        begin_search(p);
    trace_result result = search(f, &f->tracer[p->head.volume], p, counters);
    if (coarse && p->search.provisional) {
        /* A preview met a treelet that is not there: what stands in for the volume instead. */
        begin_search(p);
        result = search(f, coarse, p, counters);
        p->search.provisional = true;
    }
    return result;
}

/* In all volumes. False: blocked. */
static bool find_next(const frame *f, surface_ray *p, ray_counters *counters) {
    for (; p->head.volume < f->volumes; p->head.volume++) {
        const trace_result result = search_volume(f, p, counters);
        if (result == TRACE_BLOCKED)
            return false;
        p->searching = false;
        p->provisional |= p->search.provisional;
        if (result == TRACE_MISS || hit_is_bound(&p->search.best))
            continue;
        p->current = p->search.best;
        p->point = p->search.point;
        p->current_volume = p->head.volume;
    }
    p->head.volume = 0;
    return true;
}

/* ---- Lights ---- */

bool surface_opaque(const frame *f) {
    for (int v = 0; v < f->volumes; v++)
        for (int i = 0; i < f->tracer[v].isos.count; i++)
            if (surface_look_of(f)->volume[v].surfaces[i].opacity < 1.0f)
                return false;
    return true;
}

/* Along how much of a shadow ray roots are the surface itself, for all that the solver knows. */
static double own_error(const surface_ray *p, double slope) {
    return p->point.error / fabs(slope);
}

static double slope_towards(const surface_ray *p, const double to[3]) {
    const double *g = p->point.gradient;
    return g[0] * to[0] + g[1] * to[1] + g[2] * to[2];
}

/* Look for what hides the light from the current surface. False: visibility is known without a
 * ray. */
static bool begin_shadow(const frame *f, surface_ray *p, const leafcast_light *light,
                         ray_counters *counters) {
    double at[3], to[3];
    towards_light(f, p, light, at, to);
    const float to_light[3] = {(float)to[0], (float)to[1], (float)to[2]};
    const shade_point shading = shading_of(f, p);
    p->visibility = shade_reaches(&shading, to_light) ? 1.0f : 0.0f;
    if (p->visibility == 0.0f || !surface_look_of(f)->scene->shadows)
        return false;
    /* The shadow ray starts on the side the primary ray came from: a light on the other one is
     * behind the surface itself. */
    const double slope = slope_towards(p, to);
    if (p->current.entering ? slope > 0.0 : slope < 0.0) {
        p->visibility = 0.0f;
        return false;
    }
    counters->ill_conditioned += !(own_error(p, slope) <= p->point.span);
    counters->shadow_rays++;
    return true;
}

static void begin_shadow_search(const frame *f, surface_ray *p, const double to[3]) {
    hit start = hit_before_all();
    if (p->head.volume == p->current_volume) {
        const double error = own_error(p, slope_towards(p, to)), span = p->point.span;
        start = hit_behind(error <= span ? error : span);
    }
    p->search = trace_begin(&start);
    p->search.any = surface_opaque(f);
    p->searching = true;
}

/* What one volume lets through. False: blocked. */
static bool shadow_volume(const frame *f, surface_ray *p, const double at[3], const double to[3],
                          double distance, ray_counters *counters) {
    const uint16_t v = p->head.volume;
    ray r;
    if (!tracer_ray(&f->tracer[v], at, to, 0.0, distance, &r))
        return true;
    if (!p->searching)
        begin_shadow_search(f, p, to);
    for (;;) {
        const trace_result result = tracer_next(&f->tracer[v], &r, &p->search, counters);
        if (result == TRACE_BLOCKED)
            return false;
        p->provisional |= p->search.provisional;
        if (result == TRACE_MISS)
            break;
        p->visibility *= 1.0f - surface_met(f, v, &p->search.best)->opacity;
        if (!(p->visibility > 1.0f - opaque_enough)) {
            p->visibility = 0.0f;
            break;
        }
        const hit behind = p->search.best;
        p->search = trace_begin(&behind);
    }
    p->searching = false;
    return true;
}

/* Returns false when blocked; true when the light's visibility is known. */
static bool trace_shadow(const frame *f, surface_ray *p, const leafcast_light *light,
                         ray_counters *counters) {
    double at[3], to[3];
    const double distance = towards_light(f, p, light, at, to);
    for (; p->head.volume < f->volumes && p->visibility > 0.0f; p->head.volume++)
        if (!shadow_volume(f, p, at, to, distance, counters))
            return false;
    p->head.volume = 0;
    return true;
}

/* All lights from that of the leg on. Returns false when blocked. */
static bool light_surface(const frame *f, surface_ray *p, bool resumed, ray_counters *counters) {
    const leafcast_scene *scene = surface_look_of(f)->scene;
    for (; p->head.leg <= scene->light_count; p->head.leg++, resumed = false) {
        const leafcast_light *light = &scene->lights[p->head.leg - 1];
        if ((resumed || begin_shadow(f, p, light, counters)) &&
            !trace_shadow(f, p, light, counters))
            return false;
        double at[3], to[3];
        towards_light(f, p, light, at, to);
        const float to_light[3] = {(float)to[0], (float)to[1], (float)to[2]};
        const shade_point shading = shading_of(f, p);
        shade_light(&shading, to_light, light->rgb, p->visibility, p->rgb);
    }
    p->head.leg = PRIMARY;
    return true;
}

static void begin_lighting(const frame *f, surface_ray *p) {
    const shade_point shading = shading_of(f, p);
    shade_ambient(&shading, p->rgb);
    if (surface_look_of(f)->scene->light_count == 0) {
        static const float white[3] = {1.0f, 1.0f, 1.0f};
        shade_light(&shading, shading.eye, white, 1.0f, p->rgb);
    }
    p->head.leg = PRIMARY + 1;
}

/* ---- Pixels ---- */

static void write_first(const frame *f, const surface_ray *p, ray_counters *counters) {
    const leafcast_image *image = &f->image;
    const size_t at = frame_plane(f, p->head.pixel);
    const hit *h = &p->current;
    const bool any = hit_exists(h);
    counters->covered_pixels += any;
    if (image->z)
        image->z[at] = any ? h->t : INFINITY;
    if (image->id)
        image->id[at] = any ? surface_look_of(f)->volume[p->current_volume].first_id + h->iso : -1;
    for (int a = 0; a < 3; a++)
        if (image->normal[a])
            image->normal[a][at] = any ? p->point.normal[a] : 0.0f;
}

static void write_colour(const frame *f, surface_ray *p, ray_counters *counters) {
    const leafcast_image *image = &f->image;
    const size_t at = frame_plane(f, p->head.pixel);
    float *const planes[4] = {image->r, image->g, image->b, image->a};
    shade_background(p->rgba, surface_look_of(f)->scene->background);
    for (int c = 0; c < 4; c++)
        if (planes[c])
            planes[c][at] = p->rgba[c];
    if (image->provisional)
        image->provisional[at] = p->provisional;
    counters->provisional_pixels += p->provisional;
}

/* ---- The machine ---- */

/* The current surface is done with. False: nothing behind it counts. */
static bool composite(const frame *f, surface_ray *p) {
    const float opacity = surface_met(f, p->current_volume, &p->current)->opacity;
    shade_composite(p->rgba, p->rgb, opacity);
    p->layers++;
    p->behind = p->current;
    p->behind_volume = p->current_volume;
    p->current = hit_none();
    return p->rgba[3] < opaque_enough && opacity < 1.0f &&
           p->layers != surface_look_of(f)->scene->layers_max;
}

static bool blocked(surface_ray *p) {
    p->head.blocked = p->search.blocked;
    return false;
}

static bool surface_advance(const frame *f, ray_record *record, ray_counters *counters) {
    surface_ray *p = surface_ray_of(record);
    bool resumed = p->head.leg != PRIMARY, more = true;
    for (; more; resumed = false) {
        if (!resumed) {
            if (!p->found && !find_next(f, p, counters))
                return blocked(p);
            p->found = false;
            if (p->layers == 0)
                write_first(f, p, counters);
            if (!hit_exists(&p->current))
                break;
            begin_lighting(f, p);
        }
        if (!light_surface(f, p, resumed, counters))
            return blocked(p);
        more = composite(f, p);
    }
    write_colour(f, p, counters);
    return true;
}

static ray_bundle surface_bundle(const frame *f, uint32_t leg) {
    if (leg == PRIMARY)
        return camera_bundle(&f->camera);
    const leafcast_light *light = &surface_look_of(f)->scene->lights[leg - 1];
    return (ray_bundle){light->point ? RAYS_TOWARDS : RAYS_ALONG,
                        {light->vector[0], light->vector[1], light->vector[2]}};
}

/* A tile's kernel walks one volume. */
static tile_fn surface_tile(const frame *f) {
    const kind *k = f->tracer->kind;
    return f->volumes == 1 && k->tile ? k->tile(f->kernels) : NULL;
}

const integrator surface_integrator = {.record_bytes = sizeof(surface_ray),
                                       .begin = surface_begin,
                                       .advance = surface_advance,
                                       .bundle = surface_bundle,
                                       .tile = surface_tile,
                                       .found = surface_found};
