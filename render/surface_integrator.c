#include "render/surface_integrator.h"

#include <math.h>
#include <string.h>

#include "render/kind.h"
#include "render/shade.h"
#include "render/surface_light.h"
#include "render/surface_search.h"

/* Legs of a ray's way: from the eye, then towards each light. */
enum { PRIMARY = 0 };

typedef struct surface_ray {
    ray_record head;       /* volume: the one that is being searched */
    int32_t layers;        /* surfaces composited so far */
    bool provisional;      /* something on the way was drawn coarser than asked for */
    bool shadow;           /* a ray towards the leg's light is under way */
    float visibility;      /* of that light */
    float rgb[3];          /* shading of the current surface so far */
    float rgba[4];         /* composited so far, premultiplied */
    surface_search search; /* for the current surface, and for what hides it from a light */
} surface_ray;

static surface_ray *surface_ray_of(ray_record *r) {
    return (surface_ray *)r;
}

static void surface_begin(const frame *f, uint32_t pixel, ray_record *r) {
    surface_ray *p = surface_ray_of(r);
    (void)f;
    p->head = (ray_record){.pixel = pixel};
    p->layers = 0;
    p->provisional = p->shadow = false;
    memset(p->rgba, 0, sizeof p->rgba);
    surface_search_begin(&p->search, false);
}

/* The current surface, for lights. */
static lit_surface current(const surface_ray *p) {
    return (lit_surface){p->head.pixel, p->search.found_volume, &p->search.found, &p->search.point};
}

/* What is to be known before the next surface is certain. */
static bool ask_for_surface(const frame *f, surface_ray *p, ray_question *q) {
    world_ray w = {.t1 = INFINITY};
    const uint32_t pixel = p->head.pixel;
    camera_ray(&f->camera, pixel % f->width + 0.5, pixel / f->width + 0.5, w.origin, w.direction);
    return surface_search_ask(f, &w, surface_look_of(f)->coarse, &p->head.volume, &p->search, q);
}

bool surface_opaque(const frame *f) {
    for (int v = 0; v < f->volumes; v++)
        for (int i = 0; i < f->tracer[v].isos.count; i++)
            if (surface_look_of(f)->surfaces[v][i].opacity < 1.0f)
                return false;
    return true;
}

/* ---- Lights ---- */

/* What is to be known before the visibility is. */
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

/* Whether a light needs a shadow ray, which counts then. */
static bool begin_shadow(const frame *f, const lit_surface *s, const double to[3],
                         float *visibility, ray_counters *counters) {
    if (!lit_needs_ray(f, s, to, visibility))
        return false;
    counters->ill_conditioned += lit_ill_conditioned(s, to);
    counters->shadow_rays++;
    return true;
}

/* All lights from that of the leg on; what is to be known before the next. */
static bool ask_for_lights(const frame *f, surface_ray *p, ray_question *q,
                           ray_counters *counters) {
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
    p->head.leg = PRIMARY;
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
    p->head.leg = PRIMARY + 1;
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
    const uint16_t volume = p->search.found_volume;
    const float opacity = surface_look_of(f)->surfaces[volume][p->search.found.iso].opacity;
    shade_composite(p->rgba, p->rgb, opacity);
    p->layers++;
    surface_search_behind(&p->search);
    return surface_shows_through(p->rgba[3], opacity) &&
           p->layers != surface_look_of(f)->scene->layers_max;
}

/* The next surface is certain. False: there is none. */
static bool take_surface(const frame *f, surface_ray *p, ray_counters *counters) {
    p->provisional |= p->search.provisional;
    if (p->layers == 0)
        write_first(f, p, counters);
    if (!hit_exists(&p->search.found))
        return false;
    begin_lighting(f, p);
    return true;
}

static bool surface_ask(const frame *f, ray_record *record, ray_question *q,
                        ray_counters *counters) {
    surface_ray *p = surface_ray_of(record);
    do {
        if (p->head.leg == PRIMARY) {
            if (ask_for_surface(f, p, q))
                return true;
            if (!take_surface(f, p, counters))
                break;
        }
        if (ask_for_lights(f, p, q, counters))
            return true;
    } while (composite(f, p));
    write_colour(f, p, counters);
    return false;
}

static void surface_answer(const frame *f, ray_record *record, trace_result result) {
    surface_ray *p = surface_ray_of(record);
    if (p->head.leg == PRIMARY)
        surface_search_answer(surface_look_of(f)->coarse, &p->head.volume, &p->search, result);
    else
        answer_shadow(f, p, result);
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
    return f->projection && k->tile ? k->tile(f->kernels) : NULL;
}

const integrator surface_integrator = {.record_bytes = sizeof(surface_ray),
                                       .begin = surface_begin,
                                       .ask = surface_ask,
                                       .answer = surface_answer,
                                       .bundle = surface_bundle,
                                       .tile = surface_tile};
