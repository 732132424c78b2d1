/* bench_race.h - the same pictures drawn by several contestants in turn, run after run, so that
 * what disturbs the machine disturbs all of them; medians, counters, and whether they drew the
 * same.
 */
#ifndef RENDER_BENCH_BENCH_RACE_H
#define RENDER_BENCH_BENCH_RACE_H

#include "formats/base/mem.h"
#include "formats/base/progress.h"
#include "formats/base/status.h"
#include "render/bench/bench_table.h"
#include "render/leafcast_experimental.h"

/* One contestant: an open volume with what to draw of it. */
typedef struct bench_racer {
    leafcast *volume;
    leafcast_scene scene;
    leafcast_scene_experiments experiments; /* that the scene may point at */
    leafcast_camera camera;
    bool wall; /* time by the wall clock; else CPU time where there is one thread */
    /* Results: */
    double *depth;         /* of every pixel */
    double *seconds;       /* of every run */
    double median, spread; /* seconds of a picture */
    leafcast_stats stats;  /* of the last */
    uint64_t hits;         /* pixels with a surface */
} bench_racer;

enum { BENCH_ISAS = 12 };

/* bench_race_isas() - the kernels that leafcast_open() accepts here, by name, "scalar" first and
 * "auto", what is chosen when nothing is said, last; with those of experiment E4 when asked for.
 * Returns how many. */
int bench_race_isas(const char *path, bool experiments, const char *names[BENCH_ISAS]);

/* bench_race_enter() - open the file for this contestant and select an isovalue. The standard view
 * at `distance`; scene and camera may be changed before the race. */
typedef struct bench_entry {
    const char *path, *isa;
    double isovalue;
    int threads;
    double distance;
    uint32_t size; /* pixels on a side */
} bench_entry;
CHECKED status bench_race_enter(const bench_entry *e, bench_racer *r);

/* bench_race_run() - one picture of each to bring in what it needs, then `runs` of each in turn;
 * with between(), unless NULL, after each of these. */
typedef status (*bench_between)(void *ctx, int racer, int run);
CHECKED status bench_race_run(mem *m, bench_racer *r, int count, int runs, const progress *p,
                              bench_between between, void *ctx);

/* bench_race_leave() - close and free; for racers that never entered, too. */
void bench_race_leave(mem *m, bench_racer *r, int count);

/* bench_race_differing() - pixels of two pictures of the same size whose distances differ in any
 * bit. */
uint64_t bench_race_differing(const bench_racer *a, const bench_racer *b);

/* bench_race_row() - the common end of racer i's row, of `count` that drew the same picture, the
 * first of them the yardstick: time, as a multiple of the first's and of the fastest's; counters,
 * nodes also as how many times fewer than the first's;
 * bytes; in how many pixels the picture differs from the first's. */
void bench_race_row(bench_table *t, const bench_racer *r, int count, int i);
#define BENCH_RACE_HEADINGS                                                                   \
    "ms|+-|Mray/s|x first|x best|nodes/ray|fewer|cells/ray|roots/ray|active MB|read MB|peak " \
    "MB|differ"

#endif
