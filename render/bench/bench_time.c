#include "render/bench/bench_time.h"

#include <math.h>
#include <string.h>

#include "formats/base/clock.h"
#include "formats/base/hash.h"
#include "render/bench/bench_race.h"

/* Columns, in the order of add_row():
 *   fps        pictures a second (of CPU time where there is one thread), each of a new step,
 * behind the first round; first: in that round; same: of each step once more; new/same: how many
 *              times as long
 *   hits       pixels with a surface, of all steps; loads: treelets loaded in the first round
 *   differ     pixels that differ from those of the step alone. In later rounds a picture that
 *              differs counts with all of its pixels */
const char bench_time_headings[] =
    "series|way|size|threads|steps|fps|+-|first fps|same fps|new/same|cpu ms|hits|first MB|loads|"
    "MB/step|resident MB|peak MB|differ";

static const double STANDARD = 2.2; /* distance of the view, in longest edges */

enum { WAYS = 2, FRAMES_MAX = 1000 };

/* How a series is drawn: what has schemas by both, what has none by single rays and by tiles. */
static const struct {
    const char *name;
    const char *isa;
    leafcast_schema schema;
} ways[2][WAYS] = {
    {{"single rays", "scalar", LEAFCAST_SCHEMA_AUTO}, {"tiles", NULL, LEAFCAST_SCHEMA_AUTO}},
    {{"1: trees", NULL, LEAFCAST_SCHEMA_TREES}, {"2: refit", NULL, LEAFCAST_SCHEMA_REFIT}}};

/* Of frames that show the series again and again; or, behind its first round, each step once more.
 */
typedef struct pace {
    double *time, *cpu; /* seconds, a frame; time: CPU time, too, where there is one thread */
    uint64_t first_bytes, later_bytes, first_loads;
} pace;

typedef struct heat {
    const bench_subject *of;
    bench_racer racers[WAYS];
    pace moving[WAYS], still[WAYS];
    int steps, frames;
    bool schemas;
    uint32_t field;
    uint64_t differ[WAYS];
    uint64_t hits[WAYS];
    uint64_t *want; /* a hash of every step's picture */
    double *alone;  /* the depths of a step alone */
    float *colours;
} heat;

static size_t pixels_of(const bench_racer *r) {
    return (size_t)r->camera.width * r->camera.height;
}

static size_t bytes_of(const bench_racer *r) {
    return pixels_of(r) * sizeof *r->depth;
}

static leafcast_image image_of(const heat *h, double *depth) {
    const size_t pixels = pixels_of(&h->racers[0]);
    return (leafcast_image){.size = sizeof(leafcast_image),
                            .r = h->colours,
                            .g = h->colours + pixels,
                            .b = h->colours + 2 * pixels,
                            .z = depth};
}

/* One frame of one way: the step is part of it. */
static status draw(const heat *h, bench_racer *r, uint32_t step, pace *p, int frame) {
    const leafcast_image image = image_of(h, r->depth);
    r->stats.size = sizeof r->stats;
    const double cpu = clock_cpu_seconds(), wall = clock_seconds();
    status st = (status)leafcast_select_set(r->volume, h->field, step);
    if (st == ST_OK)
        st =
            (status)leafcast_trace(r->volume, &r->scene, &r->camera, &image, &r->stats, NULL, NULL);
    p->cpu[frame] = clock_cpu_seconds() - cpu;
    p->time[frame] = r->stats.threads > 1 ? clock_seconds() - wall : p->cpu[frame];
    *(frame < h->steps ? &p->first_bytes : &p->later_bytes) += r->stats.bytes_read;
    p->first_loads += frame < h->steps ? r->stats.treelets_loaded : 0;
    return st;
}

/* The picture of a step alone: of the file that was made of it alone, else of the series, opened
 * for this step. */
static status draw_alone(const bench_job *job, const heat *h, uint32_t step) {
    const bench_subject *s = h->of;
    const leafcast_options options = {.size = sizeof options, .threads = job->threads};
    const leafcast_image image = image_of(h, h->alone);
    char path[PATH_MAX];
    leafcast *volume = NULL;
    if (s->name)
        bench_store_alone(s->path, step, path);
    status st = (status)leafcast_open(s->name ? path : s->path, &options, &volume);
    if (st == ST_OK)
        st = (status)leafcast_select(volume, s->view.surfaces, s->view.isos);
    if (st == ST_OK && !s->name)
        st = (status)leafcast_select_set(volume, h->field, step);
    if (st == ST_OK)
        st = (status)leafcast_trace(volume, &s->view.scene, &h->racers[0].camera, &image, NULL,
                                    NULL, NULL);
    leafcast_close(volume);
    return st;
}

static void judge(heat *h, int i, int frame) {
    const bench_racer *r = &h->racers[i];
    const uint64_t hash = hash_bytes(r->depth, bytes_of(r));
    if (frame >= h->steps) {
        h->differ[i] += hash != h->want[frame % h->steps] ? pixels_of(r) : 0;
        return;
    }
    for (size_t k = 0; k < pixels_of(r); k++) {
        h->differ[i] += memcmp(&h->alone[k], &r->depth[k], sizeof *r->depth) != 0;
        h->hits[i] += isfinite(r->depth[k]);
    }
}

/* The ways in turn, frame by frame. */
static status run(bench_job *job, heat *h) {
    status st = ST_OK;
    for (int frame = 0; frame < h->frames && st == ST_OK; frame++) {
        const uint32_t step = (uint32_t)(frame % h->steps);
        st = progress_step(job->progress, "drawing", (double)frame / h->frames);
        if (st == ST_OK && frame < h->steps) {
            st = draw_alone(job, h, step);
            h->want[step] = hash_bytes(h->alone, bytes_of(&h->racers[0]));
        }
        for (int i = 0; i < WAYS && st == ST_OK; i++) {
            st = draw(h, &h->racers[i], step, &h->moving[i], frame);
            if (st == ST_OK)
                judge(h, i, frame);
            /* The step stays. */
            if (st == ST_OK && frame >= h->steps)
                st = draw(h, &h->racers[i], step, &h->still[i], frame - h->steps);
        }
    }
    return st;
}

static status enter(bench_job *job, heat *h, uint32_t size) {
    const bench_subject *s = h->of;
    status st = ST_OK;
    for (int i = 0; i < WAYS && st == ST_OK; i++) {
        const leafcast_experiments e = {.size = sizeof e, .schema = ways[h->schemas][i].schema};
        const leafcast_options options = {.size = sizeof options,
                                          .threads = job->threads,
                                          .isa = ways[h->schemas][i].isa,
                                          .experiments = &e};
        bench_racer *r = &h->racers[i];
        r->scene = s->view.scene;
        st = (status)leafcast_open(s->path, &options, &r->volume);
        if (st == ST_OK)
            st = (status)leafcast_select(r->volume, s->view.surfaces, s->view.isos);
        if (st != ST_OK)
            return st;
        r->camera = leafcast_standard_view(r->volume, STANDARD, size, size);
        r->depth = mem_array(&job->m, pixels_of(r), sizeof *r->depth);
        st = r->depth ? ST_OK : ST_NOMEM;
    }
    return st;
}

/* What the file has: its steps, and whether they come in by schemas. */
static status look(heat *h) {
    const leafcast_options options = {.size = sizeof options, .threads = 1};
    leafcast *volume = NULL;
    status st = (status)leafcast_open(h->of->path, &options, &volume);
    if (st != ST_OK)
        return st;
    const leafcast_info info = leafcast_describe(volume);
    h->schemas = (info.abilities & LEAFCAST_ABILITY_PACKETS) != 0;
    h->steps = info.steps < FRAMES_MAX / 2 ? (int)info.steps : FRAMES_MAX / 2;
    st = view_options_field(&h->of->view, volume, &h->field);
    leafcast_close(volume);
    return info.steps >= 2 ? st
                           : status_describe(ST_UNSUPPORTED, "%s: no time series: it has one step",
                                             h->of->path);
}

static status prepare(bench_job *job, heat *h) {
    h->frames = h->steps * (job->runs + 1);
    h->frames = h->frames < FRAMES_MAX ? h->frames : FRAMES_MAX / h->steps * h->steps;
    const size_t pixels = pixels_of(&h->racers[0]);
    h->alone = mem_array(&job->m, pixels, sizeof *h->alone);
    h->want = mem_array(&job->m, (size_t)h->steps, sizeof *h->want);
    h->colours = mem_array(&job->m, 3 * pixels, sizeof *h->colours);
    bool failed = !h->alone || !h->want || !h->colours;
    for (int i = 0; i < WAYS; i++) {
        pace *const both[] = {&h->moving[i], &h->still[i]};
        for (int k = 0; k < 2; k++) {
            both[k]->time = mem_array(&job->m, (size_t)h->frames, sizeof(double));
            both[k]->cpu = mem_array(&job->m, (size_t)h->frames, sizeof(double));
            failed |= !both[k]->time || !both[k]->cpu;
        }
    }
    return failed ? ST_NOMEM : ST_OK;
}

static void leave(bench_job *job, heat *h) {
    bench_race_leave(&job->m, h->racers, WAYS);
    for (int i = 0; i < WAYS; i++) {
        mem_free(&job->m, h->moving[i].time);
        mem_free(&job->m, h->moving[i].cpu);
        mem_free(&job->m, h->still[i].time);
        mem_free(&job->m, h->still[i].cpu);
    }
    mem_free(&job->m, h->colours);
    mem_free(&job->m, h->want);
    mem_free(&job->m, h->alone);
}

static void add_row(bench_job *job, heat *h, int i) {
    bench_table *t = &job->table;
    const bench_racer *r = &h->racers[i];
    const leafcast_stats *stats = &r->stats;
    pace *p = &h->moving[i];
    const int later = h->frames - h->steps;
    double spread;
    const double first = bench_median(p->time, h->steps, NULL);
    const double again = bench_median(p->time + h->steps, later, &spread);
    const double same = bench_median(h->still[i].time, later, NULL);
    bench_table_add(t, "%s", h->of->label);
    bench_table_add(t, "%s", ways[h->schemas][i].name);
    bench_table_add(t, "%ux%u", r->camera.width, r->camera.height);
    bench_table_add(t, "%d", stats->threads);
    bench_table_add(t, "%d", h->steps);
    bench_table_add(t, "%.2f", 1.0 / again);
    bench_table_add(t, "%.2f", spread / (again * again));
    bench_table_add(t, "%.2f", 1.0 / first);
    bench_table_add(t, "%.2f", 1.0 / same);
    bench_table_add(t, "%.3f", again / same);
    bench_table_add(t, "%.2f", 1e3 * bench_median(p->cpu + h->steps, later, NULL));
    bench_table_add(t, "%llu", (unsigned long long)h->hits[i]);
    bench_table_add(t, "%.3f", 1e-6 * (double)p->first_bytes);
    bench_table_add(t, "%llu", (unsigned long long)p->first_loads);
    bench_table_add(t, "%.3f", 1e-6 * (double)p->later_bytes / later);
    bench_table_add(t, "%.3f", 1e-6 * (double)stats->bytes_resident);
    bench_table_add(t, "%.3f", 1e-6 * (double)stats->bytes_peak);
    bench_table_add(t, "%llu", (unsigned long long)h->differ[i]);
}

static status measure_at(bench_job *job, const bench_subject *s, uint32_t size) {
    heat h = {.of = s};
    status st = look(&h);
    if (st == ST_OK)
        st = enter(job, &h, size);
    if (st == ST_OK)
        st = prepare(job, &h);
    if (st == ST_OK)
        st = run(job, &h);
    for (int i = 0; i < WAYS && st == ST_OK; i++)
        add_row(job, &h, i);
    leave(job, &h);
    return st;
}

/* Half the size, then all of it. */
static status measure(bench_job *job, const bench_subject *s) {
    const uint32_t size = job->view.camera.width;
    status st = size > 1 ? measure_at(job, s, size / 2) : ST_OK;
    return st == ST_OK ? measure_at(job, s, size) : st;
}

status bench_time(bench_job *job) {
    static const char *const names[] = {"drop-128", "jets-128", "vortex-128", "fingers", "isabel",
                                        "ocean",    "fluid",    "ball-32",    NULL};
    static const char *const brief[] = {"drop-64", "jets-64", "vortex-64", "ball-12", NULL};
    bench_table_init(&job->table,
                     "M08 tables 5.3 to 5.6, W07 8.5: a new time step in every frame, and one that "
                     "stays; ways in turn, medians; of CPU time where there is one thread",
                     bench_time_headings);
    return bench_suite_each(job, names, brief, measure);
}
