#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/clock.h"
#include "formats/base/mem.h"
#include "render/bench/bench_table.h"
#include "render/bench/experiment_filter.h"
#include "render/experiments/intersect_walk.h"
#include "render/experiments/walk_choices.h"

typedef struct ray_cell {
    ray r;
    cell_visit visit;
    float samples[8];
    double iso;
} ray_cell;

/* What record() writes to: one picture at a time, drawn by one thread. */
static struct {
    ray_cell *cells;
    uint32_t count, max;
} tape;

static bool record(const ray *r, const cell_visit *visit, const float samples[8], double iso,
                   int32_t iso_index, uint64_t cell, const hit *after, hit *found) {
    if (tape.count < tape.max) {
        ray_cell *c = &tape.cells[tape.count++];
        c->r = *r;
        c->visit = *visit;
        memcpy(c->samples, samples, sizeof c->samples);
        c->iso = iso;
    }
    return cell_next_hit(r, visit, samples, iso, iso_index, cell, after, found);
}

static bool walk_and_record(const walk_scene *scene, const resident_grid *tr, const ray *r,
                            double t_in, double t_out, unsigned octants, const hit *after,
                            hit *best, ray_counters *counters) {
    return intersect_walk(record, scene, tr, r, t_in, t_out, octants, after, best, counters);
}

/* (1 - s) a + s b in float: 2 roundings a product, 1 for the sum, 1 for s and 1 - s each; at most 4
 * u max(|a|, |b|) away from the exact value, u = 2^-24, on top of the errors of a and b, which it
 * does not enlarge. */
static inline float mixf(float a, float b, float s) {
    return (1.0f - s) * a + s * b;
}

/* True: certainly no change of side in this cell. Differences to iso round once (u M, M the
 * largest); three mixes add 12 u M, the mean of three values 3 u M more: control values are within
 * 16 u M. All of them beyond that on one side leave no root. */
static bool certainly_empty(const cell_visit *visit, const float samples[8], double iso) {
    float f[8], largest = 0.0f;
    for (int i = 0; i < 8; i++) {
        f[i] = (float)((double)samples[i] - iso);
        largest = fmaxf(largest, fabsf(f[i]));
    }
    float x[2][4], xy[4][2], m[8];
    const float in[3] = {(float)visit->in[0], (float)visit->in[1], (float)visit->in[2]};
    const float out[3] = {(float)visit->out[0], (float)visit->out[1], (float)visit->out[2]};
    for (int i = 0; i < 4; i++) {
        x[0][i] = mixf(f[2 * i], f[2 * i + 1], in[0]);
        x[1][i] = mixf(f[2 * i], f[2 * i + 1], out[0]);
    }
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 2; k++) {
            xy[i][k] = mixf(x[i][2 * k], x[i][2 * k + 1], in[1]);
            xy[i + 2][k] = mixf(x[i][2 * k], x[i][2 * k + 1], out[1]);
        }
    for (int i = 0; i < 4; i++) {
        m[i] = mixf(xy[i][0], xy[i][1], in[2]);
        m[i + 4] = mixf(xy[i][0], xy[i][1], out[2]);
    }
    const float b[4] = {m[0], (m[1] + m[2] + m[4]) / 3.0f, (m[3] + m[5] + m[6]) / 3.0f, m[7]};
    const float bound = 0x1p-20f * largest;
    return (b[0] > bound && b[1] > bound && b[2] > bound && b[3] > bound) ||
           (b[0] < -bound && b[1] < -bound && b[2] < -bound && b[3] < -bound);
}

static bool exact_hit(const ray_cell *c) {
    const hit after = hit_before_all();
    hit found;
    return cell_next_hit(&c->r, &c->visit, c->samples, c->iso, 0, 0, &after, &found);
}

static uint64_t run_double(void) {
    uint64_t hits = 0;
    for (uint32_t i = 0; i < tape.count; i++)
        hits += exact_hit(&tape.cells[i]);
    return hits;
}

static uint64_t run_filtered(void) {
    uint64_t hits = 0;
    for (uint32_t i = 0; i < tape.count; i++) {
        const ray_cell *c = &tape.cells[i];
        hits += !certainly_empty(&c->visit, c->samples, c->iso) && exact_hit(c);
    }
    return hits;
}

static void measure(experiment_filter_result *result) {
    enum { RUNS = 9 };
    double doubles[RUNS], filtered[RUNS];
    volatile uint64_t sink = 0; /* so that the runs are not optimised away */
    for (int run = 0; run < RUNS; run++) {
        const double start = clock_cpu_seconds();
        sink += run_double();
        const double between = clock_cpu_seconds();
        sink += run_filtered();
        doubles[run] = between - start;
        filtered[run] = clock_cpu_seconds() - between;
    }
    (void)sink;
    const double sixteens = 1e-9 * tape.count / 16.0; /* seconds become nanoseconds */
    result->ns_double = tape.count ? bench_median(doubles, RUNS, NULL) / sixteens : 0.0;
    result->ns_filtered = tape.count ? bench_median(filtered, RUNS, NULL) / sixteens : 0.0;
    result->ray_cells = tape.count;
    for (uint32_t i = 0; i < tape.count; i++) {
        const ray_cell *c = &tape.cells[i];
        const bool surface = exact_hit(c), empty = certainly_empty(&c->visit, c->samples, c->iso);
        result->surfaces += surface;
        result->fallbacks += !empty;
        result->disagreements += surface && empty;
    }
}

leafcast_status experiment_filter(leafcast *volume, const leafcast_scene *scene,
                                  const leafcast_camera *camera, uint32_t max,
                                  experiment_filter_result *result) {
    mem m;
    mem_init(&m, 0);
    *result = (experiment_filter_result){0};
    tape.count = 0;
    tape.max = max;
    tape.cells = mem_array(&m, max, sizeof *tape.cells);
    if (!tape.cells)
        return LEAFCAST_NOMEM;
    const leafcast_image nothing = {.size = sizeof(leafcast_image)};
    static const walk_choice recording = {"recording", walk_and_record, 0, false};
    const walk_choice *before = walk_choice_use(volume, &recording);
    leafcast_status st = leafcast_trace(volume, scene, camera, &nothing, NULL, NULL, NULL);
    walk_choice_use(volume, before);
    if (st == LEAFCAST_OK)
        measure(result);
    mem_free(&m, tape.cells);
    return st;
}
