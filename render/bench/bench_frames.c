#include "render/bench/bench_frames.h"

#include <math.h>
#include <string.h>

#include "render/bench/bench_race.h"

static const double STANDARD = 2.2, CLOSE = 1.1; /* distances of the views, in longest edges */

/* ---- what all have in common ---- */

static double isovalue_of(const bench_subject *s) {
    return s->view.surfaces[0].isovalue;
}

/* One picture by every kernel. Rows begin with what `begin` adds. */
typedef struct heat {
    const bench_subject *volume;
    const leafcast_camera *camera; /* NULL: the standard view at `distance`, size x size */
    double distance;
    uint32_t size;
    int threads;
    const char *label; /* of the view */
    double zoom;       /* 0: not zoomed */
} heat;

static void begin_row(bench_table *t, const heat *h, const bench_racer *r, const char *isa) {
    bench_table_add(t, "%s", h->volume->label);
    bench_table_add(t, "%s", h->label);
    bench_table_add(t, "%g", h->zoom > 0.0 ? h->zoom : 1.0);
    bench_table_add(t, "%ux%u", r->camera.width, r->camera.height);
    bench_table_add(t, "%s", isa);
    bench_table_add(t, "%d", r->stats.threads);
}
#define BEGIN_HEADINGS "volume|view|zoom|size|isa|threads|"

static status run_heat(bench_job *job, const heat *h) {
    const char *isas[BENCH_ISAS];
    bench_racer racers[BENCH_ISAS] = {{0}};
    const int count = bench_race_isas(h->volume->path, h->zoom > 0.0, isas);
    status st = ST_OK;
    for (int i = 0; i < count && st == ST_OK; i++) {
        const bench_entry e = {h->volume->path, isas[i],     isovalue_of(h->volume),
                               h->threads,      h->distance, h->size};
        st = bench_race_enter(&e, &racers[i]);
        if (h->camera)
            racers[i].camera = *h->camera;
    }
    if (st == ST_OK)
        st = bench_race_run(&job->m, racers, count, job->runs, job->progress, NULL, NULL);
    for (int i = 0; i < count && st == ST_OK; i++) {
        begin_row(&job->table, h, &racers[i], isas[i]);
        bench_race_row(&job->table, racers, count, i);
    }
    bench_race_leave(&job->m, racers, count);
    return st;
}

/* ---- table 4.1 ---- */

static status steps_of(bench_job *job, const bench_subject *volume) {
    static const struct {
        const char *label;
        double distance;
    } views[] = {{"standard", 2.2}, {"close", 1.1}, {"zoom", 0.4}};
    status st = ST_OK;
    for (uint32_t size = job->view.camera.width / 2; size <= job->view.camera.width; size *= 2)
        for (int v = 0; v < 3 && st == ST_OK; v++) {
            const heat h = {.volume = volume,
                            .distance = views[v].distance,
                            .size = size,
                            .threads = 1,
                            .label = views[v].label};
            st = run_heat(job, &h);
        }
    return st;
}

status bench_steps(bench_job *job) {
    static const char *const names[] = {"angiogram", "bonsai", "ml-32", "ml-128", "ml-512", NULL};
    static const char *const brief[] = {"ml-32", "ml-64", NULL};
    bench_table_init(&job->table,
                     "M08 table 4.1: traversal steps of single rays (scalar) and of tiles; one "
                     "thread, medians of CPU time, runs interleaved",
                     BEGIN_HEADINGS BENCH_RACE_HEADINGS);
    return bench_suite_each(job, names, brief, steps_of);
}

/* ---- table 4.7 ---- */

status bench_frames(bench_job *job) {
    static const char *const names[] = {"bonsai",    "engine",      "angiogram",      "teapot",
                                        "ch2better", "ct-head-u16", "cranium-i16",    "stent-f32",
                                        "ml-64",     "ml-512",      "attractor-1024", NULL};
    static const char *const brief[] = {"gyroid-96", "noise-48", "orbital-64", "ml-64", NULL};
    bench_table_init(&job->table,
                     "M08 table 4.7: frames with diffuse shading; medians, runs interleaved",
                     BEGIN_HEADINGS BENCH_RACE_HEADINGS);
    status st = ST_OK;
    for (int i = 0; st == ST_OK; i++) {
        bench_subject volume;
        st = bench_suite_subject(job, names, brief, i, &volume);
        for (int close = 0; close < 2 && st == ST_OK; close++) {
            const heat h = {.volume = &volume,
                            .distance = close ? CLOSE : STANDARD,
                            .size = job->view.camera.width,
                            .threads = job->threads,
                            .label = close ? "close" : "standard"};
            st = run_heat(job, &h);
        }
    }
    return st == ST_AGAIN ? ST_OK : st;
}

/* ---- figure 4.14 ---- */

enum { SIZES = 6, CONTESTANTS = 2 }; /* 32^3 .. 1024^3; scalar and auto */

static void scale_rows(bench_table *t, const bench_subject *volumes,
                       bench_racer r[SIZES][CONTESTANTS], int sizes) {
    for (int s = 0; s < sizes; s++)
        for (int c = 0; c < CONTESTANTS; c++) {
            const bench_racer *first = &r[0][c];
            const heat h = {.volume = &volumes[s], .label = "standard"};
            begin_row(t, &h, &r[s][c], c ? "auto" : "scalar");
            bench_table_add(t, "%u", leafcast_describe(r[s][c].volume).dims[0]);
            bench_table_add(t, "%.3f", r[s][c].median / first->median);
            bench_table_add(t, "%.2f", (double)r[s][c].stats.nodes / (double)first->stats.nodes);
            bench_table_add(t, "%llu", (unsigned long long)r[s][c].stats.treelets_active);
            bench_race_row(t, r[s], CONTESTANTS, c);
        }
}

status bench_figure414(bench_job *job) {
    static const char *const names[] = {"ml-32",  "ml-64",   "ml-128", "ml-256",
                                        "ml-512", "ml-1024", NULL};
    static bench_racer racers[SIZES][CONTESTANTS]; /* large, */
    static bench_subject volumes[SIZES];           /* too */
    int sizes = 0;
    memset(racers, 0, sizeof racers);
    bench_table_init(&job->table,
                     "M08 figure 4.14: Marschner-Lobb on 32^3 to 1024^3 samples, standard view; "
                     "one thread, medians of CPU time, all sizes interleaved",
                     BEGIN_HEADINGS
                     "samples|x smallest|nodes x smallest|treelets|" BENCH_RACE_HEADINGS);
    if (job->target)
        return status_describe(ST_USAGE, "bench figure414 takes no file: it makes its own volumes");
    status st = ST_OK;
    while (sizes < SIZES && (32u << sizes) <= (uint32_t)(job->brief ? 64 : job->largest) &&
           st == ST_OK) {
        st = bench_suite_subject(job, names, names, sizes, &volumes[sizes]);
        for (int c = 0; c < CONTESTANTS && st == ST_OK; c++) {
            const bench_entry e = {volumes[sizes].path,
                                   c ? "auto" : "scalar",
                                   isovalue_of(&volumes[sizes]),
                                   1,
                                   STANDARD,
                                   job->view.camera.width};
            st = bench_race_enter(&e, &racers[sizes][c]);
        }
        sizes++;
    }
    if (st == ST_OK)
        st = bench_race_run(&job->m, &racers[0][0], sizes * CONTESTANTS, job->runs, job->progress,
                            NULL, NULL);
    if (st == ST_OK)
        scale_rows(&job->table, volumes, racers, sizes);
    bench_race_leave(&job->m, &racers[0][0], SIZES * CONTESTANTS);
    return st;
}

/* ---- experiment E4 ---- */

static const char *const PLACES[] = {"far", "near", "inside"};
enum { PLACE_FAR, PLACE_NEAR, PLACE_INSIDE, PLACE_COUNT };

/* Where the surface is that is nearest to the middle of a small picture: what zooming goes to. */
static status find_aim(bench_job *job, leafcast *volume, leafcast_camera *camera) {
    enum { SIDE = 65 };
    double *depth = mem_array(&job->m, (size_t)SIDE * SIDE, sizeof *depth);
    const leafcast_scene scene = leafcast_scene_default();
    const leafcast_image image = {.size = sizeof(leafcast_image), .z = depth};
    leafcast_camera small = *camera;
    small.width = small.height = SIDE;
    if (!depth)
        return ST_NOMEM;
    status st = (status)leafcast_trace(volume, &scene, &small, &image, NULL, NULL, NULL);
    int best = -1, nearest = SIDE * SIDE;
    for (int i = 0; i < SIDE * SIDE && st == ST_OK; i++) {
        const int dx = i % SIDE - SIDE / 2, dy = i / SIDE - SIDE / 2;
        if (isfinite(depth[i]) && dx * dx + dy * dy < nearest) {
            nearest = dx * dx + dy * dy;
            best = i;
        }
    }
    if (best >= 0) {
        double origin[3], direction[3];
        leafcast_pixel_ray(&small, best % SIDE + 0.5, best / SIDE + 0.5, origin, direction);
        for (int a = 0; a < 3; a++)
            camera->look_at[a] = origin[a] + depth[best] * direction[a];
    }
    mem_free(&job->m, depth);
    return st;
}

/* From inside: the eye in the middle of the box, looking the way it would from outside. */
static void step_inside(const leafcast_info *info, leafcast_camera *c) {
    for (int a = 0; a < 3; a++) {
        const double middle = 0.5 * (info->bounds[0][a] + info->bounds[1][a]);
        const double ahead = c->look_at[a] - c->eye[a];
        c->eye[a] = middle + 0.1234 * info->cell_size; /* on no grid plane */
        c->look_at[a] = c->eye[a] + ahead;
    }
}

static status aim(bench_job *job, const bench_subject *volume, int place, uint32_t size,
                  leafcast_camera *camera) {
    const bench_entry e = {
        volume->path, NULL, isovalue_of(volume), 1, place == PLACE_FAR ? 4.0 * STANDARD : CLOSE,
        size};
    bench_racer scout;
    status st = bench_race_enter(&e, &scout);
    if (st == ST_OK) {
        const leafcast_info info = leafcast_describe(scout.volume);
        *camera = scout.camera;
        if (place == PLACE_INSIDE)
            step_inside(&info, camera);
        st = find_aim(job, scout.volume, camera);
    }
    bench_race_leave(&job->m, &scout, 1);
    return st;
}

static status zoom_from(bench_job *job, const bench_subject *volume, int place) {
    static const double zooms[] = {0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0};
    static const double degree = 3.14159265358979323846 / 180.0;
    leafcast_camera camera;
    status st = aim(job, volume, place, job->view.camera.width / 2, &camera);
    const double wide = tan(0.5 * camera.fov * degree);
    for (size_t i = 0; i < sizeof zooms / sizeof *zooms && st == ST_OK; i++) {
        const heat h = {.volume = volume,
                        .camera = &camera,
                        .distance = CLOSE,
                        .size = camera.width,
                        .threads = 1,
                        .label = PLACES[place],
                        .zoom = zooms[i]};
        camera.fov = 2.0 * atan(wide / zooms[i]) / degree;
        st = run_heat(job, &h);
    }
    return st;
}

status bench_zoom(bench_job *job) {
    static const char *const names[] = {"ml-256", NULL}, *const brief[] = {"ml-64", NULL};
    bench_table_init(&job->table,
                     "E4: from far, near and inside, zoomed to a surface; one thread, medians of "
                     "CPU time, runs interleaved",
                     BEGIN_HEADINGS BENCH_RACE_HEADINGS);
    bench_subject volume;
    status st = bench_suite_subject(job, names, brief, 0, &volume);
    for (int place = 0; place < PLACE_COUNT && st == ST_OK; place++)
        st = zoom_from(job, &volume, place);
    return st;
}
