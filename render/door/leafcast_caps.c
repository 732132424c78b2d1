#include "render/door/leafcast_caps.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

#include "render/door/between_steps.h"
#include "render/door/point_samples.h"
#include "render/ray/kind.h"
#include "render/surface/shade.h"
#include "render/surface/surface_light.h"

/* The caps of one volume. */
typedef struct cap_job {
    const turn *t;
    const frame *f;
    const transfer *colours;
    int volume;
    bool exact; /* rgba and error are drawn; else made of floats later */
    atomic_size_t capped;
} cap_job;

/* A pixel's ray, and where it enters the part that clips do not cut off. clip: the clip through
 * which it enters; -1: none. */
typedef struct entry {
    double origin[3], direction[3], t;
    int clip;
} entry;

static entry entry_of(const cap_job *job, size_t pixel) {
    const frame *f = job->f;
    const uint32_t x = (uint32_t)(pixel % f->width), y = (uint32_t)(pixel / f->width);
    entry e;
    camera_ray(&f->camera, x + 0.5, y + 0.5, e.origin, e.direction);
    e.clip = tracer_enters_by(&f->tracer[job->volume], e.origin, e.direction, &e.t);
    return e;
}

static void cap_point(const void *ctx, size_t i, double point[3]) {
    const cap_job *job = ctx;
    const entry e = entry_of(job, i);
    double at[3], own[3];
    for (int a = 0; a < 3; a++)
        at[a] = e.clip >= 0 ? e.origin[a] + e.t * e.direction[a] : (double)NAN;
    memcpy(point, placement_point(&job->f->tracer[job->volume].place, at, own), sizeof at);
}

/* Returns the surface of the greatest isovalue that is at most `value`; -1: there is none. */
static int surface_in(const leafcast_shown *s, double value) {
    int found = -1;
    for (int i = 0; i < s->count; i++)
        if (value >= s->surfaces[i].isovalue &&
            (found < 0 || s->surfaces[i].isovalue > s->surfaces[found].isovalue))
            found = i;
    return found;
}

/* ---- Colours ---- */

/* Shade a cap by all lights on the eye's side, without shadows. */
static void lit(const cap_job *job, uint32_t pixel, const entry *e, const float rgb[3],
                const float normal[3], float out[3]) {
    const leafcast_scene *scene = &job->t->scene;
    static const float white[3] = {1.0F, 1.0F, 1.0F};
    float eye[3];
    for (int a = 0; a < 3; a++)
        eye[a] = (float)-e->direction[a];
    const shade_point p = shade_point_of(scene, rgb, normal, eye);
    shade_ambient(&p, out);
    if (scene->light_count == 0)
        shade_light(&p, eye, white, 1.0F, out);
    for (int i = 0; i < scene->light_count; i++) {
        double at[3], to[3];
        (void)light_towards(job->f, pixel, e->t, &scene->lights[i], at, to);
        const float to_light[3] = {(float)to[0], (float)to[1], (float)to[2]};
        shade_light(&p, to_light, scene->lights[i].rgb, 1.0F, out);
    }
}

/* Composite a cap over a channel's value. */
static double over(double cap, double opacity, double behind) {
    return opacity * cap + (1.0 - opacity) * behind;
}

static void put_colour(const cap_job *job, size_t at, const double rgba[4], double opacity) {
    const leafcast_image *image = &job->f->image;
    float *const planes[4] = {image->r, image->g, image->b, image->a};
    for (size_t c = 0; c < 4; c++) {
        if (planes[c])
            planes[c][at] = (float)over(rgba[c], opacity, (double)planes[c][at]);
        if (image->rgba && job->exact)
            image->rgba[4 * at + c] = over(rgba[c], opacity, image->rgba[4 * at + c]);
    }
    if (image->error && job->exact)
        image->error[at] *= 1.0 - opacity;
}

static void colour_of(const cap_job *job, uint32_t pixel, const entry *e, const leafcast_surface *s,
                      const float normal[3], double value, double rgba[4]) {
    float rgb[3];
    rgba[3] = 1.0;
    if (job->colours) {
        transfer_rgb(job->colours, value, rgba);
        return;
    }
    lit(job, pixel, e, s->rgb, normal, rgb);
    for (int c = 0; c < 3; c++)
        rgba[c] = (double)rgb[c];
}

/* ---- Pixels ---- */

static void put_place(const cap_job *job, size_t at, double t, const float normal[3], int surface) {
    const leafcast_image *image = &job->f->image;
    if (image->z)
        image->z[at] = t;
    if (image->id)
        image->id[at] = job->t->first_id[job->volume] + surface;
    for (int a = 0; a < 3; a++)
        if (image->normal[a])
            image->normal[a][at] = normal[a];
}

static void cap_found(void *ctx, size_t i, const double point[3], const leafcast_sample *found) {
    cap_job *job = ctx;
    const leafcast_shown *shown = &job->t->shown[job->volume];
    const int surface = found->inside ? surface_in(shown, found->value) : -1;
    (void)point;
    if (surface < 0)
        return;
    const entry e = entry_of(job, i);
    const leafcast_surface *s = &shown->surfaces[surface];
    const double *plane = job->f->tracer[job->volume].clip[e.clip];
    const double length = sqrt(plane[0] * plane[0] + plane[1] * plane[1] + plane[2] * plane[2]);
    float normal[3];
    double rgba[4];
    for (int a = 0; a < 3; a++)
        normal[a] = (float)(-plane[a] / length);
    const size_t at = frame_plane(job->f, (uint32_t)i);
    colour_of(job, (uint32_t)i, &e, s, normal, found->value, rgba);
    put_colour(job, at, rgba, (double)s->opacity);
    put_place(job, at, e.t, normal, surface);
    atomic_fetch_add_explicit(&job->capped, 1, memory_order_relaxed);
}

/* Returns false once the frame is cancelled or its caller wants no more. */
static bool watch(void *ctx, double done) {
    const frame *f = ctx;
    (void)done;
    return !(f->cancel && atomic_load(f->cancel)) && (!f->watch || f->watch(f->watch_ctx, 0.0));
}

static status draw_volume(turn *t, const frame *f, const transfer *colours, int v, size_t *capped) {
    const leafcast_scene *scene = &t->scene;
    cap_job job = {
        .t = t, .f = f, .colours = colours, .volume = v, .exact = scene_is_filled(scene)};
    const leafcast_shown *shown = &t->shown[v];
    const point_samples p = {.volume = shown->volume,
                             .set = between_steps_shown(shown),
                             .level = scene_level(scene, shown->volume),
                             .count = frame_pixels(f),
                             .point = cap_point,
                             .found = cap_found,
                             .ctx = &job,
                             .watch = watch,
                             .watch_ctx = (void *)f};
    const status st = point_samples_run(&p, NULL);
    *capped += job.capped;
    return st;
}

status caps_draw(turn *t, const frame *f, const transfer *colours, ray_counters *counters) {
    size_t capped = 0;
    status st = ST_OK;
    /* Draw the first volume last: it is on top. */
    for (int v = t->volumes - 1; v >= 0 && st == ST_OK; v--)
        if (t->shown[v].count > 0 && !t->shown[v].volume->kind->given)
            st = draw_volume(t, f, colours, v, &capped);
    if (counters->covered_pixels < capped)
        counters->covered_pixels = capped;
    return st;
}
