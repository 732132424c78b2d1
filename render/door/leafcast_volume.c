#include "render/leafcast.h"

#include <math.h>
#include <string.h>

#include "formats/base/clock.h"
#include "formats/leaf/leaf_histogram.h"
#include "formats/public_status.h"
#include "render/door/arguments.h"
#include "render/door/between_steps.h"
#include "render/door/coarse_preview.h"
#include "render/door/leafcast_device.h"
#include "render/door/leafcast_volume.h"
#include "render/frame/laboratory.h"
#include "render/ray/kind.h"
#include "stream/moving_surface.h"

_Static_assert((int)LEAFCAST_SURFACES_MAX <= (int)ISOVALUES_MAX, "as many isovalues as surfaces");

status volume_check_file(const leafcast *v, status st) {
    if (st != ST_OK && st != ST_CORRUPT && st != ST_IO)
        return st;
    const status changed = leaf_file_changed(v->file);
    return changed != ST_OK ? changed : st;
}

const char *leafcast_version(void) {
    return LEAFCAST_VERSION;
}

/* ---- Opening ---- */

/* Threads that read. Each takes memory, which small budgets need for treelets. */
enum { LOADER_WORKERS = 4, LOADER_WORKERS_FEW = 2, FEW_BELOW = 256 << 20 };

static int workers_within(const mem *m) {
    return m->limit && m->limit < FEW_BELOW ? LOADER_WORKERS_FEW : LOADER_WORKERS;
}

static status open_loader(leafcast *v) {
    static const source_kind kinds[] = {SOURCE_AUTO, SOURCE_MAPPED, SOURCE_ARENA};
    loader_options o = {.source = kinds[v->options.backend],
                        .workers = workers_within(v->m),
                        .isa = v->kernels.isa};
    if (v->kind->loading)
        v->kind->loading(v, &o);
    if (v->experiments.isopolygons) {
        const laboratory *l;
        const status st = laboratory_needed(&l);
        if (st != ST_OK)
            return st;
        l->load(v, &o);
    }
    return loader_create(v->m, v->file, &o, v->device->readers, &v->treelets);
}

_Static_assert((int)LEAFCAST_AXES_LPS == (int)WORLD_LPS && (int)LEAFCAST_AXES_RAS == (int)WORLD_RAS,
               "the public axes are those of the file");

/* Place the volume in the world that the options ask for, if the file names its own axes. */
static void place(leafcast *v) {
    const world_axes wanted = (world_axes)v->options.axes;
    double map[3][4];
    memcpy(map, v->file->header.to_world, sizeof map);
    const bool turned = world_axes_turn(v->file->frame.axes, wanted, map);
    v->axes = turned ? wanted : (world_axes)v->file->frame.axes;
    affine_init(&v->space, (const double *)map);
}

static status open_experiments(leafcast *v) {
    const laboratory *l;
    if (v->experiments.packets == 0)
        return ST_OK;
    const status st = laboratory_needed(&l);
    return st == ST_OK ? l->use_packets(v) : st;
}

status volume_open_file(leafcast *v) {
    mem *m = v->m;
    v->kind = kind_of(v->file);
    v->kernels = ray_kernels_of(v->kind, v->device->isa);
    status st = v->kind->open ? v->kind->open(v) : ST_OK;
    if (st == ST_OK)
        st = open_experiments(v);
    if (st == ST_OK)
        st = open_loader(v);
    if (st != ST_OK)
        return st;
    v->touched = mem_array(m, v->file->layout.treelets, sizeof *v->touched);
    v->stop = mem_array(m, v->file->layout.treelets, sizeof *v->stop);
    if (!v->touched || !v->stop)
        return ST_NOMEM;
    place(v);
    v->preview_levels = v->file->layout.sampled + coarse_preview_levels(v);
    return ST_OK;
}

/* Where a volume is opened from: a file, or its bytes in memory. */
typedef struct location {
    const char *path; /* NULL: in memory */
    const void *bytes;
    size_t size;
} location;

static status open_location(leafcast *v, const void *of) {
    const location *from = of;
    return from->path ? leaf_file_open(v->m, from->path, &v->file)
                      : leaf_file_open_memory(v->m, "memory", from->bytes, from->size, &v->file);
}

leafcast *volume_on(leafcast_device *d, const leafcast_options *options) {
    mem outside;
    mem_init(&outside, 0);
    leafcast *v = mem_zalloc(&outside, sizeof *v);
    if (!v)
        return NULL;
    v->device = d;
    v->m = &d->budget;
    v->choice = d->choice;
    v->threads = pool_threads(d->threads);
    v->options = *options;
    if (options->experiments)
        v->experiments = *options->experiments;
    v->options.experiments = NULL; /* points into the caller's memory */
    /* Holds do not nest. Whoever takes steps in has the device's lock, and must not wait for ever.
     */
    pthread_rwlockattr_t writers_first;
    pthread_rwlockattr_init(&writers_first);
    pthread_rwlockattr_setkind_np(&writers_first, PTHREAD_RWLOCK_PREFER_WRITER_NONRECURSIVE_NP);
    pthread_rwlock_init(&v->steps, &writers_first);
    pthread_rwlockattr_destroy(&writers_first);
    return v;
}

void volume_release(leafcast *v) {
    mem outside;
    mem_init(&outside, 0);
    if (v->coarse)
        volume_release(v->coarse);
    loader_destroy(v->treelets);
    if (v->kind && v->kind->close)
        v->kind->close(v);
    mem_free(v->m, v->stop);
    mem_free(v->m, v->touched);
    live_steps_destroy(v->live);
    moving_surface *moving = v->file ? v->file->moving : NULL;
    leaf_file_close(v->file);
    moving_surface_destroy(moving);
    pthread_rwlock_destroy(&v->steps);
    mem_free(&outside, v);
}

/* Evict all treelets first, so that the volume's own memory can be measured. */
status volume_open_on(leafcast_device *d, const leafcast_options *options, volume_make make,
                      const void *from, leafcast **out) {
    device_clear(d);
    const size_t before = mem_used(&d->budget);
    leafcast *v = volume_on(d, options);
    if (!v)
        return ST_NOMEM;
    status st = make(v, from);
    if (st == ST_OK)
        st = volume_open_file(v);
    if (st != ST_OK) {
        volume_release(v);
        return st;
    }
    v->base_bytes = mem_used(&d->budget) - before;
    d->base_bytes += v->base_bytes;
    v->next = d->volumes;
    d->volumes = v;
    *out = v;
    return ST_OK;
}

leafcast_status volume_open_by(volume_make make, const void *from, const leafcast_options *given,
                               leafcast **volume) {
    const double start = clock_seconds();
    status st = given ? arguments_check_options(given) : ST_OK;
    if (st != ST_OK)
        return public_status(st);
    const leafcast_options options = given ? *given : (leafcast_options){.size = sizeof options};
    leafcast_device *d = options.device;
    if (d)
        st = arguments_check_device("leafcast_open", d);
    else
        st = (status)leafcast_device_create(&options, &d);
    if (st != ST_OK)
        return public_status(st);
    device_lock(d);
    st = volume_open_on(d, &options, make, from, volume);
    d->users += st == ST_OK;
    device_unlock(d);
    if (st == ST_OK) {
        (*volume)->opened_at = start;
        (*volume)->open_s = clock_seconds() - start;
    }
    if (!options.device)
        device_release(d); /* the volume is its only user */
    return public_status(st);
}

leafcast_status leafcast_open(const char *path, const leafcast_options *options,
                              leafcast **volume) {
    const location from = {.path = path};
    const status st = public_needs(__func__, "path volume", (const void *[]){path, volume});
    return st == ST_OK ? volume_open_by(open_location, &from, options, volume) : public_status(st);
}

leafcast_status leafcast_open_memory(const void *bytes, size_t size,
                                     const leafcast_options *options, leafcast **volume) {
    const location from = {.bytes = bytes, .size = size};
    const status st =
        public_needs(__func__, "bytes volume", (const void *[]){size > 0 ? bytes : "", volume});
    return st == ST_OK ? volume_open_by(open_location, &from, options, volume) : public_status(st);
}

/* Undo volume_open_on(). */
static void close_on(leafcast_device *d, leafcast *v) {
    leafcast **at = &d->volumes;
    while (*at != v)
        at = &(*at)->next;
    *at = v->next;
    d->base_bytes -= v->base_bytes;
    volume_release(v);
}

void leafcast_close(leafcast *v) {
    if (!v || !device_is_here(v->device))
        return;
    leafcast_device *d = v->device;
    device_lock(d);
    if (v->between)
        close_on(d, v->between);
    close_on(d, v);
    device_unlock(d);
    device_release(d);
}

/* ---- Steps that change ---- */

/* Those of a constant volume, too. */
static pthread_rwlock_t *steps_lock(const leafcast *v) {
    return &((leafcast *)(uintptr_t)v)->steps;
}

static uint32_t hold_live(const leafcast *v, uint32_t step, live_hold *h) {
    *h = (live_hold){.step = step};
    live_steps_hold(v->live, h);
    return h->step;
}

uint32_t volume_hold(const leafcast *v, uint32_t step, live_hold *h) {
    *h = (live_hold){.step = step};
    if (!device_is_here(v->device)) /* its locks may be held for ever, and nobody writes */
        return step;
    pthread_rwlock_rdlock(steps_lock(v));
    return hold_live(v, step, h);
}

void volume_let_go(const leafcast *v, live_hold *h) {
    live_steps_let_go(h);
    if (device_is_here(v->device))
        pthread_rwlock_unlock(steps_lock(v));
}

void volume_lock(leafcast *v, live_hold *h) {
    device_lock(v->device);
    v->step = hold_live(v, v->step, h);
}

void volume_unlock(leafcast *v, live_hold *h) {
    if (v->live)
        loader_rest(v->treelets);
    live_steps_let_go(h);
    device_unlock(v->device);
}

/* Steps that a caller may ask for. Needs a hold, or the device's lock. */
static uint32_t steps_of(const leafcast *v) {
    return v->live ? 1 : v->file->header.steps;
}

/* What grows with the file, what its kind tells of the step that is shown, and the finite values of
 * all that is shown: as the header says, but for a live volume. */
static void tell_steps(const leafcast *v, leafcast_info *info) {
    live_hold h;
    const uint32_t step = volume_hold(v, 0, &h);
    v->kind->describe(v, step, info);
    const leaf_header *head = &v->file->header;
    const float *now = v->file->ranges[leaf_layout_samples(&v->file->layout, step, 0)];
    info->steps = steps_of(v);
    info->file_bytes = head->file_bytes;
    info->payload_bytes = head->payload_bytes;
    info->value_min = v->file->live ? (double)now[0] : head->value_min;
    info->value_max = v->file->live ? (double)now[1] : head->value_max;
    volume_let_go(v, &h);
}

leafcast_status leafcast_get_info(const leafcast *v, leafcast_info *info) {
    status st = public_needs(__func__, "info", (const void *[]){info});
    if (st == ST_OK)
        st = arguments_check_info(info);
    if (st != ST_OK)
        return public_status(st);
    *info = (leafcast_info){.size = sizeof *info};
    st = public_needs(__func__, "volume", (const void *[]){v});
    if (st != ST_OK)
        return public_status(st);
    const leaf_header *h = &v->file->header;
    const world_frame *world = &v->file->frame;
    *info = (leafcast_info){.size = sizeof *info,
                            .kind = v->kind->name,
                            .cell = v->kind->cell,
                            .levels = v->file->layout.sampled,
                            .fields = h->fields,
                            .moving = !v->live && leaf_layout_moves(&v->file->layout),
                            .treelets = v->file->layout.treelets,
                            .sample_type = sample_name((sample_type)h->sample_type),
                            .name = v->file->name,
                            .preview_levels = v->preview_levels,
                            .cell_levels = v->cell_levels,
                            .gradients = h->gradients != 0,
                            .axes = (leafcast_axes)v->axes,
                            .units = {world->unit[0], world->unit[1], world->unit[2]},
                            .time_unit = world->time_unit,
                            .cell_size = 1.0};
    tell_steps(v, info);
    return LEAFCAST_OK;
}

/* ---- Selecting ---- */

leafcast_surface leafcast_surface_default(double isovalue) {
    return (leafcast_surface){isovalue, {0.9f, 0.85f, 0.75f}, 1.0f, 0.0f, 0.0f};
}

leafcast_status leafcast_select(leafcast *v, const leafcast_surface *surfaces, int count) {
    status st = arguments_check_volume(__func__, v);
    if (st == ST_OK)
        st = arguments_check_surfaces(surfaces, count);
    if (st != ST_OK)
        return public_status(st);
    live_hold h;
    volume_lock(v, &h);
    memcpy(v->surfaces, surfaces, (size_t)count * sizeof *surfaces);
    v->surface_count = count;
    leafcast_shown shown = {.volume = v,
                            .field = v->field,
                            .step = v->step,
                            .surfaces = surfaces,
                            .count = count,
                            .between = v->share};
    st = between_steps_open(&shown.volume, v->share);
    if (st == ST_OK) {
        const interest nothing = {.count = 0};
        volume_show_beside(&shown, &nothing);
        loader_reset_statistics(shown.volume->treelets);
    }
    volume_unlock(v, &h);
    return public_status(st);
}

status volume_check_set(const leafcast *v, uint32_t field, uint32_t step) {
    live_hold h;
    (void)volume_hold(v, step, &h);
    const uint32_t fields = v->file->header.fields, steps = steps_of(v);
    volume_let_go(v, &h);
    if (field < fields && step < steps)
        return ST_OK;
    return status_describe(ST_USAGE, "field %u at step %u: there are %u fields and %u steps", field,
                           step, fields, steps);
}

void leafcast_stop_reading(leafcast *v) {
    if (!v || !device_is_here(v->device))
        return;
    device_lock(v->device);
    for (leafcast *of = v; of; of = of->between) {
        loader_rest(of->treelets);
        if (of->coarse)
            loader_rest(of->coarse->treelets);
    }
    device_unlock(v->device);
}

leafcast_status leafcast_select_set(leafcast *v, uint32_t field, uint32_t step) {
    status st = arguments_check_volume(__func__, v);
    if (st == ST_OK)
        st = volume_check_set(v, field, step);
    if (st != ST_OK)
        return public_status(st);
    live_hold h;
    volume_lock(v, &h);
    v->field = field;
    v->step = v->live ? v->step : step;
    v->share = 0.0;
    v->set = leaf_layout_set(&v->file->layout, field, v->step); /* what the loader has */
    loader_select_set(v->treelets, v->set);
    loader_reset_statistics(v->treelets);
    volume_unlock(v, &h);
    return LEAFCAST_OK;
}

leafcast_status leafcast_expect_set(leafcast *v, uint32_t field, uint32_t step) {
    status st = arguments_check_volume(__func__, v);
    if (st == ST_OK)
        st = volume_check_set(v, field, step);
    if (st != ST_OK || v->live)
        return public_status(st);
    device_lock(v->device);
    loader_expect(v->treelets, leaf_layout_set(&v->file->layout, field, step));
    device_unlock(v->device);
    return LEAFCAST_OK;
}

leafcast_status leafcast_range(const leafcast *v, uint32_t field, uint32_t step, double range[2]) {
    status st = public_needs(__func__, "volume range", (const void *[]){v, range});
    if (st == ST_OK)
        st = volume_check_set(v, field, step);
    if (st != ST_OK)
        return public_status(st);
    live_hold h;
    step = volume_hold(v, step, &h);
    leaf_histogram_range(v->file, leaf_layout_set(&v->file->layout, field, step), range);
    volume_let_go(v, &h);
    return LEAFCAST_OK;
}

const char *leafcast_field_name(const leafcast *v, uint32_t field) {
    return v ? leaf_file_field_name(v->file, field) : "";
}

double leafcast_step_time(const leafcast *v, uint32_t step) {
    if (!v)
        return (double)step;
    live_hold h;
    const uint32_t held = volume_hold(v, step, &h);
    const double time = step < steps_of(v) ? leaf_file_step_time(v->file, held) : (double)step;
    volume_let_go(v, &h);
    return time;
}

leafcast_status leafcast_find_field(const leafcast *v, const char *name, uint32_t *field) {
    const status given =
        public_needs(__func__, "volume name field", (const void *[]){v, name, field});
    if (given != ST_OK)
        return public_status(given);
    return public_status(leaf_file_find_field(v->file, name, field));
}

leafcast_status leafcast_init_scene(leafcast_scene *scene) {
    status st = public_needs(__func__, "scene", (const void *[]){scene});
    if (st == ST_OK)
        st = public_size("leafcast_scene", scene->size, sizeof *scene);
    if (st == ST_OK)
        *scene = (leafcast_scene){
            .size = sizeof *scene, .ambient = 0.15f, .specular = 0.3f, .shininess = 32};
    return public_status(st);
}

leafcast_status leafcast_get_standard_view(const leafcast *v, double distance, uint32_t width,
                                           uint32_t height, leafcast_camera *view) {
    leafcast_info info = {.size = sizeof info};
    status st = arguments_begin_view(__func__, view, width, height);
    if (st == ST_OK)
        st = public_needs(__func__, "volume", (const void *[]){v});
    if (st == ST_OK)
        st = public_in_range(__func__, "distance", distance, LEAFCAST_DIRECTION_LEAST,
                             LEAFCAST_PLACE_MOST);
    if (st == ST_OK)
        st = (status)leafcast_get_info(v, &info);
    if (st == ST_OK)
        *view = camera_standard((const double(*)[3])info.bounds, distance, width, height);
    return public_status(st);
}

void leafcast_pixel_ray(const leafcast_camera *camera_of, double x, double y, double origin[3],
                        double direction[3]) {
    camera c;
    if (!origin || !direction)
        return;
    for (int a = 0; a < 3; a++) {
        origin[a] = camera_of ? camera_of->eye[a] : 0.0;
        direction[a] = 0.0;
    }
    if (camera_of && arguments_check_camera(camera_of) == ST_OK &&
        camera_init(&c, camera_of) == ST_OK && isfinite(x) && isfinite(y))
        camera_ray(&c, x, y, origin, direction);
}
