#include "render/bench/bench_time.h"

#include <math.h>
#include <string.h>

#include "formats/base/clock.h"
#include "render/bench/bench_race.h"

const char bench_time_headings[] =
    "mesh|schema|threads|steps|fps|+-|first fps|same fps|cpu ms|first MB|MB/step|"
    "resident MB|peak MB|differ";

static const double STANDARD = 2.2; /* distance of the view, in longest edges */

enum { SCHEMAS = 2, FRAMES_MAX = 1000 };
static const char *const schema_names[SCHEMAS] = {"1: trees", "2: refit"};

/* Which step a frame shows: the series `rounds` times; or step 0 again and again. */
typedef struct pace {
    double *wall, *cpu; /* seconds, a frame */
    uint64_t first_bytes, later_bytes;
} pace;

typedef struct heat {
    bench_racer racers[SCHEMAS];
    pace moving[SCHEMAS], still[SCHEMAS];
    int steps, frames;
    uint32_t field;
    uint64_t differ[SCHEMAS]; /* pixels, from schema 1's pictures */
    double *yardstick;        /* a depth picture */
    float *colours;
} heat;

static size_t pixels_of(const bench_racer *r) {
    return (size_t)r->camera.width * r->camera.height;
}

/* One frame of one schema: the step is part of it. */
static status draw(const heat *h, bench_racer *r, uint32_t step, pace *p, int frame) {
    const size_t pixels = pixels_of(r);
    const leafcast_image image = {.size = sizeof(leafcast_image),
                                  .r = h->colours,
                                  .g = h->colours + pixels,
                                  .b = h->colours + 2 * pixels,
                                  .z = r->depth};
    r->stats.size = sizeof r->stats;
    const double cpu = clock_cpu_seconds(), wall = clock_seconds();
    status st = (status)leafcast_select_set(r->volume, h->field, step);
    if (st == ST_OK)
        st =
            (status)leafcast_trace(r->volume, &r->scene, &r->camera, &image, &r->stats, NULL, NULL);
    p->wall[frame] = clock_seconds() - wall;
    p->cpu[frame] = clock_cpu_seconds() - cpu;
    *(frame < h->steps ? &p->first_bytes : &p->later_bytes) += r->stats.bytes_read;
    return st;
}

/* The schemas in turn, frame by frame. */
static status run(bench_job *job, heat *h) {
    status st = ST_OK;
    for (int frame = 0; frame < h->frames && st == ST_OK; frame++) {
        st = progress_step(job->progress, "drawing", (double)frame / h->frames);
        for (int i = 0; i < SCHEMAS && st == ST_OK; i++) {
            bench_racer *r = &h->racers[i];
            const size_t bytes = pixels_of(r) * sizeof *r->depth;
            st = draw(h, r, (uint32_t)(frame % h->steps), &h->moving[i], frame);
            if (i == 0)
                memcpy(h->yardstick, r->depth, bytes);
            for (size_t k = 0; k < pixels_of(r); k++)
                h->differ[i] += memcmp(&h->yardstick[k], &r->depth[k], sizeof *r->depth) != 0;
        }
    }
    /* The last step stays. */
    for (int frame = 0; frame < job->runs && st == ST_OK; frame++)
        for (int i = 0; i < SCHEMAS && st == ST_OK; i++)
            st = draw(h, &h->racers[i], (uint32_t)(h->steps - 1), &h->still[i], frame);
    return st;
}

static status enter(bench_job *job, const bench_subject *s, heat *h) {
    status st = ST_OK;
    for (int i = 0; i < SCHEMAS && st == ST_OK; i++) {
        const leafcast_experiments e = {.size = sizeof e,
                                        .schema = (leafcast_schema)(LEAFCAST_SCHEMA_TREES + i)};
        const leafcast_options options = {
            .size = sizeof options, .threads = job->threads, .experiments = &e};
        const uint32_t size = job->view.camera.width;
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

static status prepare(bench_job *job, const bench_subject *s, heat *h) {
    const leafcast_info info = leafcast_describe(h->racers[0].volume);
    if (info.steps < 2)
        return status_describe(ST_UNSUPPORTED, "%s: no time series: it has one step", s->path);
    h->steps = info.steps < FRAMES_MAX / 2 ? (int)info.steps : FRAMES_MAX / 2;
    h->frames = h->steps * (job->runs + 1);
    h->frames = h->frames < FRAMES_MAX ? h->frames : FRAMES_MAX / h->steps * h->steps;
    const size_t pixels = pixels_of(&h->racers[0]);
    h->yardstick = mem_array(&job->m, pixels, sizeof *h->yardstick);
    h->colours = mem_array(&job->m, 3 * pixels, sizeof *h->colours);
    bool failed = !h->yardstick || !h->colours;
    for (int i = 0; i < SCHEMAS; i++) {
        pace *const both[] = {&h->moving[i], &h->still[i]};
        for (int k = 0; k < 2; k++) {
            const size_t count = (size_t)(h->frames > job->runs ? h->frames : job->runs);
            both[k]->wall = mem_array(&job->m, count, sizeof(double));
            both[k]->cpu = mem_array(&job->m, count, sizeof(double));
            failed |= !both[k]->wall || !both[k]->cpu;
        }
    }
    return failed ? ST_NOMEM : view_options_field(&s->view, h->racers[0].volume, &h->field);
}

static void leave(bench_job *job, heat *h) {
    bench_race_leave(&job->m, h->racers, SCHEMAS);
    for (int i = 0; i < SCHEMAS; i++) {
        mem_free(&job->m, h->moving[i].wall);
        mem_free(&job->m, h->moving[i].cpu);
        mem_free(&job->m, h->still[i].wall);
        mem_free(&job->m, h->still[i].cpu);
    }
    mem_free(&job->m, h->colours);
    mem_free(&job->m, h->yardstick);
}

static void add_row(bench_job *job, const char *label, heat *h, int i) {
    bench_table *t = &job->table;
    const leafcast_stats *stats = &h->racers[i].stats;
    pace *p = &h->moving[i];
    const int later = h->frames - h->steps;
    double spread;
    const double first = bench_median(p->wall, h->steps, NULL);
    const double again = bench_median(p->wall + h->steps, later, &spread);
    const double cpu = bench_median(p->cpu + h->steps, later, NULL);
    bench_table_add(t, "%s", label);
    bench_table_add(t, "%s", schema_names[i]);
    bench_table_add(t, "%d", stats->threads);
    bench_table_add(t, "%d", h->steps);
    bench_table_add(t, "%.2f", 1.0 / again);
    bench_table_add(t, "%.2f", spread / (again * again));
    bench_table_add(t, "%.2f", 1.0 / first);
    bench_table_add(t, "%.2f", 1.0 / bench_median(h->still[i].wall, job->runs, NULL));
    bench_table_add(t, "%.2f", 1e3 * cpu);
    bench_table_add(t, "%.3f", 1e-6 * (double)p->first_bytes);
    bench_table_add(t, "%.3f", 1e-6 * (double)p->later_bytes / later);
    bench_table_add(t, "%.3f", 1e-6 * (double)stats->bytes_resident);
    bench_table_add(t, "%.3f", 1e-6 * (double)stats->bytes_peak);
    bench_table_add(t, "%llu", (unsigned long long)h->differ[i]);
}

static status measure(bench_job *job, const bench_subject *s) {
    heat h = {0};
    status st = enter(job, s, &h);
    if (st == ST_OK)
        st = prepare(job, s, &h);
    if (st == ST_OK)
        st = run(job, &h);
    for (int i = 0; i < SCHEMAS && st == ST_OK; i++)
        add_row(job, s->label, &h, i);
    leave(job, &h);
    return st;
}

status bench_time(bench_job *job) {
    bench_subject s;
    bench_table_init(&job->table,
                     "W07 8.5: a new time step in every frame, by both schemas in turn; medians of "
                     "the rounds behind the first",
                     bench_time_headings);
    if (!job->target)
        return status_describe(ST_USAGE, "bench time: of which mesh? F.leaf with time steps");
    status st = bench_suite_subject(job, NULL, NULL, 0, &s);
    return st == ST_OK ? measure(job, &s) : st;
}
