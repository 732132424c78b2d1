#include "render/bench/bench_threads.h"

#include <math.h>

#include "formats/base/clock.h"
#include "formats/base/pool.h"
#include "render/bench/bench_race.h"

enum { STEPS_MAX = 16, PIECES = 1024 };

/* ---- the loop ---- */

typedef struct compute {
    uint32_t turns; /* of every piece */
    double *sums;   /* one a piece: so that nothing is optimised away */
} compute;

/* Four chains of what the cell kernel is made of; no memory. */
static status compute_piece(void *ctx, size_t piece, int worker) {
    const compute *c = ctx;
    double x[4] = {0.1, 0.2, 0.3, 0.4 + 1e-9 * (double)piece};
    (void)worker;
    for (uint32_t turn = 0; turn < c->turns; turn++)
        for (int i = 0; i < 4; i++) {
            const double y = x[i] * x[i] + 0.25;
            x[i] = (y - 0.125 * x[i]) / (1.0 + y);
        }
    c->sums[piece] = x[0] + x[1] + x[2] + x[3];
    return ST_OK;
}

static status compute_all(pool *threads, compute *c, double *seconds) {
    const double start = clock_seconds();
    status st = pool_run(threads, PIECES, compute_piece, c);
    *seconds = clock_seconds() - start;
    return st;
}

/* As many turns as make the loop last a quarter of a second on one thread. */
static status calibrate(pool *one, compute *c) {
    static const double seconds = 0.25;
    double took = 0.0;
    c->turns = 64;
    status st = compute_all(one, c, &took);
    while (st == ST_OK && took < 0.02) {
        c->turns *= 2;
        st = compute_all(one, c, &took);
    }
    c->turns = (uint32_t)fmax(1.0, c->turns * seconds / took);
    return st;
}

/* ---- the race ---- */

typedef struct heat {
    int steps;
    int threads[STEPS_MAX];
    bench_racer racers[STEPS_MAX];
    pool *pools[STEPS_MAX];
    double *loop; /* seconds, [step][run] */
    int runs;
    compute work;
} heat;

static int list_threads(int most, int threads[STEPS_MAX]) {
    int n = 0;
    for (int t = 1; t < most && n < STEPS_MAX - 1; t = t < 4 ? t + 1 : t * 2)
        threads[n++] = t;
    threads[n++] = most;
    return n;
}

/* After a frame: the loop with as many threads. */
static status interlude(void *ctx, int racer, int run) {
    heat *h = ctx;
    return compute_all(h->pools[racer], &h->work, &h->loop[racer * h->runs + run]);
}

/* How much faster than with one thread, in the median over the runs: the frame, the loop, and the
 * frame over the loop. */
static void scaling(const heat *h, int step, double *scratch, double out[3], double *spread) {
    const double *one = h->racers[0].seconds, *frame = h->racers[step].seconds;
    const double *loop = h->loop + step * h->runs;
    for (int what = 0; what < 3; what++) {
        for (int run = 0; run < h->runs; run++) {
            const double f = one[run] / frame[run], l = h->loop[run] / loop[run];
            scratch[run] = what == 0 ? f : what == 1 ? l : f / l;
        }
        out[what] = bench_median(scratch, h->runs, spread);
    }
}

static void add_rows(bench_table *t, const bench_subject *s, const heat *h, double *scratch) {
    for (int i = 0; i < h->steps; i++) {
        const bench_racer *r = &h->racers[i];
        double gain[3], spread;
        scaling(h, i, scratch, gain, &spread);
        bench_table_add(t, "%s", s->label);
        bench_table_add(t, "%d", r->stats.threads);
        bench_table_add(t, "%s", r->stats.isa);
        bench_table_add(t, "%.2f", r->median * 1e3);
        bench_table_add(t, "%.2f", r->spread * 1e3);
        bench_table_add(t, "%.3f", gain[0]);
        bench_table_add(t, "%.3f", gain[1]);
        bench_table_add(t, "%.3f", gain[2]);
        bench_table_add(t, "%.3f", spread);
        bench_table_add(t, "%.3f", (double)r->stats.rays * 1e-6 / r->median);
        bench_table_add(t, "%.3f", (double)r->stats.nodes / (double)r->stats.rays);
        bench_table_add(t, "%.3f", (double)r->stats.cells / (double)r->stats.rays);
        bench_table_add(t, "%.3f", (double)r->stats.bytes_read * 1e-6);
        bench_table_add(t, "%.3f", (double)r->stats.bytes_peak * 1e-6);
        bench_table_add(t, "%llu", (unsigned long long)bench_race_differing(r, &h->racers[0]));
    }
}

static status set_up(bench_job *job, const bench_subject *s, heat *h) {
    h->steps = list_threads(job->threads, h->threads);
    h->runs = job->runs;
    h->loop = mem_array(&job->m, (size_t)h->steps * (size_t)h->runs, sizeof *h->loop);
    h->work.sums = mem_array(&job->m, PIECES, sizeof *h->work.sums);
    status st = h->loop && h->work.sums ? ST_OK : ST_NOMEM;
    for (int i = 0; i < h->steps && st == ST_OK; i++) {
        const bench_entry e = {s->path,       NULL, s->view.surfaces[0].isovalue,
                               h->threads[i], 2.2,  s->view.camera.width};
        st = bench_race_enter(&e, &h->racers[i]);
        h->racers[i].wall = true;
        if (st == ST_OK)
            st = pool_create(&job->m, h->threads[i], &h->pools[i]);
    }
    return st == ST_OK ? calibrate(h->pools[0], &h->work) : st;
}

static status scale(bench_job *job, const bench_subject *s) {
    static heat h; /* large */
    h = (heat){0};
    double *scratch = mem_array(&job->m, (size_t)job->runs, sizeof *scratch);
    status st = scratch ? set_up(job, s, &h) : ST_NOMEM;
    if (st == ST_OK)
        st = bench_race_run(&job->m, h.racers, h.steps, job->runs, job->progress, interlude, &h);
    if (st == ST_OK)
        add_rows(&job->table, s, &h, scratch);
    bench_race_leave(&job->m, h.racers, h.steps);
    for (int i = 0; i < h.steps; i++)
        pool_destroy(h.pools[i]);
    mem_free(&job->m, h.work.sums);
    mem_free(&job->m, h.loop);
    mem_free(&job->m, scratch);
    return st;
}

status bench_threads(bench_job *job) {
    static const char *const names[] = {"ml-256", "bonsai", NULL}, *const brief[] = {"ml-64", NULL};
    bench_table_init(&job->table,
                     "Threads: frames, and between them a loop that only computes; wall clock, "
                     "scaling is the median over the interleaved runs",
                     "volume|threads|isa|ms|+-|frame x|loop x|frame/loop|spread|Mray/s|nodes/ray|"
                     "cells/ray|read MB|peak MB|differ");
    return bench_suite_each(job, names, brief, scale);
}
