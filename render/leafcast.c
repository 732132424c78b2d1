#include "render/leafcast.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/clock.h"
#include "formats/base/num.h"
#include "formats/public_status.h"
#include "render/arguments.h"
#include "render/coarse_preview.h"
#include "render/experiment.h"
#include "render/kind.h"
#include "render/samples.h"
#include "render/surface_integrator.h"

_Static_assert((int)LEAFCAST_SURFACES_MAX <= (int)ISOVALUES_MAX, "as many isovalues as surfaces");

leafcast_status volume_public_status(status st) {
    return public_status(st);
}

status volume_check_file(const leafcast *v, status st) {
    if (st != ST_OK && st != ST_CORRUPT && st != ST_IO)
        return st;
    const status changed = file_mark_check(v->file->source, &v->file->mark);
    return changed != ST_OK ? changed : st;
}

const char *leafcast_version(void) {
    return LEAFCAST_VERSION;
}

/* ---- Opening ---- */

enum { LOADER_WORKERS = 2 }; /* threads that read */

static status open_loader(leafcast *v) {
    static const source_kind kinds[] = {SOURCE_AUTO, SOURCE_MAPPED, SOURCE_ARENA};
    loader_options o = {
        .source = kinds[v->options.backend], .workers = LOADER_WORKERS, .isa = v->kernels.isa};
    if (v->kind->loading)
        v->kind->loading(v, &o);
    return loader_create(&v->budget, v->file, &o, v->readers, &v->treelets);
}

status volume_open_file(leafcast *v) {
    mem *m = &v->budget;
    v->kind = kind_of(v->file);
    status st = v->kind->open(v);
    if (st == ST_OK)
        st = pool_create(m, v->options.threads > 0 ? v->options.threads : pool_default_threads(),
                         &v->threads);
    if (st == ST_OK)
        st = open_loader(v);
    if (st != ST_OK)
        return st;
    v->touched = mem_array(m, v->file->layout.treelets, sizeof *v->touched);
    v->stop = mem_array(m, v->file->layout.treelets, sizeof *v->stop);
    if (!v->touched || !v->stop)
        return ST_NOMEM;
    affine_init(&v->space, v->file->header.to_world);
    v->base_bytes = mem_used(m);
    return ST_OK;
}

/* Where a volume is: a file, or its bytes. */
typedef struct location {
    const char *path; /* NULL: in memory */
    const void *bytes;
    size_t size;
} location;

static status open_location(leafcast *v, const location *from) {
    if (!kernels_for(v->options.isa, &v->kernels))
        return status_describe(ST_USAGE, "this CPU or this build has no kernels called %s",
                               v->options.isa);
    status st =
        from->path ? leaf_file_open(&v->budget, from->path, &v->file)
                   : leaf_file_open_memory(&v->budget, "memory", from->bytes, from->size, &v->file);
    return st == ST_OK ? volume_open_file(v) : st;
}

static leafcast_status open_volume(const location *from, const leafcast_options *options,
                                   leafcast **volume) {
    mem outside;
    const double start = clock_seconds();
    status st = options ? arguments_check_options(options) : ST_OK;
    if (st != ST_OK)
        return volume_public_status(st);
    mem_init(&outside, 0);
    leafcast *v = mem_zalloc(&outside, sizeof *v);
    if (!v)
        return LEAFCAST_NOMEM;
    if (options)
        v->options = *options;
    mem_init(&v->budget, (size_t)v->options.memory);
    st = open_location(v, from);
    if (st != ST_OK) {
        leafcast_close(v);
        return volume_public_status(st);
    }
    v->opened_at = start;
    v->open_s = clock_seconds() - start;
    *volume = v;
    return LEAFCAST_OK;
}

leafcast_status leafcast_open(const char *path, const leafcast_options *options,
                              leafcast **volume) {
    const location from = {.path = path};
    return open_volume(&from, options, volume);
}

leafcast_status leafcast_open_memory(const void *bytes, size_t size,
                                     const leafcast_options *options, leafcast **volume) {
    const location from = {.bytes = bytes, .size = size};
    return open_volume(&from, options, volume);
}

void leafcast_close(leafcast *v) {
    if (!v)
        return;
    mem outside;
    mem_init(&outside, 0);
    leafcast_close(v->coarse);
    loader_destroy(v->treelets);
    pool_destroy(v->threads);
    if (v->kind)
        v->kind->close(v);
    mem_free(&v->budget, v->scratch);
    mem_free(&v->budget, v->stop);
    mem_free(&v->budget, v->touched);
    leaf_file_close(v->file);
    mem_free(&outside, v);
}

leafcast_status leafcast_get_info(const leafcast *v, leafcast_info *info) {
    const leaf_header *h = &v->file->header;
    const status st = arguments_size("leafcast_info", info->size, sizeof *info);
    if (st != ST_OK)
        return volume_public_status(st);
    *info = (leafcast_info){.size = sizeof *info,
                            .levels = h->levels,
                            .fields = h->fields,
                            .steps = h->steps,
                            .moving = v->file->layout.moved_steps > 0,
                            .treelets = v->file->layout.treelets,
                            .sample_type = sample_name((sample_type)h->sample_type),
                            .name = v->file->name,
                            .value_min = h->value_min,
                            .value_max = h->value_max,
                            .cell_size = 1.0,
                            .file_bytes = h->file_bytes,
                            .payload_bytes = h->payload_bytes};
    v->kind->describe(v, info);
    return LEAFCAST_OK;
}

/* ---- Selecting ---- */

leafcast_surface leafcast_surface_default(double isovalue) {
    return (leafcast_surface){isovalue, {0.9f, 0.85f, 0.75f}, 1.0f};
}

leafcast_status leafcast_select(leafcast *v, const leafcast_surface *surfaces, int count) {
    if (count < 1 || count > LEAFCAST_SURFACES_MAX)
        return volume_public_status(status_describe(ST_USAGE,
                                                    "%d isosurfaces: 1 to %d can be drawn at once",
                                                    count, LEAFCAST_SURFACES_MAX));
    for (int i = 0; i < count; i++) {
        if (!isfinite(surfaces[i].isovalue))
            return volume_public_status(
                status_describe(ST_USAGE, "isovalue %d is not a finite number", i + 1));
        if (!(surfaces[i].opacity > 0.0f && surfaces[i].opacity <= 1.0f))
            return volume_public_status(
                status_describe(ST_USAGE, "opacity %d is not in (0, 1]", i + 1));
    }
    for (int i = 0; i < count; i++) {
        v->surfaces[i] = surfaces[i];
        v->isovalues[i] = surfaces[i].isovalue;
    }
    v->surface_count = count;
    const interest in = interest_of_isovalues(v->isovalues, count);
    loader_select(v->treelets, &in);
    loader_reset_statistics(v->treelets);
    return LEAFCAST_OK;
}

status volume_check_set(const leafcast *v, uint32_t field, uint32_t step) {
    const leaf_header *h = &v->file->header;
    if (field < h->fields && step < h->steps)
        return ST_OK;
    return status_describe(ST_USAGE, "field %u at step %u: there are %u fields and %u steps", field,
                           step, h->fields, h->steps);
}

leafcast_status leafcast_select_set(leafcast *v, uint32_t field, uint32_t step) {
    const status st = volume_check_set(v, field, step);
    if (st != ST_OK)
        return volume_public_status(st);
    v->field = field;
    v->step = step;
    loader_select_set(v->treelets, leaf_layout_set(&v->file->layout, field, step));
    loader_reset_statistics(v->treelets);
    return LEAFCAST_OK;
}

leafcast_status leafcast_range(const leafcast *v, uint32_t field, uint32_t step, double range[2]) {
    const leaf_layout *layout = &v->file->layout;
    const status st = volume_check_set(v, field, step);
    if (st != ST_OK)
        return volume_public_status(st);
    const uint32_t set = leaf_layout_set(layout, field, step);
    const float(*own)[2] = (const float(*)[2])v->file->own + (size_t)set * layout->treelets;
    range[0] = INFINITY;
    range[1] = -INFINITY;
    /* Level 0 alone, whose treelets come last. */
    for (uint32_t t = layout->level[0].first; t < layout->treelets; t++) {
        range[0] = fmin(range[0], (double)own[t][0]);
        range[1] = fmax(range[1], (double)own[t][1]);
    }
    return LEAFCAST_OK;
}

const char *leafcast_field_name(const leafcast *v, uint32_t field) {
    return leaf_file_field_name(v->file, field);
}

double leafcast_step_time(const leafcast *v, uint32_t step) {
    return leaf_file_step_time(v->file, step);
}

leafcast_status leafcast_find_field(const leafcast *v, const char *name, uint32_t *field) {
    const uint32_t fields = v->file->header.fields;
    int64_t number = 0;
    for (*field = 0; *field < fields; ++*field)
        if (strcmp(leafcast_field_name(v, *field), name) == 0)
            return LEAFCAST_OK;
    if (num_int(name, "field", 0, (int64_t)fields - 1, &number) == ST_OK) {
        *field = (uint32_t)number;
        return LEAFCAST_OK;
    }
    char list[512] = "";
    for (uint32_t i = 0; i < fields && strlen(list) + 80 < sizeof list; i++)
        snprintf(list + strlen(list), sizeof list - strlen(list), "%s%s", i ? ", " : "",
                 leafcast_field_name(v, i));
    return volume_public_status(status_describe(
        ST_USAGE, "no field is called \"%s\", nor has that number; there are %u: %s", name, fields,
        list));
}

leafcast_status leafcast_init_scene(leafcast_scene *scene) {
    const status st = arguments_size("leafcast_scene", scene->size, sizeof *scene);
    if (st == ST_OK)
        *scene = (leafcast_scene){
            .size = sizeof *scene, .ambient = 0.15f, .specular = 0.3f, .shininess = 32};
    return volume_public_status(st);
}

leafcast_status leafcast_get_standard_view(const leafcast *v, double distance, uint32_t width,
                                           uint32_t height, leafcast_camera *view) {
    const leafcast_info info = leafcast_describe(v);
    const status st = arguments_size("leafcast_camera", view->size, sizeof *view);
    if (st == ST_OK)
        *view = camera_standard((const double(*)[3])info.bounds, distance, width, height);
    return volume_public_status(st);
}

void leafcast_pixel_ray(const leafcast_camera *camera_of, double x, double y, double origin[3],
                        double direction[3]) {
    camera c;
    for (int a = 0; a < 3; a++) {
        origin[a] = camera_of->eye[a];
        direction[a] = 0.0;
    }
    if (arguments_size("leafcast_camera", camera_of->size, sizeof *camera_of) == ST_OK &&
        camera_init(&c, camera_of) == ST_OK)
        camera_ray(&c, x, y, origin, direction);
}

/* ---- Tracing ---- */

static status add_clip(tracer *tr, const double plane[4]) {
    for (int i = 0; i < 4; i++)
        if (!isfinite(plane[i]))
            return status_describe(ST_USAGE, "a clip plane has a number that is not finite");
    memcpy(tr->clip[tr->clip_count++], plane, sizeof tr->clip[0]);
    return ST_OK;
}

static status clip_of(const leafcast_scene *scene, tracer *tr) {
    status st = ST_OK;
    for (int a = 0; scene->clip_box && a < 3 && st == ST_OK; a++) {
        double below[4] = {0.0, 0.0, 0.0, -scene->clip_min[a]},
               above[4] = {0.0, 0.0, 0.0, scene->clip_max[a]};
        below[a] = 1.0;
        above[a] = -1.0;
        st = add_clip(tr, below);
        if (st == ST_OK)
            st = add_clip(tr, above);
    }
    for (int i = 0; i < scene->clip_plane_count && st == ST_OK; i++)
        st = add_clip(tr, scene->clip_planes[i]);
    return st;
}

status volume_tracer_of_all(leafcast *v, const leafcast_scene *scene, const camera *c, tracer *tr) {
    status st = arguments_check_scene(scene);
    if (st == ST_OK)
        st = v->kind->check(v, scene);
    if (st != ST_OK)
        return st;
    loader_select_gradients(v->treelets, scene->smooth_normals);
    *tr = (tracer){.kind = v->kind,
                   .treelets = v->treelets,
                   .layout = &v->file->layout,
                   .isos = {v->surface_count, v->isovalues},
                   .space = v->space,
                   .preview = scene->preview,
                   .touched = v->touched};
    v->kind->aim(v, scene, c, tr);
    return clip_of(scene, tr);
}

status volume_tracer(leafcast *v, const leafcast_scene *scene, const camera *c, tracer *tr) {
    const status st = arguments_check_scene(scene);
    if (st == ST_OK && v->surface_count == 0)
        return status_describe(ST_USAGE, "no isosurface is selected");
    return st == ST_OK ? volume_tracer_of_all(v, scene, c, tr) : st;
}

static size_t image_bytes(const leafcast_image *image, size_t pixels) {
    const float *const floats[] = {image->r,         image->g,         image->b,        image->a,
                                   image->normal[0], image->normal[1], image->normal[2]};
    size_t bytes = 0;
    for (size_t i = 0; i < sizeof floats / sizeof *floats; i++)
        bytes += floats[i] ? pixels * sizeof(float) : 0;
    bytes += image->z ? pixels * sizeof(double) : 0;
    bytes += image->id ? pixels * sizeof(int32_t) : 0;
    return bytes + (image->provisional ? pixels : 0);
}

/* What more than one sample a pixel needs: a picture that is not summed up yet. */
static leafcast_image colours_of(const leafcast_image *image) {
    return (leafcast_image){
        .size = sizeof *image, .r = image->r, .g = image->g, .b = image->b, .a = image->a};
}

static const leafcast_scene *scene_of(const frame *f) {
    return surface_look_of(f)->scene;
}

/* Records of suspended rays, as many as there may be use for. */
static uint32_t records_wanted(const frame *f) {
    const size_t pixels = (size_t)f->width * f->height;
    const uint32_t least = frame_records_min(f);
    const size_t records = (pixels + 255) / 256 * 256 * 2;
    return records < least ? least : records < UINT32_MAX / 2 ? (uint32_t)records : UINT32_MAX / 2;
}

/* What all threads draw in. */
static size_t scratch_bytes(const frame *f) {
    return (size_t)pool_threads(f->threads) * frame_scratch_bytes(f);
}

/* All of the budget but records and treelets. */
static size_t fixed_bytes(const leafcast *v, const frame *f) {
    const size_t pixels = (size_t)f->width * f->height;
    const leafcast_image colours = colours_of(&f->image);
    return v->base_bytes + scratch_bytes(f) + v->beside + coarse_preview_bytes(v) +
           image_bytes(&f->image, pixels) +
           (scene_of(f)->samples > 1 ? image_bytes(&colours, pixels) : 0) +
           (v->kind->projection_bytes ? v->kind->projection_bytes(&v->file->layout) : 0) +
           frame_bytes(f, records_wanted(f));
}

/* With the fewest records, and one treelet at a time. */
static status check_budget(const leafcast *v, const frame *f, size_t fixed) {
    const size_t needed =
        fixed + frame_records_min(f) * frame_record_bytes(f) + loader_place_bytes(v->treelets);
    if (v->budget.limit == 0 || needed <= v->budget.limit)
        return ST_OK;
    return status_describe(
        ST_NOMEM,
        "the memory budget of %zu bytes is too small for this picture: %zu bytes would do",
        v->budget.limit, needed);
}

/* Once, for all frames. */
static status make_scratch(leafcast *v, frame *f) {
    if (!v->scratch)
        v->scratch = mem_alloc(&v->budget, scratch_bytes(f));
    f->scratch = v->scratch;
    return v->scratch ? ST_OK : ST_NOMEM;
}

/* Share the budget out: what is there, the picture, records of suspended rays (a quarter of the
 * rest, or what one treelet leaves), treelets. */
static status share_budget(leafcast *v, frame *f) {
    const uint32_t treelets = v->file->layout.treelets;
    const uint32_t least = frame_records_min(f);
    const size_t place = loader_place_bytes(v->treelets);
    size_t places = treelets, cached = SIZE_MAX;
    size_t records = records_wanted(f);
    if (v->budget.limit) {
        const size_t fixed = fixed_bytes(v, f);
        status st = check_budget(v, f, fixed);
        if (st != ST_OK)
            return st;
        const size_t rest = v->budget.limit - fixed, beside = rest - place;
        const size_t most = (rest / 4 < beside ? rest / 4 : beside) / frame_record_bytes(f);
        records = most < least ? least : most < records ? most : records;
        const size_t left = rest - records * frame_record_bytes(f);
        places = left / place < treelets ? left / place : treelets;
        cached = left - places * place;
    }
    if (v->options.treelet_limit) {
        places = places < v->options.treelet_limit ? places : v->options.treelet_limit;
        cached = 0;
    }
    f->records_max = (uint32_t)records;
    loader_set_capacity(v->treelets, (uint32_t)places, cached);
    return ST_OK;
}

/* Tiles of rays, where there are kernels for them. An experiment's intersector wants single rays.
 */
static status project(leafcast *v, frame *f) {
    if (!f->integrator->tile(f) || v->intersect)
        return ST_OK;
    status st = v->kind->project(v, &f->camera);
    if (st == ST_OK && v->projection.usable)
        f->projection = &v->projection;
    return st;
}

static void fill_stats(leafcast *v, const ray_counters *c, double render_s, leafcast_stats *stats) {
    const loader_stats l = loader_statistics(v->treelets);
    uint64_t visible = 0;
    for (uint32_t t = 0; t < v->file->layout.treelets; t++)
        visible += atomic_load_explicit(&v->touched[t], memory_order_relaxed)
                       ? loader_stored_bytes(v->treelets, t)
                       : 0;
    *stats = (leafcast_stats){.size = sizeof *stats,
                              .open_s = v->open_s,
                              .first_image_s = v->first_image_s,
                              .load_s = l.load_s,
                              .render_s = render_s,
                              .rays = c->primary_rays + c->shadow_rays,
                              .treelets_total = v->file->layout.treelets,
                              .treelets_active = v->treelets->treelets_active,
                              .treelets_loaded = l.loads,
                              .bytes_file = v->file->header.file_bytes,
                              .bytes_active = v->treelets->bytes_active,
                              .bytes_visible = visible,
                              .bytes_read = l.bytes_read,
                              .bytes_resident = l.bytes_resident,
                              .bytes_peak = mem_peak(&v->budget),
                              .threads = pool_threads(v->threads),
                              .isa = v->kernels.name};
#define COUNTER(name) stats->name = c->name;
    RAY_COUNTERS(COUNTER)
    PACKET_COUNTERS(COUNTER)
#undef COUNTER
}

leafcast_status leafcast_check_room(leafcast *v, const leafcast_scene *scene,
                                    const leafcast_camera *camera_of, const leafcast_image *planes,
                                    uint64_t beside) {
    status st = arguments_check_picture(scene, camera_of, planes, NULL);
    if (st != ST_OK)
        return volume_public_status(st);
    const tracer tr = {.kind = v->kind, .layout = &v->file->layout};
    const surface_look look = {.scene = scene};
    const frame f = {.tracer = &tr,
                     .volumes = 1,
                     .integrator = &surface_integrator,
                     .look = &look,
                     .threads = v->threads,
                     .width = camera_of->width,
                     .height = camera_of->height,
                     .image = *planes};
    camera c;
    st = camera_init(&c, camera_of);
    v->beside = (size_t)beside;
    if (st == ST_OK)
        st = check_budget(v, &f, fixed_bytes(v, &f));
    return volume_public_status(st);
}

/* One of the pictures that a picture is made of. */
typedef struct part {
    const frame *whole;
    int done, count;
} part;

static bool watch_part(void *ctx, double done) {
    const part *p = ctx;
    return p->whole->watch(p->whole->watch_ctx, (p->done + done) / p->count);
}

static status draw_part(leafcast *v, const part *p, const leafcast_image *image,
                        const double shift[2], ray_counters *counters) {
    frame f = *p->whole;
    const uint64_t provisional = counters->provisional_pixels, covered = counters->covered_pixels;
    f.image = *image;
    f.watch = f.watch ? watch_part : NULL;
    f.watch_ctx = (void *)p;
    f.projection = NULL;
    camera_shift(&f.camera, shift[0], shift[1]);
    counters->provisional_pixels = counters->covered_pixels = 0;
    status st = project(v, &f);
    if (st == ST_OK)
        st = frame_render(&f, counters);
    projection_release(&v->projection);
    /* A pixel counts once: the largest count of any sample's picture. */
    if (counters->provisional_pixels < provisional)
        counters->provisional_pixels = provisional;
    if (counters->covered_pixels < covered)
        counters->covered_pixels = covered;
    return st;
}

static status alloc_colours(mem *m, const leafcast_image *like, size_t pixels,
                            leafcast_image *out) {
    float *const there[4] = {like->r, like->g, like->b, like->a};
    float **const made[4] = {&out->r, &out->g, &out->b, &out->a};
    bool failed = false;
    *out = (leafcast_image){.size = sizeof *out};
    for (int i = 0; i < 4; i++) {
        *made[i] = there[i] ? mem_array(m, pixels, sizeof(float)) : NULL;
        failed |= there[i] && !*made[i];
    }
    return failed ? ST_NOMEM : ST_OK;
}

/* The planes of the pixels' centres, then the colours sample by sample; see samples.h. */
static status draw_samples(leafcast *v, const frame *f, ray_counters *counters) {
    static const double centre[2] = {0.0, 0.0};
    const leafcast_image colours = colours_of(&f->image);
    const bool coloured = colours.r || colours.g || colours.b || colours.a;
    const size_t pixels = (size_t)f->width * f->height;
    const int samples = coloured ? scene_of(f)->samples : 0;
    leafcast_image planes = f->image, now = {0};
    planes.r = planes.g = planes.b = planes.a = NULL;
    const bool others = !coloured || image_bytes(&planes, 1) > 0;
    part p = {f, 0, samples + others};
    status st = ST_OK;
    if (others)
        st = draw_part(v, &p, &planes, centre, counters);
    if (st == ST_OK && samples)
        st = alloc_colours(&v->budget, &colours, pixels, &now);
    for (int s = 0; s < samples && st == ST_OK; s++) {
        double shift[2];
        samples_shift(samples, s, shift);
        p.done = s + others;
        st = draw_part(v, &p, s ? &now : &colours, shift, counters);
        if (st == ST_OK && s)
            st = samples_add(v->threads, &colours, &now, pixels,
                             s + 1 < samples ? 1.0f : 1.0f / (float)samples);
    }
    float *const made[4] = {now.r, now.g, now.b, now.a};
    for (int i = 0; i < 4; i++)
        mem_free(&v->budget, made[i]);
    return st;
}

static status draw(leafcast *v, const frame *f, ray_counters *counters) {
    static const double centre[2] = {0.0, 0.0};
    const part whole = {f, 0, 1};
    return scene_of(f)->samples > 1 ? draw_samples(v, f, counters)
                                    : draw_part(v, &whole, &f->image, centre, counters);
}

leafcast_status leafcast_trace(leafcast *v, const leafcast_scene *scene,
                               const leafcast_camera *from, const leafcast_image *image,
                               leafcast_stats *stats, bool (*watch)(void *, double),
                               void *watch_ctx) {
    status st = arguments_check_picture(scene, from, image, stats);
    if (st != ST_OK)
        return volume_public_status(st);
    tracer tr, coarse;
    surface_look look = {.scene = scene, .volume = {{.surfaces = v->surfaces}}};
    frame f = {.m = &v->budget,
               .threads = v->threads,
               .tracer = &tr,
               .volumes = 1,
               .integrator = &surface_integrator,
               .look = &look,
               .kernels = &v->kernels,
               .width = from->width,
               .height = from->height,
               .image = *image,
               .stride = from->width,
               .watch = watch,
               .watch_ctx = watch_ctx};
    ray_counters counters = {0};
    const double start = clock_seconds();
    st = camera_init(&f.camera, from);
    loader_forget_failures(v->treelets);
    if (st == ST_OK)
        st = volume_tracer(v, scene, &f.camera, &tr);
    if (st == ST_OK)
        st = coarse_preview_begin(v, scene, &coarse, &look.volume[0].coarse);
    if (st == ST_OK)
        st = share_budget(v, &f);
    if (st == ST_NOMEM && look.volume[0].coarse) { /* rather without than not at all */
        look.volume[0].coarse = NULL;
        coarse_preview_end(v);
        st = share_budget(v, &f);
    }
    if (st != ST_OK)
        return volume_public_status(volume_check_file(v, st));
    if (!scene->preview)
        loader_follow(v->treelets, v->touched);
    for (uint32_t t = 0; t < v->file->layout.treelets; t++)
        atomic_store_explicit(&v->touched[t], 0, memory_order_relaxed);
    if (scene->sweep || scene->preview)
        loader_sweep(v->treelets);
    st = make_scratch(v, &f);
    if (st == ST_OK)
        st = draw(v, &f, &counters);
    if (st == ST_OK && look.volume[0].coarse)
        st = loader_failure(v->coarse->treelets);
    if (st == ST_OK && scene->sweep && !scene->preview)
        st = loader_settle(v->treelets);
    const double end = clock_seconds();
    st = volume_check_file(v, st);
    if (st == ST_OK && v->first_image_s == 0.0)
        v->first_image_s = end - v->opened_at;
    if (stats)
        fill_stats(v, &counters, end - start, stats);
    if (stats && look.volume[0].coarse)
        coarse_preview_stats(v, stats);
    return volume_public_status(st);
}

void experiment_intersect(leafcast *v, intersect_fn intersect) {
    v->intersect = intersect;
}

kernels *kernels_in_use(leafcast *v) {
    return &v->kernels;
}
