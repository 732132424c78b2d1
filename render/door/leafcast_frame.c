#include "render/leafcast.h"

#include <math.h>
#include <string.h>

#include "formats/base/clock.h"
#include "formats/leaf/leaf_histogram.h"
#include "render/door/arguments.h"
#include "render/door/leafcast_caps.h"
#include "render/door/leafcast_turn.h"
#include "render/door/leafcast_volume.h"
#include "render/experiments/preintegrated_integrator.h"
#include "render/experiments/stepping_integrator.h"
#include "render/look/picture_bytes.h"
#include "render/look/samples.h"
#include "render/medium/medium_integrator.h"
#include "render/projection/projection_integrator.h"
#include "render/ray/kind.h"
#include "render/surface/surface_integrator.h"

struct leafcast_frame {
    turn t;           /* t.f.image: all planes, of the caller and of `own` */
    medium_look look; /* media and surfaces */
    projection_look projected;
    preintegrated_look stepped; /* media in equal steps, too */
    transfer media[LEAFCAST_VOLUMES_MAX];
    medium_shade shade;   /* for scene.shade_media */
    transfer cap_colours; /* without spans: caps have surfaces' colours */
    double ranges[LEAFCAST_VOLUMES_MAX][2];
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

/* Returns an upper bound of a lit surface's colour channels. */
static double brightest_surface(const leafcast_frame *fr) {
    const leafcast_scene *scene = &fr->t.scene;
    double rgb = 0.0, lights = scene->light_count > 0 ? 0.0 : 1.0;
    for (int i = 0; i < scene->light_count; i++)
        lights += (double)fmaxf(scene->lights[i].rgb[0],
                                fmaxf(scene->lights[i].rgb[1], scene->lights[i].rgb[2]));
    for (int v = 0; v < fr->t.volumes; v++)
        for (int i = 0; i < fr->t.shown[v].count; i++)
            for (int c = 0; c < 3; c++)
                rgb = fmax(rgb, (double)fr->t.surfaces[v][i].rgb[c]);
    return rgb * (1.0 + lights) + fabs((double)scene->specular) * lights;
}

/* The value range that lighting and colours go by, also where a coarse grid is drawn. */
static void shown_range(const leafcast_frame *fr, int i, double range[2]) {
    const leafcast_shown *s = &fr->t.shown[i];
    const leaf_file *of = s->volume->file;
    leaf_histogram_range(of, leaf_layout_set(&of->layout, s->field, s->step), range);
}

/* The value range of the data that is drawn: the volume's, or its coarse grid's. */
static void drawn_range(const leafcast_frame *fr, int i, double range[2]) {
    if (turn_is_instead(&fr->t, i))
        leaf_histogram_range(fr->t.drawn[i]->file, 0, range);
    else
        shown_range(fr, i, range);
}

static status fill_volume(leafcast_frame *fr, int i) {
    interest_interval of[SCENE_BESIDE_MAX];
    transfer *medium = &fr->media[i];
    const status st = transfer_init(medium, fr->t.f.m, &fr->t.scene.media[i]);
    if (st != ST_OK || medium->spans == 0)
        return st;
    fr->t.beside[i] = interest_of_intervals(of, transfer_interest(medium, of, SCENE_BESIDE_MAX));
    drawn_range(fr, i, fr->ranges[i]);
    fr->look.brightest = fmax(fr->look.brightest, medium->most_rgb);
    return ST_OK;
}

/* Free all that describe() allocated. */
static void empty(leafcast_frame *fr) {
    for (int i = 0; i < LEAFCAST_VOLUMES_MAX; i++)
        transfer_release(&fr->media[i], &fr->t.device->budget);
    transfer_release(&fr->cap_colours, &fr->t.device->budget);
    preintegrated_table_release(&fr->stepped.table, &fr->t.device->budget);
    turn_end(&fr->t);
}

/* Set media up for an experiment that sums in steps, without an error bound. */
static status fill_for_steps(leafcast_frame *fr) {
    enum { TABLE = 256 };
    const leafcast_scene *scene = &fr->t.scene;
    const leafcast_scene_experiments *e = scene->experiments;
    frame *f = &fr->t.f;
    if (fr->t.volumes > 1 || fr->t.shown[0].count > 0)
        return status_describe(ST_USAGE, "media in steps: one volume without isosurfaces");
    const leafcast_info info = leafcast_describe(fr->t.shown[0].volume);
    stepping_look *steps = &fr->stepped.steps;
    *steps = (stepping_look){.medium = &fr->media[0],
                             .step = e->step * info.cell_size,
                             .opaque = e->opaque > 0.0 ? e->opaque : 0.9999};
    memcpy(steps->background, scene->background, sizeof scene->background);
    f->integrator = &stepping_integrator;
    f->look = &fr->stepped;
    if (e->summing != LEAFCAST_PREINTEGRATED)
        return ST_OK;
    f->integrator = &preintegrated_integrator;
    return preintegrated_table_make(&fr->stepped.table, f->m, f->threads, steps->medium,
                                    fr->ranges[0], steps->step, e->table > 0 ? e->table : TABLE);
}

/* For the only filled volume: which ranges of values are taken whole. */
static homogeneous homogeneous_of(const leafcast_frame *fr, int i) {
    const leafcast *v = fr->t.drawn[i];
    const leafcast_scene_experiments *e = fr->t.scene.experiments;
    leafcast_info info = {0};
    double square = 0.0;
    v->kind->describe(v, &info);
    for (int a = 0; a < 3; a++)
        square += (info.bounds[1][a] - info.bounds[0][a]) * (info.bounds[1][a] - info.bounds[0][a]);
    return medium_homogeneous(&fr->look, i, sqrt(square), v->file->layout.type != SAMPLE_F32,
                              e ? e->homogeneous : 0.0);
}

/* Set up shading of media. Shading needs the gradient in each node, so no node is taken whole. */
static status shade_media(leafcast_frame *fr) {
    const leafcast_scene *scene = &fr->t.scene;
    fr->shade = medium_shade_of(scene);
    for (int i = 0; i < fr->t.volumes; i++) {
        const leafcast *v = fr->t.shown[i].volume;
        leafcast_info info = {.cell_size = 1.0};
        double range[2];
        if (fr->media[i].spans == 0)
            continue;
        const kind *k = fr->t.tracers[i].kind;
        v->kind->describe(v, &info);
        shown_range(fr, i, range);
        fr->shade.steepness[i] = medium_shade_steepness(scene->shade_fade, info.cell_size, range);
        fr->look.overlaid |= k->walks->overlaps;
    }
    fr->look.brightest *= fr->shade.most;
    fr->look.shade = &fr->shade;
    return ST_OK;
}

/* Set up the media that fill volumes. */
static status fill(leafcast_frame *fr) {
    const leafcast_scene *scene = &fr->t.scene;
    status st = ST_OK;
    fr->t.f.integrator = &medium_integrator;
    fr->look.media = fr->media;
    fr->look.range = (const double(*)[2])fr->ranges;
    fr->look.error = scene->error > 0.0 ? scene->error : 1.0 / 510.0;
    fr->look.brightest = fmax(1.0, brightest_surface(fr));
    for (int c = 0; c < 3; c++)
        fr->look.brightest = fmax(fr->look.brightest, fabs((double)scene->background[c]));
    fr->look.filled = 0;
    for (int i = 0; i < fr->t.volumes && st == ST_OK; i++) {
        st = fill_volume(fr, i);
        fr->look.filled += fr->media[i].spans > 0;
    }
    const bool certified = !scene->experiments || scene->experiments->summing == LEAFCAST_CERTIFIED;
    if (st == ST_OK && !certified)
        return fill_for_steps(fr);
    fr->look.overlaid = fr->look.filled > 1;
    if (st == ST_OK && scene->shade_media)
        st = shade_media(fr);
    fr->look.unbounded = turn_any_instead(&fr->t);
    fr->t.f.record_more = medium_record_more(&fr->look, scene->preview);
    for (int i = 0; i < fr->t.volumes && st == ST_OK && fr->look.filled == 1 && !fr->look.shade;
         i++)
        if (fr->media[i].spans > 0)
            fr->t.beside[i].whole = homogeneous_of(fr, i);
    return st;
}

/* Set a volume up for projection: its interest, and its part of the value range. */
static void project_volume(leafcast_frame *fr, int i) {
    leafcast_shown *s = &fr->t.shown[i];
    const leafcast_scene *scene = &fr->t.scene;
    const interest_interval above = {.lo = scene->project_value, .hi = (double)INFINITY};
    double range[2];
    s->count = 0;
    fr->t.beside[i] = scene->project == LEAFCAST_PROJECT_FIRST ? interest_of_intervals(&above, 1)
                                                               : interest_of_all();
    shown_range(fr, i, range);
    fr->projected.range[0] = fmin(fr->projected.range[0], range[0]);
    fr->projected.range[1] = fmax(fr->projected.range[1], range[1]);
}

static status project_scene(leafcast_frame *fr) {
    const leafcast_scene *scene = &fr->t.scene;
    const bool coloured = scene->media_count > 0 && scene->media[0].count > 0;
    status st = coloured ? transfer_init(&fr->media[0], fr->t.f.m, &scene->media[0]) : ST_OK;
    fr->projected = (projection_look){.project = scene->project,
                                      .value = scene->project_value,
                                      .colour = coloured ? &fr->media[0] : NULL,
                                      .range = {(double)INFINITY, -(double)INFINITY}};
    memcpy(fr->projected.background, scene->background, sizeof scene->background);
    fr->t.f.integrator = &projection_integrator;
    fr->t.f.look = &fr->projected;
    for (int i = 0; i < fr->t.volumes && st == ST_OK; i++)
        project_volume(fr, i);
    /* Raise a threshold below all data to their least value: rays reach it where data begin, too.
     * So differences from the data lose no digits. */
    if (scene->project == LEAFCAST_PROJECT_FIRST && isfinite(fr->projected.range[0]))
        fr->projected.value = fr->t.above = fmax(scene->project_value, fr->projected.range[0]);
    return st;
}

/* Set up all that needs no treelets. */
static status describe(leafcast_frame *fr, leafcast *v, const leafcast_scene *scene,
                       const leafcast_camera *from, const leafcast_image *image) {
    frame *f = &fr->t.f;
    status st = turn_describe(&fr->t, v, scene);
    if (st == ST_OK)
        st = camera_init(&f->camera, from);
    if (st != ST_OK)
        return st;
    fr->look.surfaces = (surface_look){
        &fr->t.scene, (const leafcast_surface(*)[LEAFCAST_SURFACES_MAX])fr->t.surfaces,
        fr->t.first_id, fr->t.coarse};
    f->integrator = &surface_integrator;
    f->look = &fr->look;
    if (scene->project != LEAFCAST_PROJECT_NONE)
        st = project_scene(fr);
    else if (fr->t.scene.media_count > 0)
        st = fill(fr);
    if (st == ST_OK && scene->caps && scene->cap_colours)
        st = transfer_init(&fr->cap_colours, f->m, scene->cap_colours);
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
    return ST_OK;
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
    if (fr->part == fr->first_sample)
        return colours_of(&image);
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
    const bool tiles = f->integrator->tile && v->kernels.tile;
    if (!tiles || f->volumes > 1 || f->camera.ortho)
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
    const transfer *colours = fr->cap_colours.spans > 0 ? &fr->cap_colours : NULL;
    const status st = caps_draw(&fr->t, &fr->drawn, colours, &fr->counters);
    return st == ST_OK ? turn_prepare(&fr->t) : st;
}

static status end_part(leafcast_frame *fr) {
    const int sample = fr->part++ - fr->first_sample;
    add_counters(fr);
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

/* Mark all pixels provisional: a coarse grid is drawn in a volume's place. */
static void mark_instead(const leafcast_frame *fr) {
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
    *stats = (leafcast_stats){
        .size = sizeof *stats, .render_s = fr->render_s, .rays = c->primary_rays + c->shadow_rays};
#define COUNTER(name) stats->name = c->name;
    RAY_COUNTERS(COUNTER)
    PACKET_COUNTERS(COUNTER)
#undef COUNTER
    if (turn_any_instead(&fr->t))
        stats->provisional_pixels = frame_pixels(&fr->t.f);
    if (c->most_doubt > 0.0) {
        stats->provisional_error_most = c->most_doubt;
        stats->provisional_error_mean = (double)c->doubt * 0x1p-32 / (double)c->provisional_pixels;
    }
    turn_stats(&fr->t, stats);
}

static void note_first_image(const leafcast_frame *fr, double now) {
    for (int i = 0; i < fr->t.volumes; i++)
        if (fr->t.shown[i].volume->first_image_s == 0.0)
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
    if (turn_any_instead(&fr->t))
        mark_instead(fr);
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
    free_colours(m, &fr->own);
    empty(fr);
}

/* ---- The public functions ---- */

/* Describe the frame. Draw the tets if there is no room for a coarse grid in their place. */
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
