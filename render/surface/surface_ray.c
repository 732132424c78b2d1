#include "render/surface/surface_ray.h"

#include <math.h>
#include <string.h>

#include "render/ray/kind.h"
#include "render/surface/light_samples.h"
#include "render/surface/refraction.h"
#include "render/surface/shade.h"
#include "render/surface/surface_light.h"

/* A ray that begins on a surface. */
typedef struct surface_way {
    double to[3], leaves; /* roots up to this t are the surface itself */
    float weight;         /* in the pixel; 0: there is no such ray */
    float share;          /* in what is seen behind the surface */
} surface_way;

enum { MIRRORED, REFRACTED, WAYS };

/* A surface whose rays are under way, one after the other, and those rays. */
typedef struct surface_bounce {
    hit behind, found; /* of the search that has met the surface */
    surface_point point;
    uint32_t behind_object, found_object;
    uint16_t found_volume;
    bool bends;                 /* what lies behind it is seen by these rays alone */
    uint8_t now;                /* the ray that is followed */
    int32_t layers;             /* on the ray that has met it, */
    float through;              /* and what these leave of the rest */
    float own[3], reflectivity; /* its colour, and the share of the mirrored ray in it */
    float seen[4];              /* behind it, by rays that have ended, premultiplied; */
    float rgba[4];              /* composited on the current one so far, likewise */
    double origin[3];
    surface_way way[WAYS];
} surface_bounce;

/* At the end of the records of soft looks; bounces follow it. */
typedef struct surface_more {
    float through; /* what surfaces passed on the current ray leave of what is behind */
    float sum;     /* of the visibilities by the leg's rays that have answered, */
    int32_t taken; /* so many, */
    int32_t bent;  /* the current surface has its colour, and what lies behind it, */
    float seen[4]; /* premultiplied, is this */
    surface_bounce bounce[];
} surface_more;

size_t surface_ray_more(const surface_look *look) {
    _Static_assert(sizeof(surface_more) % 8 == 0 && sizeof(surface_bounce) % 8 == 0,
                   "records are made of doubles");
    return look->soft ? sizeof(surface_more) + (size_t)look->bounces * sizeof(surface_bounce) : 0;
}

/* Only of soft looks. */
static surface_more *more_of(const frame *f, const surface_ray *p) {
    char *end = (char *)p + f->integrator->record_bytes + f->record_more;
    return (surface_more *)(void *)(end - surface_ray_more(surface_look_of(f)));
}

/* The surface on which the current ray begins. */
static surface_bounce *bounce_of(const frame *f, const surface_ray *p) {
    return &more_of(f, p)->bounce[p->depth - 1];
}

void surface_ray_begin(const frame *f, uint32_t pixel, surface_ray *p) {
    p->head = (ray_record){.pixel = pixel};
    p->layers = 0;
    p->provisional = p->shadow = false;
    p->sample = p->depth = 0;
    if (surface_look_of(f)->soft) {
        more_of(f, p)->through = 1.0f;
        more_of(f, p)->bent = false;
    }
    surface_search_begin(&p->search, false);
}

world_ray surface_ray_primary(const frame *f, uint32_t pixel) {
    world_ray w = {.t1 = INFINITY};
    camera_ray(&f->camera, pixel % f->width + 0.5, pixel / f->width + 0.5, w.origin, w.direction);
    return w;
}

/* The ray on which the current surface lies, or the next one is looked for. */
static world_ray current_ray(const frame *f, const surface_ray *p) {
    if (p->depth == 0)
        return surface_ray_primary(f, p->head.pixel);
    const surface_bounce *b = bounce_of(f, p);
    const surface_way *way = &b->way[b->now];
    world_ray w = {
        .t1 = INFINITY, .from = &b->found, .behind = way->leaves, .from_object = b->found_object};
    memcpy(w.origin, b->origin, sizeof w.origin);
    memcpy(w.direction, way->to, sizeof w.direction);
    return w;
}

/* The current surface, for lights. */
static lit_surface current(const frame *f, const surface_ray *p) {
    const world_ray w = current_ray(f, p);
    lit_surface s = {.volume = p->search.found_volume,
                     .object = p->search.found_object,
                     .found = &p->search.found,
                     .point = &p->search.point};
    memcpy(s.direction, w.direction, sizeof s.direction);
    for (int a = 0; a < 3; a++)
        s.at[a] = w.origin[a] + p->search.found.t * w.direction[a];
    return s;
}

static const leafcast_surface *current_look(const frame *f, const surface_ray *p) {
    return &surface_look_of(f)->surfaces[p->search.found_volume][p->search.found.iso];
}

bool surface_ray_find(const frame *f, surface_ray *p, ray_question *q) {
    const world_ray w = surface_ray_primary(f, p->head.pixel);
    return surface_search_ask(f, &w, f->stand_ins, &p->head.volume, &p->search, q);
}

/* ---- Rays to lights ---- */

/* Ask the next object for what hides the light. Returns false once the visibility is known. */
static bool ask_for_shadow(const frame *f, surface_ray *p, const lit_surface *s, const lit_way *way,
                           ray_question *q) {
    uint32_t *object = &p->search.object;
    for (;; ++*object) {
        placement place;
        *object = frame_object(f, s->at, way->to, 0.0, way->distance, *object);
        if (*object >= frame_objects(f) || !(p->visibility > 0.0f))
            break;
        p->head.volume = frame_volume(f, *object, &place);
        q->tracer = &f->tracer[p->head.volume];
        q->state = &p->search.state;
        const placement *where = frame_grouped(f, *object) ? &place : &q->tracer->place;
        if (!tracer_ray_at(q->tracer, where, s->at, way->to, 0.0, way->distance, &q->ray))
            continue;
        if (!p->search.searching) {
            p->search.state = lit_search(f, s, *object, way->to);
            p->search.searching = true;
        }
        return true;
    }
    *object = 0;
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
    p->search.object++;
}

/* ---- Lights, and ambient light ---- */

/* Where light of the current leg comes from. */
typedef struct light_source {
    const leafcast_light *light; /* NULL: ambient light, from all about */
    lit_way middle;              /* of a light */
    int samples;                 /* rays that say how much arrives; 0: all of it */
} light_source;

enum { SAMPLES = 16 }; /* unless the scene says how many */

static light_source source_of(const frame *f, const surface_ray *p, const lit_surface *s,
                              const shade_point *shading) {
    const leafcast_scene *scene = surface_look_of(f)->scene;
    light_source from = {.light = NULL};
    if (p->head.leg > scene->light_count) {
        from.samples = scene->occlusion_samples > 0 ? scene->occlusion_samples : SAMPLES;
        from.middle.distance = scene->occlusion;
        return from;
    }
    from.light = &scene->lights[p->head.leg - 1];
    from.middle.distance = light_from(from.light, s->at, from.middle.to);
    const double *to = from.middle.to;
    const float to_light[3] = {(float)to[0], (float)to[1], (float)to[2]};
    const bool inside = from.light->point && from.middle.distance <= from.light->radius;
    if (!scene->shadows || !shade_reaches(shading, to_light) || inside)
        return from;
    const int soft = scene->light_samples > 0 ? scene->light_samples : SAMPLES;
    from.samples = from.light->radius > 0.0 ? soft : 1;
    return from;
}

/* Returns the way of the current sample's ray. */
static lit_way way_of(const frame *f, const surface_ray *p, const shade_point *shading,
                      const light_source *from) {
    lit_way way = from->middle;
    double uv[2];
    if (from->light && from->light->radius == 0.0)
        return way;
    const uint32_t q = from->light ? p->head.leg - 1u : LEAFCAST_LIGHTS_MAX;
    light_samples_point(f, p->head.pixel, q, p->sample, from->samples, uv);
    if (from->light)
        return light_samples_light(from->light, &from->middle, uv);
    light_samples_about(shading->normal, uv, way.to);
    return way;
}

/* Begin a sample: p->shadow tells whether it needs a ray, which is counted. */
static void begin_sample(surface_ray *p, const lit_surface *s, const light_source *from,
                         const lit_way *way, surface_more *more, ray_counters *counters) {
    p->shadow = lit_faces(s, way->to);
    p->visibility = p->shadow ? 1.0f : 0.0f;
    if (more)
        more->taken += p->shadow || from->light;
    if (!p->shadow)
        return;
    counters->ill_conditioned += lit_ill_conditioned(s, way->to);
    counters->shadow_rays += from->light != NULL;
    counters->occlusion_rays += from->light == NULL;
}

/* Ask for all that hides light of the current leg. Returns false when all have answered. more: NULL
 * for one ray, whose answer is p->visibility. */
static bool ask_samples(const frame *f, surface_ray *p, const lit_surface *s,
                        const shade_point *shading, const light_source *from, surface_more *more,
                        ray_question *q, ray_counters *counters) {
    for (; p->sample < from->samples; p->sample++) {
        const lit_way way = way_of(f, p, shading, from);
        if (!p->shadow)
            begin_sample(p, s, from, &way, more, counters);
        if (p->shadow && ask_for_shadow(f, p, s, &way, q))
            return true;
        if (more)
            more->sum += p->visibility;
    }
    return false;
}

static void begin_leg(const frame *f, surface_ray *p, uint16_t leg) {
    p->head.leg = leg;
    p->sample = 0;
    if (!surface_look_of(f)->soft)
        return;
    surface_more *more = more_of(f, p);
    more->sum = 0.0f;
    more->taken = 0;
}

/* Returns the share of the leg's light that arrives. */
static float arriving(const surface_ray *p, const light_source *from, const surface_more *more) {
    if (!more)
        return from->samples > 0 ? p->visibility : 1.0f;
    return more->taken > 0 ? more->sum / (float)more->taken : 1.0f;
}

static void add_light(surface_ray *p, const shade_point *shading, const light_source *from,
                      float share) {
    const double *to = from->middle.to;
    const float to_light[3] = {(float)to[0], (float)to[1], (float)to[2]};
    float ambient[3];
    if (from->light) {
        shade_light(shading, to_light, from->light->rgb, share, p->rgb);
        return;
    }
    shade_ambient(shading, ambient);
    for (int c = 0; c < 3; c++)
        p->rgb[c] += share * ambient[c];
}

/* The leg of mirrored and refracted rays, behind all lights and ambient light. */
static uint16_t bounce_leg(const leafcast_scene *scene) {
    return (uint16_t)(scene->light_count + 2);
}

/* ---- Colours by another volume's values ---- */

/* The leg of a surface whose colour is looked up, before it is lit. */
static uint16_t colour_leg(const leafcast_scene *scene) {
    return (uint16_t)(scene->light_count + 3);
}

static void begin_lighting(const frame *f, surface_ray *p) {
    const leafcast_scene *scene = surface_look_of(f)->scene;
    const lit_surface s = current(f, p);
    const shade_point shading = lit_shading(f, &s);
    memset(p->rgb, 0, sizeof p->rgb);
    if (!(scene->occlusion > 0.0))
        shade_ambient(&shading, p->rgb);
    if (scene->light_count == 0) {
        static const float white[3] = {1.0f, 1.0f, 1.0f};
        shade_light(&shading, shading.eye, white, 1.0f, p->rgb);
    }
    begin_leg(f, p, SURFACE_PRIMARY + 1);
}

/* Begin with the current surface: with its colour, if that is to be looked up. */
static void begin_surface(const frame *f, surface_ray *p) {
    if (!surface_lookup_of(f, p->search.found_volume)) {
        begin_lighting(f, p);
        return;
    }
    p->search.state.blocked = LEAF_NO_TREELET;
    p->head.leg = colour_leg(surface_look_of(f)->scene);
}

/* Look up the current surface's colour, and begin the lighting. Returns false if *q waits for a
 * treelet first. */
static bool find_colour(const frame *f, surface_ray *p, ray_question *q) {
    const lit_surface s = current(f, p);
    const surface_lookup *by = surface_lookup_of(f, s.volume);
    uint32_t *wanted = &p->search.state.blocked;
    surface_value value;
    if (!surface_value_at(f, by, s.at, wanted, &p->provisional, &value)) {
        p->head.volume = by->object;
        *q = (ray_question){.tracer = &f->tracer[by->object], .missed = *wanted};
        return false;
    }
    p->head.volume = 0;
    surface_colour_by(f, s.volume, s.found, &value, &p->search.point);
    begin_lighting(f, p);
    return true;
}

/* ---- Lighting ---- */

/* Ask for all that hides light from the current surface. Returns false when that is lit. */
static bool ask_lights(const frame *f, surface_ray *p, ray_question *q, ray_counters *counters) {
    const leafcast_scene *scene = surface_look_of(f)->scene;
    const int last = scene->light_count + (scene->occlusion > 0.0);
    if (p->head.leg == colour_leg(scene) && !find_colour(f, p, q))
        return true;
    if (p->head.leg > last)
        return false;
    const lit_surface s = current(f, p);
    const shade_point shading = lit_shading(f, &s);
    while (p->head.leg <= last) {
        const light_source from = source_of(f, p, &s, &shading);
        surface_more *more = surface_look_of(f)->soft ? more_of(f, p) : NULL;
        if (ask_samples(f, p, &s, &shading, &from, more, q, counters))
            return true;
        add_light(p, &shading, &from, arriving(p, &from, more));
        begin_leg(f, p, (uint16_t)(p->head.leg + 1));
    }
    return false;
}

/* ---- Mirrored and refracted rays ---- */

/* Whether a ray of this weight in the pixel is worth following. */
static bool counts(float weight) {
    return weight > 1.0f - surface_opaque_enough;
}

/* Find what becomes of a ray at a surface that bends it. The shading normal says so, or the cell's
 * own where that would lead to the wrong side. Returns false where both do. */
static bool bend(const lit_surface *s, const float normal[3], double index, refraction *out) {
    const double ratio = s->found->entering ? 1.0 / index : index;
    float own[3];
    *out = refraction_of(s->direction, normal, ratio);
    for (int of_cell = 0; of_cell < 2; of_cell++) {
        if (lit_faces(s, out->mirrored) && (out->share == 1.0 || !lit_faces(s, out->refracted)))
            return true;
        if (of_cell || !shade_normal(s->point->gradient, own))
            return false;
        *out = refraction_of(s->direction, own, ratio);
    }
    return false;
}

static void add_way(const lit_surface *s, surface_bounce *b, int of, const double to[3],
                    float weight, float share, ray_counters *counters) {
    surface_way *way = &b->way[of];
    memcpy(way->to, to, sizeof way->to);
    way->leaves = lit_behind(s, to);
    way->weight = weight;
    way->share = share;
    counters->ill_conditioned += lit_ill_conditioned(s, to);
    counters->mirrored_rays += of == MIRRORED;
    counters->refracted_rays += of == REFRACTED;
}

/* Choose the rays that begin on a surface, of which `before` is seen. A ray that does not count
 * leaves its share to the other. */
static void choose_ways(const frame *f, const surface_ray *p, const lit_surface *s, float before,
                        surface_bounce *b, ray_counters *counters) {
    const leafcast_surface *of = current_look(f, p);
    const float weight = before * of->opacity * of->reflectivity;
    const float clear = before * (1.0f - of->opacity);
    const shade_point shading = lit_shading(f, s);
    refraction way;
    float share = 0.0f;
    b->bends = refraction_bends(of) && counts(clear) &&
               p->layers + 1 != surface_look_of(f)->scene->layers_max &&
               bend(s, shading.normal, (double)of->refraction, &way);
    if (!b->bends)
        refraction_mirror(s->direction, shading.normal, way.mirrored);
    else if (!counts(clear * (float)(1.0 - way.share)))
        share = 1.0f;
    else if (counts(weight + clear * (float)way.share))
        share = (float)way.share;
    if (counts(weight + clear * share) && lit_faces(s, way.mirrored)) {
        b->reflectivity = of->reflectivity;
        add_way(s, b, MIRRORED, way.mirrored, weight + clear * share, share, counters);
    }
    if (b->bends && share < 1.0f)
        add_way(s, b, REFRACTED, way.refracted, clear * (1.0f - share), 1.0f - share, counters);
}

/* Follow the ray `now` of the surface, from its start. */
static void begin_way(const frame *f, surface_ray *p, uint8_t now) {
    surface_bounce *b = bounce_of(f, p);
    b->now = now;
    memset(b->rgba, 0, sizeof b->rgba);
    p->layers = now == REFRACTED ? b->layers + 1 : 0;
    more_of(f, p)->through = 1.0f;
    surface_search_begin(&p->search, false);
    p->head.leg = bounce_leg(surface_look_of(f)->scene);
}

/* Begin the rays of the current surface. Returns false if there is none that counts. */
static bool begin_bounce(const frame *f, surface_ray *p, ray_counters *counters) {
    if (p->depth >= surface_look_of(f)->bounces)
        return false;
    const float weight = p->depth > 0 ? bounce_of(f, p)->way[bounce_of(f, p)->now].weight : 1.0f;
    const lit_surface s = current(f, p);
    surface_bounce b = {.behind = p->search.behind,
                        .found = p->search.found,
                        .point = p->search.point,
                        .behind_object = p->search.behind_object,
                        .found_object = p->search.found_object,
                        .found_volume = p->search.found_volume,
                        .layers = p->layers,
                        .through = more_of(f, p)->through,
                        .own = {p->rgb[0], p->rgb[1], p->rgb[2]}};
    memcpy(b.origin, s.at, sizeof b.origin);
    choose_ways(f, p, &s, weight * b.through, &b, counters);
    const bool mirrors = b.way[MIRRORED].weight > 0.0f;
    if (!mirrors && !b.bends)
        return false;
    p->depth++;
    *bounce_of(f, p) = b;
    begin_way(f, p, mirrors ? MIRRORED : REFRACTED);
    return true;
}

/* Take what the current ray has seen. A mirror has the background behind all of that. What is seen
 * through a surface has it at the end, behind all that the surface is seen with. */
static void take_seen(const frame *f, surface_bounce *b) {
    const float share = b->way[b->now].share;
    for (int i = 0; i < 4; i++)
        b->seen[i] += share * b->rgba[i];
    if (b->now == REFRACTED)
        return;
    shade_background(b->rgba, surface_look_of(f)->scene->background);
    for (int c = 0; c < 3; c++)
        b->own[c] = (1.0f - b->reflectivity) * b->own[c] + b->reflectivity * b->rgba[c];
}

/* End the current ray. Returns true if the refracted one is followed then; else the surface on
 * which they begin is the current one, and has its colour. */
static bool end_way(const frame *f, surface_ray *p) {
    surface_more *more = more_of(f, p);
    surface_bounce *b = bounce_of(f, p);
    take_seen(f, b);
    if (b->now == MIRRORED && b->way[REFRACTED].weight > 0.0f) {
        begin_way(f, p, REFRACTED);
        return true;
    }
    surface_search_begin(&p->search, false);
    p->search.behind = b->behind;
    p->search.found = b->found;
    p->search.point = b->point;
    p->search.behind_object = b->behind_object;
    p->search.found_object = b->found_object;
    p->search.found_volume = b->found_volume;
    p->layers = b->layers;
    memcpy(p->rgb, b->own, sizeof p->rgb);
    more->through = b->through;
    more->bent = b->bends;
    memcpy(more->seen, b->seen, sizeof more->seen);
    p->depth--;
    return false;
}

bool surface_ray_composite(const frame *f, surface_ray *p, float rgba[4]) {
    const float opacity = surface_ray_opacity(f, p);
    surface_more *more = surface_look_of(f)->soft ? more_of(f, p) : NULL;
    shade_composite(rgba, p->rgb, opacity);
    if (!more || !more->bent)
        return surface_ray_pass(f, p) && surface_shows_through(rgba[3], opacity);
    shade_behind(rgba, more->seen);
    more->bent = false;
    return false;
}

/* The current surface has its colour: composite it on its ray. Where nothing behind it counts, that
 * ray ends, and the surface on which it begins has its colour, and so on. Returns false once that
 * is a surface on the ray from the eye. */
static bool go_on_behind(const frame *f, surface_ray *p) {
    while (p->depth > 0) {
        if (surface_ray_composite(f, p, bounce_of(f, p)->rgba)) {
            p->head.leg = bounce_leg(surface_look_of(f)->scene);
            return true;
        }
        if (end_way(f, p))
            return true;
    }
    return false;
}

/* Find the next surface on a ray that begins on one, and begin its lighting. Returns true if *q
 * asks for something first; *more becomes false when the surface on the ray from the eye has its
 * colour. */
static bool ask_bounce(const frame *f, surface_ray *p, ray_question *q, bool *more) {
    while (*more && p->head.leg == bounce_leg(surface_look_of(f)->scene)) {
        const world_ray w = current_ray(f, p);
        if (surface_search_ask(f, &w, NULL, &p->head.volume, &p->search, q))
            return true;
        p->provisional |= p->search.provisional;
        if (hit_exists(&p->search.found)) {
            begin_surface(f, p);
            return false;
        }
        *more = end_way(f, p) || go_on_behind(f, p);
    }
    return false;
}

/* Light the surface, then follow the rays that begin on it: light what they meet, and so on. */
bool surface_ray_light(const frame *f, surface_ray *p, ray_question *q, ray_counters *counters) {
    for (bool more = true; more;) {
        if (p->depth > 0 && ask_bounce(f, p, q, &more))
            return true;
        if (more && ask_lights(f, p, q, counters))
            return true;
        more = more && (begin_bounce(f, p, counters) || go_on_behind(f, p));
    }
    p->head.leg = SURFACE_PRIMARY;
    return false;
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
    begin_surface(f, p);
    return true;
}

float surface_ray_opacity(const frame *f, const surface_ray *p) {
    return current_look(f, p)->opacity;
}

bool surface_ray_pass(const frame *f, surface_ray *p) {
    p->layers++;
    if (surface_look_of(f)->soft)
        more_of(f, p)->through *= 1.0f - surface_ray_opacity(f, p);
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
        surface_search_answer(f, f->stand_ins, p->head.volume, &p->search, result);
    else if (p->head.leg == bounce_leg(surface_look_of(f)->scene))
        surface_search_answer(f, NULL, p->head.volume, &p->search, result);
    else
        answer_shadow(f, p, result);
}

ray_bundle surface_ray_bundle(const frame *f, uint32_t leg) {
    const leafcast_scene *scene = surface_look_of(f)->scene;
    /* No order fits rays that go all about; that of the camera is as good as any. */
    if (leg == SURFACE_PRIMARY || leg > (uint32_t)scene->light_count)
        return camera_bundle(&f->camera);
    const leafcast_light *light = &scene->lights[leg - 1];
    return (ray_bundle){light->point ? RAYS_TOWARDS : RAYS_ALONG,
                        {light->vector[0], light->vector[1], light->vector[2]}};
}
