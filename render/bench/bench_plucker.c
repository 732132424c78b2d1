#include "render/bench/bench_plucker.h"

#include <string.h>

#include "formats/base/clock.h"
#include "render/app/view_camera.h"

static const char HEADINGS[] = "mesh|draws|way|ms|+-|x tree|Mray/s|Mtets/s|tets/ray|tests/tet|"
                               "nodes/ray|peak MB|differ";

enum { DRAWS = 3, WAYS = 2, ENTRANTS = DRAWS * WAYS };
static const char *const DRAW_NAMES[DRAWS] = {"mean", "thin", "opaque"};
static const char *const WAY_NAMES[WAYS] = {"tree", "faces"};

typedef struct entrant {
    leafcast *volume;
    leafcast_transfer_point points[2];
    leafcast_medium medium;
    leafcast_scene scene;
    double *rgba, *seconds; /* of the last run; of every run */
    double median, spread;
    leafcast_stats stats;
} entrant;

typedef struct trial {
    mem *m;
    const bench_subject *subject;
    leafcast_camera camera;
    size_t pixels;
    entrant all[ENTRANTS];
} trial;

static status draw(const trial *t, entrant *e, double *seconds) {
    const leafcast_image image = {.size = sizeof image, .rgba = e->rgba};
    e->scene.media = &e->medium;
    e->stats.size = sizeof e->stats;
    const double start = clock_cpu_seconds();
    const status st =
        (status)leafcast_trace(e->volume, &e->scene, &t->camera, &image, &e->stats, NULL, NULL);
    *seconds = clock_cpu_seconds() - start;
    return st;
}

/* White, of an extinction that rises with the value: at the greatest one, 1 or 100 optical depths
 * over the box's longest edge. */
static status fill(entrant *e, int draws) {
    const leafcast_info info = leafcast_describe(e->volume);
    double range[2], edge = 0.0;
    status st = (status)leafcast_range(e->volume, 0, 0, range);
    for (int a = 0; a < 3; a++) {
        const double length = info.bounds[1][a] - info.bounds[0][a];
        edge = length > edge ? length : edge;
    }
    const double most = (draws == 1 ? 1.0 : 100.0) / edge;
    e->points[0] = (leafcast_transfer_point){range[0], {1.0, 1.0, 1.0}, 0.0};
    e->points[1] = (leafcast_transfer_point){range[1], {1.0, 1.0, 1.0}, most};
    e->medium = (leafcast_medium){e->points, 2};
    return st;
}

static status enter(bench_job *job, trial *t, int i) {
    entrant *e = &t->all[i];
    const leafcast_options options = {
        .size = sizeof options, .threads = 1, .neighbours = i % WAYS == 1};
    status st = (status)leafcast_open(t->subject->path, &options, &e->volume);
    if (st == ST_OK && strcmp(leafcast_describe(e->volume).kind, "mesh") != 0)
        st = status_describe(ST_USAGE, "%s: no mesh of tets", t->subject->path);
    if (st != ST_OK)
        return st;
    t->camera = view_camera_of(&t->subject->view, e->volume);
    t->pixels = (size_t)t->camera.width * t->camera.height;
    e->scene = leafcast_scene_default();
    e->scene.media_count = 1;
    e->scene.project = i / WAYS == 0 ? LEAFCAST_PROJECT_MEAN : LEAFCAST_PROJECT_NONE;
    e->rgba = mem_array(t->m, 4 * t->pixels, sizeof(double));
    e->seconds = mem_array(t->m, (size_t)job->runs, sizeof(double));
    return e->rgba && e->seconds ? fill(e, i / WAYS) : ST_NOMEM;
}

static status race(bench_job *job, trial *t) {
    status st = ST_OK;
    for (int run = -1; run < job->runs && st == ST_OK; run++) { /* the first brings treelets in */
        st = progress_step(job->progress, "drawing", (run + 1.0) / (job->runs + 1.0));
        for (int i = 0; i < ENTRANTS && st == ST_OK; i++) {
            double seconds;
            st = draw(t, &t->all[i], &seconds);
            if (run >= 0)
                t->all[i].seconds[run] = seconds;
        }
    }
    for (int i = 0; i < ENTRANTS && st == ST_OK; i++)
        t->all[i].median = bench_median(t->all[i].seconds, job->runs, &t->all[i].spread);
    return st;
}

static uint64_t differing(const trial *t, const entrant *a, const entrant *b) {
    uint64_t count = 0;
    for (size_t i = 0; i < t->pixels; i++)
        count += memcmp(&a->rgba[4 * i], &b->rgba[4 * i], 4 * sizeof(double)) != 0;
    return count;
}

/* A share of what is counted by faces alone; "-" of the tree. */
static void add_count(bench_table *table, const leafcast_stats *s, const char *format,
                      double share) {
    if (s->passed_tets > 0)
        bench_table_add(table, format, share);
    else
        bench_table_add(table, "-");
}

static void add_row(bench_table *table, const trial *t, int i) {
    const entrant *e = &t->all[i], *tree = &t->all[i - i % WAYS];
    const leafcast_stats *s = &e->stats;
    const double tets = (double)s->passed_tets, rays = (double)t->pixels;
    bench_table_add(table, "%s", t->subject->label);
    bench_table_add(table, "%s", DRAW_NAMES[i / WAYS]);
    bench_table_add(table, "%s", WAY_NAMES[i % WAYS]);
    bench_table_add(table, "%.2f", e->median * 1e3);
    bench_table_add(table, "%.2f", e->spread * 1e3);
    bench_table_add(table, "%.3f", e->median / tree->median);
    bench_table_add(table, "%.4f", rays * 1e-6 / e->median);
    add_count(table, s, "%.3f", tets * 1e-6 / e->median);
    add_count(table, s, "%.2f", tets / rays);
    add_count(table, s, "%.3f", (double)s->edge_tests / tets);
    bench_table_add(table, "%.2f", (double)s->nodes / rays);
    bench_table_add(table, "%.3f", (double)s->bytes_peak * 1e-6);
    bench_table_add(table, "%llu", (unsigned long long)differing(t, e, tree));
}

static void leave(trial *t) {
    for (int i = 0; i < ENTRANTS; i++) {
        leafcast_close(t->all[i].volume);
        mem_free(t->m, t->all[i].rgba);
        mem_free(t->m, t->all[i].seconds);
    }
}

static status try_mesh(bench_job *job, const bench_subject *s) {
    trial t = {.m = &job->m, .subject = s};
    status st = ST_OK;
    for (int i = 0; i < ENTRANTS && st == ST_OK; i++)
        st = enter(job, &t, i);
    if (st == ST_OK)
        st = race(job, &t);
    for (int i = 0; i < ENTRANTS && st == ST_OK; i++)
        add_row(&job->table, &t, i);
    leave(&t);
    return st;
}

status bench_plucker(bench_job *job) {
    static const char *const names[] = {"bucky-32", "bucky-2x32", NULL};
    static const char *const brief[] = {"bucky-12", NULL};
    bench_table_init(&job->table,
                     "M08 6.3: from tet to tet by Pluecker tests, beside the tree: means, media of "
                     "1 and of 100 optical depths. One thread, medians of CPU time, runs "
                     "interleaved",
                     HEADINGS);
    const leafcast_project before = job->view.scene.project;
    job->view.scene.project = LEAFCAST_PROJECT_MEAN; /* no isovalue is needed */
    const status st = bench_suite_each(job, names, brief, try_mesh);
    job->view.scene.project = before;
    return st;
}
