#include "render/bench/bench_race.h"

#include <math.h>
#include <string.h>

#include "formats/base/clock.h"

int bench_race_isas(const char *path, bool experiments, const char *names[BENCH_ISAS]) {
    static const struct {
        const char *name;
        bool experiment;
    } known[] = {{"scalar", false},       {"sse42", false},
                 {"avx2", false},         {"avx512", false},
                 {"packets-4x4", true},   {"packets-8x8", true},
                 {"packets-16x16", true}, {"packets-4x4-by-cell", true},
                 {"tiles-by-cell", true}, {"auto", false}};
    int count = 0;
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        const leafcast_options options = {
            .size = sizeof(leafcast_options), .threads = 1, .isa = known[i].name};
        leafcast *volume = NULL;
        if (known[i].experiment && !experiments)
            continue;
        if (leafcast_open(path, &options, &volume) == LEAFCAST_OK)
            names[count++] = known[i].name;
        leafcast_close(volume);
    }
    return count;
}

status bench_race_enter(const bench_entry *e, bench_racer *r) {
    const leafcast_options options = {
        .size = sizeof(leafcast_options), .threads = e->threads, .isa = e->isa};
    const leafcast_surface surface = leafcast_surface_default(e->isovalue);
    *r = (bench_racer){.scene = leafcast_scene_default()};
    status st = (status)leafcast_open(e->path, &options, &r->volume);
    if (st == ST_OK)
        st = (status)leafcast_select(r->volume, &surface, 1);
    if (st == ST_OK)
        r->camera = leafcast_standard_view(r->volume, e->distance, e->size, e->size);
    return st;
}

static size_t pixels_of(const bench_racer *r) {
    return (size_t)r->camera.width * r->camera.height;
}

/* Colours are drawn and thrown away, over each other. */
static status draw(bench_racer *r, float *colours, double *seconds) {
    const size_t pixels = pixels_of(r);
    const leafcast_image image = {.size = sizeof(leafcast_image),
                                  .r = colours,
                                  .g = colours + pixels,
                                  .b = colours + 2 * pixels,
                                  .z = r->depth};
    r->stats.size = sizeof r->stats;
    const double cpu = clock_cpu_seconds(), wall = clock_seconds();
    status st =
        (status)leafcast_trace(r->volume, &r->scene, &r->camera, &image, &r->stats, NULL, NULL);
    const bool by_wall = r->wall || r->stats.threads > 1;
    *seconds = by_wall ? clock_seconds() - wall : clock_cpu_seconds() - cpu;
    return st;
}

static status prepare(mem *m, bench_racer *r, int count, int runs, float **colours,
                      double **sorted) {
    size_t most = 0;
    for (int i = 0; i < count; i++) {
        const size_t pixels = pixels_of(&r[i]);
        r[i].depth = mem_array(m, pixels, sizeof *r[i].depth);
        r[i].seconds = mem_array(m, (size_t)runs, sizeof *r[i].seconds);
        if (!r[i].depth || !r[i].seconds)
            return ST_NOMEM;
        most = pixels > most ? pixels : most;
    }
    *colours = mem_array(m, 3 * most, sizeof **colours);
    *sorted = mem_array(m, (size_t)runs, sizeof **sorted);
    return *colours && *sorted ? ST_OK : ST_NOMEM;
}

static void conclude(bench_racer *r, int runs, double *sorted) {
    memcpy(sorted, r->seconds, (size_t)runs * sizeof *sorted);
    r->median = bench_median(sorted, runs, &r->spread);
    for (size_t at = 0; at < pixels_of(r); at++)
        r->hits += isfinite(r->depth[at]);
}

status bench_race_run(mem *m, bench_racer *r, int count, int runs, const progress *p,
                      bench_between between, void *ctx) {
    float *colours = NULL;
    double *sorted = NULL, ignored;
    status st = prepare(m, r, count, runs, &colours, &sorted);
    for (int i = 0; i < count && st == ST_OK; i++)
        st = draw(&r[i], colours, &ignored);
    for (int run = 0; run < runs && st == ST_OK; run++) {
        st = progress_step(p, "drawing", (double)run / runs);
        for (int i = 0; i < count && st == ST_OK; i++) {
            st = draw(&r[i], colours, &r[i].seconds[run]);
            if (st == ST_OK && between)
                st = between(ctx, i, run);
        }
    }
    for (int i = 0; i < count && st == ST_OK; i++)
        conclude(&r[i], runs, sorted);
    mem_free(m, sorted);
    mem_free(m, colours);
    return st;
}

void bench_race_leave(mem *m, bench_racer *r, int count) {
    for (int i = 0; i < count; i++) {
        leafcast_close(r[i].volume);
        mem_free(m, r[i].seconds);
        mem_free(m, r[i].depth);
        r[i] = (bench_racer){0};
    }
}

uint64_t bench_race_differing(const bench_racer *a, const bench_racer *b) {
    uint64_t count = 0;
    for (size_t i = 0; i < pixels_of(a); i++)
        count += memcmp(&a->depth[i], &b->depth[i], sizeof *a->depth) != 0;
    return count;
}

void bench_race_row(bench_table *t, const bench_racer *all, int count, int i) {
    const bench_racer *r = &all[i];
    const double rays = (double)r->stats.rays;
    double best = all[0].median;
    for (int k = 1; k < count; k++)
        best = fmin(best, all[k].median);
    bench_table_add(t, "%.2f", r->median * 1e3);
    bench_table_add(t, "%.2f", r->spread * 1e3);
    bench_table_add(t, "%.3f", rays * 1e-6 / r->median);
    bench_table_add(t, "%.3f", r->median / all[0].median);
    bench_table_add(t, "%.3f", r->median / best);
    bench_table_add(t, "%.3f", (double)r->stats.nodes / rays);
    bench_table_add(t, "%.2f", (double)all[0].stats.nodes / fmax(1.0, (double)r->stats.nodes));
    bench_table_add(t, "%.3f", (double)r->stats.cells / rays);
    bench_table_add(t, "%.3f", (double)r->stats.roots / rays);
    bench_table_add(t, "%.3f", (double)r->stats.bytes_active * 1e-6);
    bench_table_add(t, "%.3f", (double)r->stats.bytes_read * 1e-6);
    bench_table_add(t, "%.3f", (double)r->stats.bytes_peak * 1e-6);
    bench_table_add(t, "%llu", (unsigned long long)bench_race_differing(r, &all[0]));
}
