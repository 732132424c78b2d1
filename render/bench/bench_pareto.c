#include "render/bench/bench_pareto.h"

#include <math.h>
#include <string.h>

#include "render/bench/bench_race.h"
#include "render/experiments/intersect.h"

enum { LEVELS = 3, SHRINKS = 3, CONTESTANTS = INTERSECTOR_COUNT * LEVELS * SHRINKS };

typedef struct contestant {
    const intersector *how;
    uint32_t level, shrink;
    double rms, worst; /* cells */
    uint64_t wrong;    /* pixels of the exact picture */
    bool front;
} contestant;

/* The exact one is the first. */
static int list(contestant all[CONTESTANTS], uint32_t levels) {
    int n = 0;
    for (uint32_t shrink = 1; shrink <= 1u << (SHRINKS - 1); shrink *= 2)
        for (uint32_t level = 0; level < LEVELS && level < levels; level++)
            for (int i = INTERSECTOR_COUNT; i-- > 0;)
                all[n++] = (contestant){.how = intersector_at(i), .level = level, .shrink = shrink};
    return n;
}

static status enter(const bench_subject *s, const contestant *c, bench_racer *r) {
    const bench_entry e = {s->path, "scalar", s->view.surfaces[0].isovalue,
                           1,       2.2,      s->view.camera.width / c->shrink};
    status st = bench_race_enter(&e, r);
    r->experiments =
        (leafcast_scene_experiments){.size = sizeof r->experiments, .intersector = c->how->id};
    r->scene.experiments = &r->experiments;
    r->scene.lod = c->level ? LEAFCAST_LOD_LEVEL : LEAFCAST_LOD_EXACT;
    r->scene.lod_level = c->level;
    return st;
}

static void judge(const bench_racer *exact, const bench_racer *r, double cell, contestant *c) {
    const uint32_t width = exact->camera.width, height = exact->camera.height;
    double sum = 0.0;
    uint64_t both = 0;
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++) {
            const uint32_t row = (uint32_t)((uint64_t)y * r->camera.height / height);
            const uint32_t column = (uint32_t)((uint64_t)x * r->camera.width / width);
            const double z = exact->depth[(size_t)y * width + x];
            const double seen = r->depth[(size_t)row * r->camera.width + column];
            if (isfinite(z) != isfinite(seen)) {
                c->wrong++;
            } else if (isfinite(z)) {
                const double off = fabs(seen - z) / cell;
                sum += off * off;
                c->worst = fmax(c->worst, off);
                both++;
            }
        }
    c->rms = both ? sqrt(sum / (double)both) : 0.0;
}

static bool beats(const bench_racer *r, const contestant *c, int a, int b) {
    const bool no_worse =
        r[a].median <= r[b].median && c[a].rms <= c[b].rms && c[a].wrong <= c[b].wrong;
    const bool better = r[a].median < r[b].median || c[a].rms < c[b].rms || c[a].wrong < c[b].wrong;
    return no_worse && better;
}

static void find_front(const bench_racer *r, contestant *c, int count) {
    for (int i = 0; i < count; i++) {
        c[i].front = true;
        for (int k = 0; k < count; k++)
            c[i].front &= !beats(r, c, k, i);
    }
}

static void add_row(bench_table *t, const bench_subject *s, const bench_racer *r,
                    const contestant *c, const bench_racer *exact) {
    const double rays = (double)r->stats.rays;
    const double pixels = (double)exact->camera.width * exact->camera.height;
    bench_table_add(t, "%s", s->label);
    bench_table_add(t, "%s", c->how->name);
    bench_table_add(t, "%u", c->level);
    bench_table_add(t, "%ux%u", r->camera.width, r->camera.height);
    bench_table_add(t, "%s", r->stats.isa);
    bench_table_add(t, "%.2f", r->median * 1e3);
    bench_table_add(t, "%.2f", r->spread * 1e3);
    bench_table_add(t, "%.3f", r->median / exact->median);
    bench_table_add(t, "%.3e", c->rms);
    bench_table_add(t, "%.3e", c->worst);
    bench_table_add(t, "%llu", (unsigned long long)c->wrong);
    bench_table_add(t, "%.3f", 100.0 * (double)c->wrong / pixels);
    bench_table_add(t, "%.3f", (double)r->stats.nodes / rays);
    bench_table_add(t, "%.3f", (double)r->stats.cells / rays);
    bench_table_add(t, "%.3f", (double)r->stats.bytes_active * 1e-6);
    bench_table_add(t, "%.3f", (double)r->stats.bytes_read * 1e-6);
    bench_table_add(t, "%.3f", (double)r->stats.bytes_peak * 1e-6);
    bench_table_add(t, "%s", c->front ? "front" : "-");
}

static status trade(bench_job *job, const bench_subject *s) {
    contestant contestants[CONTESTANTS];
    static bench_racer racers[CONTESTANTS]; /* large */
    memset(racers, 0, sizeof racers);
    leafcast_info info = {0};
    status st = enter(s, &(contestant){.how = intersector_named("marmitt"), .shrink = 1}, racers);
    if (st == ST_OK)
        info = leafcast_describe(racers[0].volume);
    bench_race_leave(&job->m, racers, 1);
    const int count = list(contestants, info.levels);
    for (int i = 0; i < count && st == ST_OK; i++)
        st = enter(s, &contestants[i], &racers[i]);
    if (st == ST_OK)
        st = bench_race_run(&job->m, racers, count, job->runs, job->progress, NULL, NULL);
    for (int i = 0; i < count && st == ST_OK; i++)
        judge(&racers[0], &racers[i], info.cell_size, &contestants[i]);
    if (st == ST_OK)
        find_front(racers, contestants, count);
    for (int i = 0; i < count && st == ST_OK; i++)
        add_row(&job->table, s, &racers[i], &contestants[i], &racers[0]);
    bench_race_leave(&job->m, racers, count);
    return st;
}

status bench_pareto(bench_job *job) {
    static const char *const names[] = {"bonsai", NULL}, *const brief[] = {"ml-64", NULL};
    bench_table_init(&job->table,
                     "Time against error: intersector x level of detail x pixels, against marmitt "
                     "at level 0; ray by ray, one thread, medians of CPU time, runs interleaved",
                     "volume|intersector|level|size|kernels|ms|+-|x exact|rms cells|worst cells|"
                     "wrong px|wrong %|nodes/ray|cells/ray|active MB|read MB|peak MB|front");
    bench_subject s;
    status st = bench_suite_subject(job, names, brief, 0, &s);
    return st == ST_OK ? trade(job, &s) : st;
}
