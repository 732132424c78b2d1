#include "render/leafcast.h"

#include <math.h>
#include <string.h>

#include "formats/base/clock.h"
#include "render/experiment.h"
#include "render/frame.h"
#include "render/intersect.h"
#include "render/kernels.h"
#include "render/level_planes.h"

_Static_assert((int)LEAFCAST_USAGE == (int)ST_USAGE && (int)LEAFCAST_CORRUPT == (int)ST_CORRUPT &&
                   (int)LEAFCAST_UNSUPPORTED == (int)ST_UNSUPPORTED &&
                   (int)LEAFCAST_NOMEM == (int)ST_NOMEM && (int)LEAFCAST_IO == (int)ST_IO &&
                   (int)LEAFCAST_STOPPED == (int)ST_STOPPED &&
                   (int)LEAFCAST_FAILED == (int)ST_FAILED,
               "public and internal status agree");
_Static_assert((int)LEAFCAST_SURFACES_MAX <= (int)ACTIVE_ISOS_MAX, "as many isovalues as surfaces");

enum { LOADER_WORKERS = 2 };

struct leafcast {
    mem budget;
    leafcast_options options;
    leaf_file *file;
    pool *threads;
    loader *treelets;
    level_planes_table planes;
    affine space;
    kernels kernels;
    projection projection; /* of the frame that is being drawn */
    leafcast_surface surfaces[LEAFCAST_SURFACES_MAX];
    double isovalues[LEAFCAST_SURFACES_MAX];
    int surface_count;
    atomic_uchar *touched;
    uint8_t *stop;          /* per treelet, for --lod pixel */
    size_t base_bytes;      /* of the budget, before any treelet */
    intersect_fn intersect; /* instead of the scene's, see experiment.h */
    double opened_at, open_s, first_image_s;
};

static leafcast_status public_status(status st) {
    switch (st) {
    case ST_OK:
    case ST_USAGE:
    case ST_CORRUPT:
    case ST_UNSUPPORTED:
    case ST_NOMEM:
    case ST_IO:
    case ST_STOPPED: return (leafcast_status)st;
    default: return LEAFCAST_FAILED;
    }
}

const char *leafcast_error_text(void) {
    return status_text();
}

/* ---- Opening ---- */

static status open_parts(leafcast *v, const char *path) {
    static const source_kind kinds[] = {SOURCE_AUTO, SOURCE_MAPPED, SOURCE_ARENA};
    mem *m = &v->budget;
    if (!kernels_for(v->options.isa, &v->kernels))
        return status_describe(ST_USAGE, "this CPU or this build has no kernels called %s",
                               v->options.isa);
    status st = leaf_file_open(m, path, &v->file);
    if (st == ST_OK)
        st = level_planes_init(&v->planes, m, v->file);
    if (st == ST_OK)
        st = pool_create(m, v->options.threads > 0 ? v->options.threads : pool_default_threads(),
                         &v->threads);
    if (st == ST_OK)
        st = loader_create(m, v->file, kinds[v->options.backend], LOADER_WORKERS, v->kernels.isa,
                           &v->treelets);
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

leafcast_status leafcast_open(const char *path, const leafcast_options *options,
                              leafcast **volume) {
    mem outside;
    const double start = clock_seconds();
    mem_init(&outside, 0);
    leafcast *v = mem_zalloc(&outside, sizeof *v);
    if (!v)
        return LEAFCAST_NOMEM;
    if (options)
        v->options = *options;
    mem_init(&v->budget, (size_t)v->options.memory);
    status st = open_parts(v, path);
    if (st != ST_OK) {
        leafcast_close(v);
        return public_status(st);
    }
    v->opened_at = start;
    v->open_s = clock_seconds() - start;
    *volume = v;
    return LEAFCAST_OK;
}

void leafcast_close(leafcast *v) {
    if (!v)
        return;
    mem outside;
    mem_init(&outside, 0);
    loader_destroy(v->treelets);
    pool_destroy(v->threads);
    level_planes_release(&v->planes);
    mem_free(&v->budget, v->stop);
    mem_free(&v->budget, v->touched);
    leaf_file_close(v->file);
    mem_free(&outside, v);
}

leafcast_info leafcast_describe(const leafcast *v) {
    const leaf_header *h = &v->file->header;
    leafcast_info info = {.levels = h->levels,
                          .treelets = v->file->layout.treelets,
                          .sample_type = sample_name((sample_type)h->sample_type),
                          .name = h->name,
                          .value_min = h->value_min,
                          .value_max = h->value_max,
                          .cell_size = 1.0,
                          .file_bytes = h->file_bytes,
                          .payload_bytes = h->payload_bytes};
    for (int a = 0; a < 3; a++) {
        info.dims[a] = h->dims[a];
        info.bounds[0][a] = INFINITY;
        info.bounds[1][a] = -INFINITY;
    }
    for (int corner = 0; corner < 8; corner++) {
        double grid[3], world[3];
        for (int a = 0; a < 3; a++)
            grid[a] = v->file->axis[a][corner >> a & 1 ? h->dims[a] - 1 : 0];
        affine_point_to_world(&v->space, grid, world);
        for (int a = 0; a < 3; a++) {
            info.bounds[0][a] = fmin(info.bounds[0][a], world[a]);
            info.bounds[1][a] = fmax(info.bounds[1][a], world[a]);
        }
    }
    for (int a = 0; a < 3; a++) {
        const double *axis = v->file->axis[a], edge = affine_unit(&v->space, a);
        info.cell_size *= cbrt(edge * (axis[h->dims[a] - 1] - axis[0]) / (h->dims[a] - 1));
    }
    return info;
}

/* ---- Selecting ---- */

leafcast_surface leafcast_surface_default(double isovalue) {
    return (leafcast_surface){isovalue, {0.9f, 0.85f, 0.75f}, 1.0f};
}

leafcast_status leafcast_select(leafcast *v, const leafcast_surface *surfaces, int count) {
    if (count < 1 || count > LEAFCAST_SURFACES_MAX)
        return public_status(status_describe(ST_USAGE,
                                             "%d isosurfaces: 1 to %d can be drawn at once", count,
                                             LEAFCAST_SURFACES_MAX));
    for (int i = 0; i < count; i++) {
        if (!isfinite(surfaces[i].isovalue))
            return public_status(
                status_describe(ST_USAGE, "isovalue %d is not a finite number", i + 1));
        if (!(surfaces[i].opacity > 0.0f && surfaces[i].opacity <= 1.0f))
            return public_status(status_describe(ST_USAGE, "opacity %d is not in (0, 1]", i + 1));
    }
    for (int i = 0; i < count; i++) {
        v->surfaces[i] = surfaces[i];
        v->isovalues[i] = surfaces[i].isovalue;
    }
    v->surface_count = count;
    loader_select(v->treelets, v->isovalues, count);
    loader_reset_statistics(v->treelets);
    return LEAFCAST_OK;
}

leafcast_scene leafcast_scene_default(void) {
    return (leafcast_scene){.ambient = 0.15f,
                            .specular = 0.3f,
                            .shininess = 32,
                            .background = {0.0f, 0.0f, 0.0f, 0.0f}};
}

leafcast_camera leafcast_standard_view(const leafcast *v, double distance, uint32_t width,
                                       uint32_t height) {
    const leafcast_info info = leafcast_describe(v);
    return camera_standard((const double(*)[3])info.bounds, distance, width, height);
}

void leafcast_pixel_ray(const leafcast_camera *camera_of, double x, double y, double origin[3],
                        double direction[3]) {
    camera c;
    for (int a = 0; a < 3; a++) {
        origin[a] = camera_of->eye[a];
        direction[a] = 0.0;
    }
    if (camera_init(&c, camera_of) == ST_OK)
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
    if (scene->clip_plane_count < 0 || scene->clip_plane_count > LEAFCAST_CLIP_PLANES_MAX)
        return status_describe(ST_USAGE, "%d clip planes: 0 to %d are possible",
                               scene->clip_plane_count, LEAFCAST_CLIP_PLANES_MAX);
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

/* For --lod pixel: stop at the treelets whose cells are not larger than a pixel where they come
 * nearest to the eye. */
static void stop_levels(leafcast *v, const camera *c) {
    const leaf_layout *layout = &v->file->layout;
    const double pixel = camera_pixel(c);
    for (uint32_t t = 0; t < layout->treelets; t++) {
        const level_planes *planes = &v->planes.levels[layout->level_of[t]];
        double centre[3], radius = 0.0, edge = 0.0, distance = 0.0, world[3];
        for (int a = 0; a < 3; a++) {
            const uint32_t first = layout->place[t][a] << layout->cells_log2;
            const double lo = planes->at[a][first],
                         hi = planes->at[a][first + (1u << layout->cells_log2)];
            const double unit = affine_unit(&v->space, a);
            centre[a] = 0.5 * (lo + hi);
            radius += 0.5 * unit * (hi - lo);
            edge = fmax(edge, unit * (hi - lo) / (1u << layout->cells_log2));
        }
        affine_point_to_world(&v->space, centre, world);
        for (int a = 0; a < 3; a++)
            distance += (world[a] - c->eye[a]) * (world[a] - c->eye[a]);
        v->stop[t] = edge <= pixel * fmax(sqrt(distance) - radius, 0.0);
    }
}

static status tracer_of(leafcast *v, const leafcast_scene *scene, const camera *c, tracer *tr) {
    const intersector *how = intersector_find(scene->intersector);
    const leaf_layout *layout = &v->file->layout;
    if (v->surface_count == 0)
        return status_describe(ST_USAGE, "no isosurface is selected");
    if (!how)
        return status_describe(ST_USAGE, "there is no such intersector");
    if (scene->light_count < 0 || scene->light_count > LEAFCAST_LIGHTS_MAX)
        return status_describe(ST_USAGE, "%d lights: 0 to %d are possible", scene->light_count,
                               LEAFCAST_LIGHTS_MAX);
    *tr = (tracer){.scene = {.levels = v->planes.levels,
                             .isovalues = v->isovalues,
                             .count = v->surface_count,
                             .type = layout->type,
                             .halo = layout->halo,
                             .intersect = v->intersect ? v->intersect : how->next_hit},
                   .walk = v->kernels.walk,
                   .treelets = v->treelets,
                   .layout = layout,
                   .space = v->space,
                   .analytic_normals = scene->analytic_normals,
                   .preview = scene->preview,
                   .touched = v->touched};
    for (int a = 0; a < 3; a++) {
        tr->box[0][a] = v->file->axis[a][0];
        tr->box[1][a] = v->file->axis[a][v->file->header.dims[a] - 1];
    }
    if (scene->lod == LEAFCAST_LOD_LEVEL)
        tr->target_level =
            scene->lod_level < layout->levels ? scene->lod_level : layout->levels - 1;
    status st = clip_of(scene, tr);
    if (st == ST_OK && scene->lod == LEAFCAST_LOD_PIXEL && c) {
        stop_levels(v, c);
        tr->stop = v->stop;
    }
    return st;
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

/* Share the budget out: what is there, the picture, records of suspended rays (a quarter of the
 * rest, or what one treelet leaves), treelets. */
static status share_budget(leafcast *v, frame *f) {
    const uint32_t treelets = v->file->layout.treelets;
    const uint32_t least = frame_records_min(pool_threads(v->threads));
    const size_t pixels = (size_t)f->width * f->height, place = loader_place_bytes(v->treelets);
    size_t places = treelets, records = (pixels + 255) / 256 * 256 * 2;
    records = records < least ? least : records < UINT32_MAX / 2 ? records : UINT32_MAX / 2;
    if (v->budget.limit) {
        const size_t fixed =
            v->base_bytes + image_bytes(&f->image, pixels) + projection_bytes(&v->file->layout) +
            frame_bytes(treelets, (uint32_t)records, f->width, f->height, pool_threads(v->threads));
        const size_t needed = fixed + least * frame_record_bytes() + place;
        if (v->budget.limit < needed)
            return status_describe(
                ST_NOMEM,
                "the memory budget of %zu bytes is too small for this picture: %zu bytes would do",
                v->budget.limit, needed);
        const size_t rest = v->budget.limit - fixed, beside = rest - place;
        const size_t most = (rest / 4 < beside ? rest / 4 : beside) / frame_record_bytes();
        records = most < least ? least : most < records ? most : records;
        places = (rest - records * frame_record_bytes()) / place;
    }
    if (v->options.treelet_limit && places > v->options.treelet_limit)
        places = v->options.treelet_limit;
    f->records_max = (uint32_t)records;
    loader_set_capacity(v->treelets, (uint32_t)(places < treelets ? places : treelets));
    return ST_OK;
}

/* Tiles of rays, where there are kernels for them. An experiment's intersector wants single rays.
 */
static status project(leafcast *v, frame *f) {
    if (!v->kernels.tile || v->intersect)
        return ST_OK;
    status st = projection_init(&v->projection, &v->budget, &v->file->layout, v->planes.levels,
                                &v->space, &f->camera);
    if (st == ST_OK && v->projection.usable)
        f->projection = &v->projection;
    return st;
}

static void fill_stats(leafcast *v, const frame_counters *c, double render_s,
                       leafcast_stats *stats) {
    const loader_stats l = loader_statistics(v->treelets);
    uint64_t visible = 0;
    for (uint32_t t = 0; t < v->file->layout.treelets; t++)
        visible +=
            atomic_load_explicit(&v->touched[t], memory_order_relaxed) ? v->file->sizes[t] : 0;
    *stats = (leafcast_stats){.open_s = v->open_s,
                              .first_image_s = v->first_image_s,
                              .load_s = l.load_s,
                              .render_s = render_s,
                              .rays = c->primary_rays + c->shadow_rays,
                              .primary_rays = c->primary_rays,
                              .shadow_rays = c->shadow_rays,
                              .treelets_total = v->file->layout.treelets,
                              .treelets_active = v->treelets->treelets_active,
                              .treelets_loaded = l.loads,
                              .bytes_file = v->file->header.file_bytes,
                              .bytes_active = v->treelets->bytes_active,
                              .bytes_visible = visible,
                              .bytes_read = l.bytes_read,
                              .bytes_peak = mem_peak(&v->budget),
                              .nodes = c->walk.nodes,
                              .cells = c->walk.cells,
                              .roots = c->walk.roots,
                              .provisional_pixels = c->provisional_pixels,
                              .ill_conditioned = c->ill_conditioned,
                              .passes = c->passes,
                              .threads = pool_threads(v->threads),
                              .isa = v->kernels.name};
}

leafcast_status leafcast_trace(leafcast *v, const leafcast_scene *scene,
                               const leafcast_camera *from, const leafcast_image *image,
                               leafcast_stats *stats, bool (*watch)(void *, double),
                               void *watch_ctx) {
    tracer tr;
    frame f = {.m = &v->budget,
               .threads = v->threads,
               .treelets = v->treelets,
               .tracer = &tr,
               .kernels = &v->kernels,
               .scene = scene,
               .surfaces = v->surfaces,
               .width = from->width,
               .height = from->height,
               .image = *image,
               .watch = watch,
               .watch_ctx = watch_ctx};
    frame_counters counters = {0};
    const double start = clock_seconds();
    status st = camera_init(&f.camera, from);
    loader_forget_failures(v->treelets);
    if (st == ST_OK)
        st = tracer_of(v, scene, &f.camera, &tr);
    if (st == ST_OK)
        st = share_budget(v, &f);
    if (st != ST_OK)
        return public_status(st);
    for (uint32_t t = 0; t < v->file->layout.treelets; t++)
        atomic_store_explicit(&v->touched[t], 0, memory_order_relaxed);
    if (scene->sweep || scene->preview)
        loader_sweep(v->treelets);
    st = project(v, &f);
    if (st == ST_OK)
        st = frame_render(&f, &counters);
    projection_release(&v->projection);
    if (st == ST_OK && scene->sweep && !scene->preview)
        st = loader_settle(v->treelets);
    const double end = clock_seconds();
    if (st == ST_OK && v->first_image_s == 0.0)
        v->first_image_s = end - v->opened_at;
    if (stats)
        fill_stats(v, &counters, end - start, stats);
    return public_status(st);
}

void experiment_intersect(leafcast *v, intersect_fn intersect) {
    v->intersect = intersect;
}

kernels *kernels_in_use(leafcast *v) {
    return &v->kernels;
}

/* ---- Probing ---- */

/* Bring in the one treelet that a probe needs. */
static status need(leafcast *v, uint32_t t) {
    loader_request request = {t, 0};
    return loader_admit(v->treelets, &request, 1);
}

/* The hit's treelet may have given way to one that starts where it ends: it is brought back. */
static status samples_of_hit(leafcast *v, const tracer *tr, const uint32_t cell[3],
                             float samples[8]) {
    uint32_t place[3];
    for (int a = 0; a < 3; a++)
        place[a] = cell[a] >> v->file->layout.cells_log2;
    const uint32_t t = leaf_layout_find(&v->file->layout, tr->target_level, place);
    for (;;) {
        const treelet *at = loader_lookup(v->treelets, t);
        if (at) {
            walk_cell_samples(&tr->scene, at, cell, samples);
            return ST_OK;
        }
        status st = need(v, t);
        if (st != ST_OK)
            return st;
    }
}

static status describe_hit(leafcast *v, const tracer *tr, const ray *r, const double origin[3],
                           const double direction[3], const trace_state *state, leafcast_hit *out) {
    const hit *h = &state->best;
    const level_planes *planes = &v->planes.levels[tr->target_level];
    *out = (leafcast_hit){.t = h->t, .surface = h->iso, .entering = h->entering};
    surface_cell_of(planes, h->cell, out->cell);
    double slope = 0.0;
    for (int a = 0; a < 3; a++) {
        const double x = r->o[a] + h->t * r->d[a];
        out->point[a] = origin[a] + h->t * direction[a];
        out->at[a] = fmin(
            fmax((x - planes->at[a][out->cell[a]]) * planes->inverse[a][out->cell[a]], 0.0), 1.0);
        out->gradient[a] = state->point.gradient[a];
        out->normal[a] = (double)state->point.normal[a];
        slope += state->point.gradient[a] * direction[a];
    }
    out->error_bound = slope != 0.0 ? state->point.error / fabs(slope) : INFINITY;
    return samples_of_hit(v, tr, out->cell, out->samples);
}

leafcast_status leafcast_probe_ray(leafcast *v, const leafcast_scene *scene, const double origin[3],
                                   const double direction[3], leafcast_hit *hits, int max,
                                   int *count) {
    tracer tr;
    ray r;
    walk_counters counters = {0};
    *count = 0;
    double length = 0.0, place = 0.0;
    for (int a = 0; a < 3; a++) {
        length += fabs(direction[a]);
        place += fabs(origin[a]);
    }
    if (!(length > 0.0 && length < INFINITY && place < INFINITY))
        return public_status(status_describe(ST_USAGE, "a ray needs a finite origin and a finite "
                                                       "direction that is not 0,0,0"));
    status st = tracer_of(v, scene, NULL, &tr);
    if (st != ST_OK)
        return public_status(st);
    tr.preview = false;
    loader_forget_failures(v->treelets);
    if (!tracer_ray(&tr, origin, direction, 0.0, INFINITY, &r))
        return LEAFCAST_OK;
    const hit before = hit_before_all();
    trace_state state = trace_begin(&before);
    while (*count < max) {
        const trace_result result = tracer_next(&tr, &r, &state, &counters);
        if (result == TRACE_MISS)
            break;
        if (result == TRACE_BLOCKED) {
            st = need(v, state.blocked);
            if (st != ST_OK)
                return public_status(st);
            continue;
        }
        st = describe_hit(v, &tr, &r, origin, direction, &state, &hits[*count]);
        if (st != ST_OK)
            return public_status(st);
        ++*count;
        const hit behind = state.best;
        state = trace_begin(&behind);
    }
    return LEAFCAST_OK;
}

/* The cell that owns a coordinate: [i, i + 1), the last one its end too. */
static uint32_t cell_owning(const double *axis, uint32_t nodes, double x) {
    uint32_t lo = 0, hi = nodes - 1;
    while (hi - lo > 1) {
        const uint32_t middle = lo + (hi - lo) / 2;
        if (axis[middle] <= x)
            lo = middle;
        else
            hi = middle;
    }
    return lo;
}

leafcast_status leafcast_probe_point(leafcast *v, const double point[3], leafcast_sample *sample) {
    const level_planes *planes = &v->planes.levels[0];
    const leaf_layout *layout = &v->file->layout;
    double grid[3];
    uint32_t place[3];
    *sample = (leafcast_sample){.value = NAN};
    affine_point_to_grid(&v->space, point, grid);
    for (int a = 0; a < 3; a++) {
        const double *axis = v->file->axis[a];
        if (!(grid[a] >= axis[0] && grid[a] <= axis[planes->cells[a]]))
            return LEAFCAST_OK;
        sample->cell[a] = cell_owning(axis, planes->cells[a] + 1, grid[a]);
        sample->at[a] =
            (grid[a] - planes->at[a][sample->cell[a]]) * planes->inverse[a][sample->cell[a]];
        place[a] = sample->cell[a] >> layout->cells_log2;
    }
    sample->inside = true;
    sample->treelet = leaf_layout_find(layout, 0, place);
    loader_forget_failures(v->treelets);
    status st = ST_OK;
    const treelet *tr = loader_lookup(v->treelets, sample->treelet);
    for (; !tr && st == ST_OK; tr = loader_lookup(v->treelets, sample->treelet))
        st = need(v, sample->treelet);
    if (st == ST_OK) {
        const walk_scene scene = {
            .levels = v->planes.levels, .type = layout->type, .halo = layout->halo};
        double gradient[3], inverse[3];
        for (int a = 0; a < 3; a++)
            inverse[a] = planes->inverse[a][sample->cell[a]];
        walk_cell_samples(&scene, tr, sample->cell, sample->samples);
        sample->value = surface_trilinear(sample->samples, sample->at, inverse, gradient);
        affine_gradient_to_world(&v->space, gradient, sample->gradient);
    }
    return public_status(st);
}
