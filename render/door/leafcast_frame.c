#include "render/leafcast.h"

#include <math.h>
#include <string.h>

#include "formats/base/clock.h"
#include "render/door/arguments.h"
#include "render/door/leafcast_caps.h"
#include "render/door/leafcast_turn.h"
#include "render/door/leafcast_volume.h"
#include "render/door/scene_look.h"
#include "render/frame/integrator.h"
#include "render/look/picture_bytes.h"
#include "render/look/samples.h"
#include "render/ray/kind.h"

struct leafcast_frame {
    turn t; /* t.f.image: all planes, of the caller and of `own` */
    scene_look look;
    leafcast_image own; /* planes allocated here */
    byte_table bytes;   /* for rgba8 */
    /* A picture is drawn in parts: first the planes that are not colours, then each sample. */
    int parts, part, first_sample;
    leafcast_image sample; /* one sample's colours, before they are summed */
    frame drawn;           /* the current part, as a frame */
    projection projection; /* of the part, for tiles of rays */
    drawing *drawing;      /* of the part; NULL: not begun */
    ray_counters counters;
    double render_s;
    atomic_bool cancelled;
    _Atomic double share;                  /* of the pixels: what watch() gets */
    bool (*watch)(void *ctx, double done); /* see leafcast_trace() */
    void *watch_ctx;
};

/* Returns the image with only the planes that samples are summed up in. */
static leafcast_image colours_of(const leafcast_image *image) {
    return (leafcast_image){.size = sizeof *image,
                            .width = image->width,
                            .height = image->height,
                            .stride = image->stride,
                            .r = image->r,
                            .g = image->g,
                            .b = image->b,
                            .a = image->a};
}

static bool any_plane(const leafcast_image *image) {
    return budget_image(image, 1) > 0;
}

/* ---- Describing ---- */

/* Free all that describe() allocated. */
static void empty(leafcast_frame *fr) {
    scene_look_release(&fr->look, &fr->t.device->budget);
    turn_end(&fr->t);
}

/* Set up all that needs no treelets. */
static status describe(leafcast_frame *fr, leafcast *v, const leafcast_scene *scene,
                       const leafcast_camera *from, const leafcast_image *image) {
    frame *f = &fr->t.f;
    status st = turn_describe(&fr->t, v, scene, true);
    if (st == ST_OK)
        st = camera_init(&f->camera, from);
    if (st != ST_OK)
        return st;
    st = scene_look_choose(&fr->look, &fr->t);
    f->cancel = &fr->cancelled;
    camera_window(&f->camera, image->x, image->y);
    f->image = *image;
    if (image->width == 0) {
        f->image.width = from->width;
        f->image.height = from->height;
    }
    f->width = f->image.width;
    f->height = f->image.height;
    f->image.stride = f->stride = image->stride ? image->stride : f->width;
    return st;
}

/* Allocate the colour planes that rgba8 and rgba are made of, where the caller has none. */
static status make_planes(leafcast_frame *fr) {
    leafcast_image *i = &fr->t.f.image;
    float **const planes[4] = {&i->r, &i->g, &i->b, &i->a};
    float **const own[4] = {&fr->own.r, &fr->own.g, &fr->own.b, &fr->own.a};
    for (int c = 0; c < 4 && (i->rgba8 || i->rgba); c++) {
        if (*planes[c])
            continue;
        *own[c] = *planes[c] = mem_array(fr->t.f.m, i->stride * i->height, sizeof(float));
        if (!*planes[c])
            return ST_NOMEM;
    }
    return ST_OK;
}

static void free_colours(mem *m, leafcast_image *image) {
    float *const planes[4] = {image->r, image->g, image->b, image->a};
    for (int c = 0; c < 4; c++)
        mem_free(m, planes[c]);
}

/* ---- Parts ---- */

/* Returns whether planes that are not colours are drawn first, for several samples. */
static bool other_planes(const leafcast_frame *fr) {
    leafcast_image planes = fr->t.f.image;
    planes.r = planes.g = planes.b = planes.a = NULL;
    planes.rgba8 = NULL;
    return any_plane(&planes);
}

/* Allocate planes for the colours of all samples but the first. */
static status make_sample_planes(leafcast_frame *fr) {
    const leafcast_image *like = &fr->t.f.image;
    float *const there[4] = {like->r, like->g, like->b, like->a};
    float **const made[4] = {&fr->sample.r, &fr->sample.g, &fr->sample.b, &fr->sample.a};
    fr->sample.stride = fr->sample.width = like->width;
    fr->sample.height = like->height;
    for (int c = 0; c < 4; c++) {
        *made[c] = there[c] ? mem_array(fr->t.f.m, frame_pixels(&fr->t.f), sizeof(float)) : NULL;
        if (there[c] && !*made[c])
            return ST_NOMEM;
    }
    if (!like->provisional || !fr->t.scene.allow_missing)
        return ST_OK;
    fr->sample.provisional = mem_array(fr->t.f.m, like->stride, like->height);
    return fr->sample.provisional ? ST_OK : ST_NOMEM;
}

static status count_parts(leafcast_frame *fr) {
    const leafcast_image colours = colours_of(&fr->t.f.image);
    fr->parts = 1;
    if (fr->t.scene.samples <= 1 || !any_plane(&colours))
        return ST_OK;
    fr->first_sample = other_planes(fr);
    fr->parts = fr->first_sample + fr->t.scene.samples;
    return make_sample_planes(fr);
}

/* Returns the planes that the current part is drawn into. */
static leafcast_image part_image(const leafcast_frame *fr) {
    leafcast_image image = fr->t.f.image;
    if (fr->parts == 1)
        return image;
    if (fr->part > fr->first_sample)
        return fr->sample;
    if (fr->part == fr->first_sample) {
        image = colours_of(&image);
        image.provisional = fr->sample.provisional;
        return image;
    }
    image.r = image.g = image.b = image.a = NULL;
    return image;
}

/* Pass progress on. If the caller's watch() returns false, cancel the frame for all threads. */
static bool watch_part(void *ctx, double done) {
    leafcast_frame *fr = ctx;
    if (done >= 0.0)
        atomic_store_explicit(&fr->share, (fr->part + done) / fr->parts, memory_order_relaxed);
    if (fr->watch(fr->watch_ctx, atomic_load_explicit(&fr->share, memory_order_relaxed)))
        return true;
    atomic_store(&fr->cancelled, true);
    return false;
}

/* Project the volume for tiles of rays, where there are kernels for tiles. */
static status project(leafcast_frame *fr, frame *f) {
    leafcast *v = fr->t.drawn[0];
    const bool tiles = f->integrator->tile && f->tracer->kernels->tile;
    if (!tiles || f->volumes > 1 || f->objects || f->camera.ortho || f->tracer->place.moved)
        return ST_OK;
    const status st = v->kind->tiles->project(v, &f->camera, &fr->projection);
    if (st == ST_OK && fr->projection.usable)
        f->projection = &fr->projection;
    return st;
}

static status begin_part(leafcast_frame *fr) {
    frame *f = &fr->drawn;
    *f = fr->t.f;
    f->image = part_image(fr);
    f->stride = f->image.stride;
    f->watch = fr->watch ? watch_part : NULL;
    f->watch_ctx = fr;
    if (fr->parts > 1 && fr->part >= fr->first_sample) {
        double shift[2];
        samples_shift(fr->t.scene.samples, fr->part - fr->first_sample, shift);
        camera_shift(&f->camera, shift[0], shift[1]);
        f->sample = (uint32_t)(fr->part - fr->first_sample);
        f->samples = (uint32_t)fr->t.scene.samples;
    }
    const status st = project(fr, f);
    return st == ST_OK ? frame_begin(f, &fr->drawing) : st;
}

/* Add the counters of the part just drawn. They add up, but for counts of pixels: each part draws
 * the same pixels, so the largest count of any part is kept. */
static void add_counters(leafcast_frame *fr) {
    ray_counters *all = &fr->counters;
    const uint64_t provisional = all->provisional_pixels, covered = all->covered_pixels;
    all->covered_pixels = all->provisional_pixels = 0;
    frame_end(fr->drawing, all);
    fr->drawing = NULL;
    if (all->provisional_pixels < provisional)
        all->provisional_pixels = provisional;
    if (all->covered_pixels < covered)
        all->covered_pixels = covered;
}

static status cap(leafcast_frame *fr) {
    if (!fr->t.scene.caps || fr->t.scene.preview)
        return ST_OK;
    const transfer *colours = fr->look.cap_colours.spans > 0 ? &fr->look.cap_colours : NULL;
    const status st = caps_draw(&fr->t, &fr->drawn, colours, &fr->counters);
    return st == ST_OK ? turn_prepare(&fr->t) : st;
}

/* Add the marks of a sample to those of the pixels. stride: of its plane. */
static void add_marks(leafcast_frame *fr, size_t stride) {
    const leafcast_image *to = &fr->t.f.image;
    uint64_t marked = 0;
    for (size_t y = 0; y < to->height; y++)
        for (size_t x = 0; x < to->width; x++) {
            uint8_t *mark = &to->provisional[y * to->stride + x];
            *mark |= fr->sample.provisional[y * stride + x];
            marked += *mark;
        }
    fr->counters.provisional_pixels = marked;
}

static status end_part(leafcast_frame *fr) {
    const int sample = fr->part++ - fr->first_sample;
    add_counters(fr);
    if (fr->sample.provisional && sample >= 0)
        add_marks(fr, sample == 0 ? fr->t.f.image.stride : fr->sample.stride);
    projection_release(&fr->projection);
    const status st = cap(fr);
    if (st != ST_OK || fr->parts == 1 || sample <= 0)
        return st;
    const bool last = fr->part == fr->parts;
    return samples_add(fr->t.f.threads, &fr->t.f.image, &fr->sample,
                       last ? 1.0f / (float)fr->t.scene.samples : 1.0f);
}

static status draw_parts(leafcast_frame *fr, double until) {
    status st = fr->parts == 0 ? count_parts(fr) : ST_OK;
    bool done = true;
    while (fr->part < fr->parts && done && st == ST_OK) {
        if (!fr->drawing)
            st = begin_part(fr);
        fr->drawn.scratch = fr->t.f.scratch;
        if (st == ST_OK)
            st = frame_advance(fr->drawing, until, &done);
        if (st == ST_OK && done)
            st = end_part(fr);
    }
    return st;
}

/* Mark all pixels provisional. */
static void mark_all(const leafcast_frame *fr) {
    const leafcast_image *i = &fr->t.f.image;
    for (size_t row = 0; row < fr->t.f.height && i->provisional; row++)
        memset(i->provisional + row * i->stride, 1, fr->t.f.width);
}

/* ---- Bytes ---- */

/* Fill rgba, error and value for pictures of surfaces: colours from floats, error 0, no value. */
static void widen_row(const leafcast_image *i, size_t from) {
    const float *const planes[4] = {i->r, i->g, i->b, i->a};
    for (size_t at = from; at < from + i->width; at++) {
        for (size_t c = 0; c < 4 && i->rgba; c++)
            i->rgba[4 * at + c] = (double)planes[c][at];
        if (i->error)
            i->error[at] = 0.0;
        if (i->value)
            i->value[at] = (double)NAN;
    }
}

static status encode_row(void *ctx, size_t row, int worker) {
    (void)worker;
    const leafcast_frame *fr = ctx;
    const leafcast_image *i = &fr->t.f.image;
    const size_t from = row * i->stride;
    if (i->rgba8)
        picture_bytes_rgba(&fr->bytes, i, from, i->width, i->rgba8 + 4 * from);
    if (!scene_is_filled(&fr->t.scene))
        widen_row(i, from);
    return ST_OK;
}

/* Fill the planes that are made of other planes. */
static status encode(leafcast_frame *fr) {
    const leafcast_image *i = &fr->t.f.image;
    if (i->rgba8)
        picture_bytes_init(&fr->bytes);
    if (!i->rgba8 && !i->rgba && !i->error && !i->value)
        return ST_OK;
    return pool_run(fr->t.f.threads, fr->t.f.height, encode_row, fr);
}

/* ---- Turns ---- */

static void fill_stats(const leafcast_frame *fr, leafcast_stats *stats) {
    const ray_counters *c = &fr->counters;
    *stats = (leafcast_stats){.size = sizeof *stats,
                              .render_s = fr->render_s,
                              .rays = c->primary_rays + c->shadow_rays + c->occlusion_rays +
                                      c->mirrored_rays + c->refracted_rays};
#define COUNTER(name) stats->name = c->name;
    RAY_COUNTERS(COUNTER)
    PACKET_COUNTERS(COUNTER)
#undef COUNTER
    if (turn_is_provisional(&fr->t))
        stats->provisional_pixels = frame_pixels(&fr->t.f);
    if (c->most_doubt > 0.0) {
        stats->provisional_error_most = c->most_doubt;
        stats->provisional_error_mean = (double)c->doubt * 0x1p-32 / (double)c->provisional_pixels;
    }
    turn_stats(&fr->t, stats);
}

static void note_first_image(const leafcast_frame *fr, double now) {
    for (int i = 0; i < fr->t.volumes; i++)
        if (turn_is_first(&fr->t, i) && fr->t.shown[i].volume->first_image_s == 0.0)
            fr->t.shown[i].volume->first_image_s = now - fr->t.shown[i].volume->opened_at;
}

static status advance(leafcast_frame *fr, double seconds, bool *done) {
    const double start = clock_seconds();
    status st = turn_prepare(&fr->t);
    if (st == ST_OK && fr->parts == 0)
        st = make_planes(fr);
    if (st == ST_OK)
        st = draw_parts(fr, start + seconds);
    *done = st == ST_OK && fr->part == fr->parts;
    if (turn_is_provisional(&fr->t))
        mark_all(fr);
    if (st == ST_OK)
        st = encode(fr);
    st = turn_check(&fr->t, *done, st);
    const double end = clock_seconds();
    fr->render_s += end - start;
    if (*done && st == ST_OK)
        note_first_image(fr, end);
    return st;
}

/* Free all that the frame holds. The counters of an unfinished drawing are lost. */
static void release(leafcast_frame *fr) {
    mem *m = &fr->t.device->budget;
    ray_counters lost = {0};
    frame_end(fr->drawing, &lost);
    projection_release(&fr->projection);
    free_colours(m, &fr->sample);
    mem_free(m, fr->sample.provisional);
    free_colours(m, &fr->own);
    empty(fr);
}

/* ---- The public functions ---- */

/* Describe the frame. Draw the cells if there is no room for a coarse grid in their place. */
static status describe_within(leafcast_frame *fr, leafcast *v, const leafcast_scene *scene,
                              const leafcast_camera *from, const leafcast_image *image) {
    const status st = describe(fr, v, scene, from, image);
    if (st != ST_OK || !turn_any_instead(&fr->t) || budget_check(&fr->t) == ST_OK)
        return st;
    leafcast_scene finest = *scene;
    finest.lod = LEAFCAST_LOD_EXACT;
    empty(fr);
    *fr = (leafcast_frame){0};
    return describe(fr, v, &finest, from, image);
}

static status check_call(const char *call, const leafcast *v, const leafcast_scene *scene,
                         const leafcast_camera *from, const leafcast_image *image,
                         const leafcast_stats *stats) {
    status st = arguments_check_volume(call, v);
    if (st == ST_OK)
        st = public_needs(call, "scene camera image", (const void *[]){scene, from, image});
    return st == ST_OK ? arguments_check_picture(scene, from, image, stats) : st;
}

/* Make a frame from checked arguments; the struct itself is outside of the budget. beside: NULL, or
 * the caller's own bytes from now on; then check also that all of it fits. */
static status make_frame(leafcast *v, const leafcast_scene *scene, const leafcast_camera *from,
                         const leafcast_image *image, const uint64_t *beside,
                         leafcast_frame **out) {
    mem outside;
    mem_init(&outside, 0);
    leafcast_frame *fr = mem_zalloc(&outside, sizeof *fr);
    if (!fr)
        return ST_NOMEM;
    device_lock(v->device);
    if (beside)
        v->device->beside = (size_t)*beside;
    status st = describe_within(fr, v, scene, from, image);
    if (st == ST_OK && beside)
        st = budget_check(&fr->t);
    if (st != ST_OK)
        empty(fr);
    device_unlock(v->device);
    if (st == ST_OK)
        *out = fr;
    else
        mem_free(&outside, fr);
    return st;
}

leafcast_status leafcast_check_room(leafcast *v, const leafcast_scene *scene,
                                    const leafcast_camera *from, const leafcast_image *planes,
                                    uint64_t beside) {
    leafcast_frame *fr = NULL;
    status st = check_call(__func__, v, scene, from, planes, NULL);
    if (st == ST_OK)
        st = public_in_range(__func__, "beside", (double)beside, 0, 0x1p60);
    if (st == ST_OK)
        st = make_frame(v, scene, from, planes, &beside, &fr);
    leafcast_frame_end(fr);
    return public_status(st);
}

leafcast_status leafcast_frame_begin(leafcast *v, const leafcast_scene *scene,
                                     const leafcast_camera *from, const leafcast_image *image,
                                     leafcast_frame **out) {
    status st = check_call(__func__, v, scene, from, image, NULL);
    if (st == ST_OK)
        st = public_needs(__func__, "frame", (const void *[]){out});
    return public_status(st == ST_OK ? make_frame(v, scene, from, image, NULL, out) : st);
}

leafcast_status leafcast_frame_advance(leafcast_frame *fr, double seconds, bool *done,
                                       leafcast_stats *stats) {
    status st = public_needs(__func__, "frame done", (const void *[]){fr, done});
    if (st != ST_OK)
        return public_status(st);
    *done = false;
    st = arguments_check_device(__func__, fr->t.device);
    if (st == ST_OK)
        st = public_in_range(__func__, "seconds", seconds, -INFINITY, INFINITY);
    if (st == ST_OK)
        st = arguments_check_stats(stats);
    if (st != ST_OK)
        return public_status(st);
    device_lock(fr->t.device);
    st = advance(fr, seconds, done);
    if (stats)
        fill_stats(fr, stats);
    if (st == ST_OK && *done)
        turn_read_on(&fr->t);
    device_unlock(fr->t.device);
    return public_status(st);
}

void leafcast_frame_cancel(leafcast_frame *fr) {
    if (fr)
        atomic_store(&fr->cancelled, true);
}

void leafcast_frame_end(leafcast_frame *fr) {
    mem outside;
    if (!fr || !device_is_here(fr->t.device))
        return;
    device_lock(fr->t.device);
    release(fr);
    device_unlock(fr->t.device);
    mem_init(&outside, 0);
    mem_free(&outside, fr);
}

leafcast_status leafcast_trace(leafcast *v, const leafcast_scene *scene,
                               const leafcast_camera *from, const leafcast_image *image,
                               leafcast_stats *stats, bool (*watch)(void *, double),
                               void *watch_ctx) {
    leafcast_frame *fr = NULL;
    bool done;
    status st = check_call(__func__, v, scene, from, image, stats);
    if (st == ST_OK)
        st = make_frame(v, scene, from, image, NULL, &fr);
    if (st != ST_OK)
        return public_status(st);
    fr->watch = watch;
    fr->watch_ctx = watch_ctx;
    const leafcast_status told = leafcast_frame_advance(fr, INFINITY, &done, stats);
    leafcast_frame_end(fr);
    return told;
}
