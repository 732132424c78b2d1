#include "render/bench/bench_projections.h"

#include <string.h>

#include "formats/base/clock.h"
#include "render/app/view_camera.h"

static const char HEADINGS[] = "volume|draws|size|kernels|ms|+-|Mray/s|x surface|read|active|"
                               "read %|read MB|cells/ray|px|one by one ms|differ";

static const struct {
    const char *name;
    leafcast_project project;
} DRAWS[] = {{"surface", LEAFCAST_PROJECT_NONE},
             {"max", LEAFCAST_PROJECT_MAX},
             {"min", LEAFCAST_PROJECT_MIN},
             {"mean", LEAFCAST_PROJECT_MEAN},
             {"first", LEAFCAST_PROJECT_FIRST}};
enum { ROWS = sizeof DRAWS / sizeof *DRAWS };

typedef struct entrant {
    leafcast *volume;
    leafcast_scene scene;
    double *value, *place;
    double *seconds; /* of every run */
    double median, spread, alone;
    uint64_t differ;
    leafcast_stats stats;
} entrant;

typedef struct trial {
    mem *m;
    const bench_subject *subject;
    leafcast_camera camera;
    size_t pixels;
    double *value, *place; /* of single rays */
    entrant all[ROWS];
} trial;

static status draw(leafcast *volume, const trial *t, const leafcast_scene *scene, double *value,
                   double *place, double *seconds, leafcast_stats *stats) {
    const leafcast_image image = {.size = sizeof(leafcast_image), .value = value, .z = place};
    stats->size = sizeof *stats;
    const double start = clock_cpu_seconds();
    status st = (status)leafcast_trace(volume, scene, &t->camera, &image, stats, NULL, NULL);
    *seconds = clock_cpu_seconds() - start;
    return st;
}

static status open_volume(const bench_subject *s, const char *isa, leafcast **out) {
    const leafcast_options options = {.size = sizeof options, .threads = 1, .isa = isa};
    status st = (status)leafcast_open(s->path, &options, out);
    return st == ST_OK ? (status)leafcast_select(*out, s->view.surfaces, 1) : st;
}

/* Ray by ray: the scalar kernels know no others. */
static status compare(trial *t, entrant *e) {
    leafcast *volume = NULL;
    leafcast_stats stats;
    status st = open_volume(t->subject, "scalar", &volume);
    if (st == ST_OK)
        st = draw(volume, t, &e->scene, t->value, t->place, &e->alone, &stats);
    for (size_t i = 0; i < t->pixels && st == ST_OK; i++)
        e->differ += memcmp(&t->value[i], &e->value[i], sizeof(double)) != 0 ||
                     memcmp(&t->place[i], &e->place[i], sizeof(double)) != 0;
    leafcast_close(volume);
    return st;
}

static status race(bench_job *job, trial *t) {
    status st = ST_OK;
    for (int run = -1; run < job->runs && st == ST_OK; run++) { /* the first brings treelets in */
        st = progress_step(job->progress, "drawing", (run + 1.0) / (job->runs + 1.0));
        for (int i = 0; i < ROWS && st == ST_OK; i++) {
            entrant *e = &t->all[i];
            double seconds;
            st = draw(e->volume, t, &e->scene, e->value, e->place, &seconds, &e->stats);
            if (run >= 0)
                e->seconds[run] = seconds;
        }
    }
    for (int i = 0; i < ROWS && st == ST_OK; i++) {
        t->all[i].median = bench_median(t->all[i].seconds, job->runs, &t->all[i].spread);
        st = compare(t, &t->all[i]);
    }
    return st;
}

static void add_row(bench_table *table, const trial *t, int i) {
    const entrant *e = &t->all[i];
    const leafcast_stats *s = &e->stats;
    bench_table_add(table, "%s", t->subject->label);
    bench_table_add(table, "%s", DRAWS[i].name);
    bench_table_add(table, "%ux%u", t->camera.width, t->camera.height);
    bench_table_add(table, "%s", s->isa);
    bench_table_add(table, "%.2f", e->median * 1e3);
    bench_table_add(table, "%.2f", e->spread * 1e3);
    bench_table_add(table, "%.3f", (double)t->pixels * 1e-6 / e->median);
    bench_table_add(table, "%.3f", e->median / t->all[0].median);
    bench_table_add(table, "%llu", (unsigned long long)s->treelets_loaded);
    bench_table_add(table, "%llu", (unsigned long long)s->treelets_active);
    bench_table_add(table, "%.1f",
                    s->treelets_active > 0
                        ? 100.0 * (double)s->treelets_loaded / (double)s->treelets_active
                        : 0.0);
    bench_table_add(table, "%.3f", (double)s->bytes_read * 1e-6);
    bench_table_add(table, "%.3f", (double)s->cells / (double)s->rays);
    bench_table_add(table, "%llu", (unsigned long long)s->covered_pixels);
    bench_table_add(table, "%.2f", e->alone * 1e3);
    bench_table_add(table, "%llu", (unsigned long long)e->differ);
}

static status enter(bench_job *job, trial *t, int i) {
    entrant *e = &t->all[i];
    e->scene = t->subject->view.scene;
    e->scene.shading = LEAFCAST_SHADING_FLAT;
    e->scene.project = DRAWS[i].project;
    e->scene.project_value = t->subject->view.surfaces[0].isovalue;
    e->value = mem_array(t->m, t->pixels, sizeof(double));
    e->place = mem_array(t->m, t->pixels, sizeof(double));
    e->seconds = mem_array(t->m, (size_t)job->runs, sizeof(double));
    if (!e->value || !e->place || !e->seconds)
        return ST_NOMEM;
    return open_volume(t->subject, NULL, &e->volume);
}

static status look_at(trial *t) {
    leafcast *volume = NULL;
    status st = open_volume(t->subject, NULL, &volume);
    if (st != ST_OK)
        return st;
    t->camera = view_camera_of(&t->subject->view, volume);
    t->pixels = (size_t)t->camera.width * t->camera.height;
    t->value = mem_array(t->m, t->pixels, sizeof(double));
    t->place = mem_array(t->m, t->pixels, sizeof(double));
    leafcast_close(volume);
    return t->value && t->place ? ST_OK : ST_NOMEM;
}

static void leave(trial *t) {
    for (int i = 0; i < ROWS; i++) {
        leafcast_close(t->all[i].volume);
        mem_free(t->m, t->all[i].value);
        mem_free(t->m, t->all[i].place);
        mem_free(t->m, t->all[i].seconds);
    }
    mem_free(t->m, t->value);
    mem_free(t->m, t->place);
}

static status try_volume(bench_job *job, const bench_subject *s) {
    trial t = {.m = &job->m, .subject = s};
    status st = look_at(&t);
    for (int i = 0; i < ROWS && st == ST_OK; i++)
        st = enter(job, &t, i);
    if (st == ST_OK)
        st = race(job, &t);
    for (int i = 0; i < ROWS && st == ST_OK; i++)
        add_row(&job->table, &t, i);
    leave(&t);
    return st;
}

status bench_projections(bench_job *job) {
    static const char *const names[] = {"bonsai", "engine", "ch2better", "ml-256", NULL};
    static const char *const brief[] = {"ml-64", NULL};
    bench_table_init(&job->table,
                     "Projections beside the opaque isosurface of the same view: one thread, "
                     "medians of CPU time, runs interleaved",
                     HEADINGS);
    return bench_suite_each(job, names, brief, try_volume);
}
