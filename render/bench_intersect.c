#include "render/bench_intersect.h"

#include <math.h>
#include <string.h>

#include "formats/base/clock.h"
#include "render/experiment.h"
#include "render/intersect.h"

const char bench_intersect_headings[] =
    "field|intersector|ray-cells|surfaces|missed|missed %|false|"
    "false %|rms cells|worst cells|ns/ray-cell|+-|x marmitt";

/* ---- ray-cells ---- */

/* What record() writes to: experiments draw one picture at a time. */
static bench_ray_cells *tape;

static bool record(const ray *r, const cell_visit *visit, const float samples[8], double iso,
                   int32_t iso_index, uint64_t cell, const hit *after, hit *found) {
    if (tape->count < tape->max) {
        bench_ray_cell *c = &tape->cells[tape->count++];
        c->r = *r;
        c->visit = *visit;
        memcpy(c->samples, samples, sizeof c->samples);
        c->iso = iso;
    }
    return cell_next_hit(r, visit, samples, iso, iso_index, cell, after, found);
}

status bench_ray_cells_record(mem *m, leafcast *volume, const leafcast_scene *scene,
                              const leafcast_camera *camera, uint32_t max, bench_ray_cells *out) {
    const leafcast_image nothing = {0};
    *out = (bench_ray_cells){mem_array(m, max, sizeof *out->cells), 0, max};
    if (!out->cells)
        return ST_NOMEM;
    tape = out;
    experiment_intersect(volume, record);
    status st = (status)leafcast_trace(volume, scene, camera, &nothing, NULL, NULL, NULL);
    experiment_intersect(volume, NULL);
    tape = NULL;
    return st;
}

/* splitmix64: the same numbers everywhere. */
static double random_unit(uint64_t *state) {
    uint64_t x = *state += 0x9e3779b97f4a7c15u;
    x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
    x = (x ^ x >> 27) * 0x94d049bb133111ebu;
    return (double)((x ^ x >> 31) >> 11) * 0x1p-53;
}

enum { SIDE = 41 };

static double marschner_lobb(const int node[3]) {
    static const double PI = 3.14159265358979323846;
    double x[3];
    for (int a = 0; a < 3; a++)
        x[a] = 2.0 * node[a] / (SIDE - 1) - 1.0;
    const double radius = sqrt(x[0] * x[0] + x[1] * x[1]);
    const double wave = cos(12.0 * PI * cos(0.5 * PI * radius)); /* f = 6 */
    return (1.0 - sin(0.5 * PI * x[2]) + 0.25 * (1.0 + wave)) / 2.5;
}

static void fill_field(bool noise, float *samples) {
    uint64_t seed = 1;
    for (int k = 0; k < SIDE; k++)
        for (int j = 0; j < SIDE; j++)
            for (int i = 0; i < SIDE; i++)
                *samples++ = noise ? (float)(int)(256.0 * random_unit(&seed))
                                   : (float)marschner_lobb((const int[3]){i, j, k});
}

/* The ray from the eye through a random point of a cell, and its visit. */
static bool aim(uint64_t *seed, const int cell[3], bench_ray_cell *c) {
    static const double eye[3] = {80.8, 56.5, 68.7}; /* about 2.2 edges from the centre */
    cell_box box;
    c->r = (ray){.t0 = 0.0, .t1 = INFINITY};
    for (int a = 0; a < 3; a++) {
        box.lo[a] = cell[a];
        box.hi[a] = cell[a] + 1;
        box.inv[a] = 1.0;
        box.last[a] = cell[a] == SIDE - 2;
        c->r.o[a] = eye[a];
        c->r.d[a] = cell[a] + random_unit(seed) - eye[a];
    }
    return cell_visit_of(&c->r, &box, &c->visit);
}

static bool gather(const float *samples, const int cell[3], double iso, float out[8]) {
    int inside = 0;
    for (int i = 0; i < 8; i++) {
        const int x = cell[0] + (i & 1), y = cell[1] + (i >> 1 & 1), z = cell[2] + (i >> 2);
        out[i] = samples[x + SIDE * (y + SIDE * z)];
        inside += (double)out[i] >= iso;
    }
    return inside > 0 && inside < 8;
}

status bench_ray_cells_make(mem *m, const char *field, uint32_t max, bench_ray_cells *out) {
    const bool noise = strcmp(field, "noise") == 0;
    *out = (bench_ray_cells){0};
    if (!noise && strcmp(field, "marschner-lobb") != 0)
        return status_describe(ST_USAGE, "no built-in field \"%s\": marschner-lobb, noise", field);
    float *samples = mem_array(m, (size_t)SIDE * SIDE * SIDE, sizeof *samples);
    out->cells = mem_array(m, max, sizeof *out->cells);
    out->max = max;
    if (samples && out->cells) {
        fill_field(noise, samples);
        uint64_t seed = 2;
        while (out->count < max) {
            bench_ray_cell *c = &out->cells[out->count];
            int cell[3];
            for (int a = 0; a < 3; a++)
                cell[a] = (int)((SIDE - 1) * random_unit(&seed));
            c->iso = noise ? 127.5 : 0.5;
            out->count += gather(samples, cell, c->iso, c->samples) && aim(&seed, cell, c);
        }
    }
    mem_free(m, samples);
    return out->cells && samples ? ST_OK : ST_NOMEM;
}

/* ---- the truth ---- */

static long double value(const long double c[4], long double s) {
    return c[0] + s * (c[1] + s * (c[2] + s * c[3]));
}

/* The trilinear form along the visit as a polynomial in s, by multiplying its eight terms out. */
static void expand(const bench_ray_cell *cell, long double c[4]) {
    c[0] = c[1] = c[2] = c[3] = 0.0L;
    for (int i = 0; i < 8; i++) {
        long double term[4] = {(long double)cell->samples[i] - (long double)cell->iso, 0, 0, 0};
        for (int a = 0; a < 3; a++) {
            long double base = cell->visit.in[a], rate = (long double)cell->visit.out[a] - base;
            if (!(i >> a & 1)) {
                base = 1.0L - base;
                rate = -rate;
            }
            for (int k = 3; k > 0; k--)
                term[k] = term[k] * base + term[k - 1] * rate;
            term[0] *= base;
        }
        for (int k = 0; k < 4; k++)
            c[k] += term[k];
    }
}

static int extrema(const long double c[4], long double at[2]) {
    const long double a = 3 * c[3], half = c[2], disc = half * half - a * c[1];
    if (!(disc >= 0))
        return 0;
    const long double w = -(half + (half >= 0 ? sqrtl(disc) : -sqrtl(disc)));
    long double s[2] = {a != 0 ? w / a : -1, w != 0 ? c[1] / w : -1};
    if (s[1] < s[0]) {
        const long double swap = s[0];
        s[0] = s[1];
        s[1] = swap;
    }
    int n = 0;
    for (int i = 0; i < 2; i++)
        if (s[i] > 0 && s[i] < 1)
            at[n++] = s[i];
    return n;
}

static long double bisect(const long double c[4], long double lo, long double hi, bool inside_lo) {
    for (int step = 0; step < 80; step++) {
        const long double middle = 0.5L * (lo + hi);
        if ((value(c, middle) >= 0) == inside_lo)
            lo = middle;
        else
            hi = middle;
    }
    return hi;
}

/* The first change of side in (0, 1], or -1. *grazing: a change of the samples' last digits could
 * add or remove it, so that nobody is blamed. */
static long double first_root(const bench_ray_cell *cell, bool *grazing) {
    long double c[4], at[2], from = 0, largest = 0;
    expand(cell, c);
    const int n = extrema(c, at);
    bool inside = c[0] >= 0;
    *grazing = false;
    for (int i = 0; i < 8; i++)
        largest = fmaxl(largest, fabsl((long double)cell->samples[i] - (long double)cell->iso));
    for (int i = 0; i <= n; i++) {
        const long double to = i < n ? at[i] : 1.0L, f = value(c, to);
        *grazing |= fabsl(f) < 1e-13L * largest || (i == 0 && fabsl(c[0]) < 1e-13L * largest);
        if ((f >= 0) != inside)
            return bisect(c, from, to, inside);
        from = to;
    }
    return -1;
}

/* ---- the race ---- */

typedef struct tally {
    uint64_t judged, surfaces, missed, made_up;
    double sum_squares, worst;
} tally;

static bool ask(const intersector *x, const bench_ray_cell *c, hit *found) {
    const hit start = hit_before_all();
    return x->next_hit(&c->r, &c->visit, c->samples, c->iso, 0, 0, &start, found);
}

/* truth[i]: t of the surface, NAN for none, INFINITY for a grazing ray-cell, which is not judged.
 */
static void judge(const intersector *x, const bench_ray_cells *c, const double *truth, tally *sum) {
    for (uint32_t i = 0; i < c->count; i++) {
        const bench_ray_cell *cell = &c->cells[i];
        const cell_visit *v = &cell->visit;
        if (isinf(truth[i]))
            continue;
        hit found;
        const bool there = !isnan(truth[i]), seen = ask(x, cell, &found);
        sum->judged++;
        sum->surfaces += there;
        sum->missed += there && !seen;
        sum->made_up += seen && !there;
        if (!there || !seen || !(v->t_out > v->t_in))
            continue;
        double length = 0.0;
        for (int a = 0; a < 3; a++)
            length += (v->out[a] - v->in[a]) * (v->out[a] - v->in[a]);
        const double off = fabs(found.t - truth[i]) * sqrt(length) / (v->t_out - v->t_in);
        sum->sum_squares += off * off;
        sum->worst = fmax(sum->worst, off);
    }
}

static double time_one(const intersector *x, const bench_ray_cells *c) {
    uint64_t hits = 0;
    hit found;
    const double start = clock_cpu_seconds();
    for (uint32_t i = 0; i < c->count; i++)
        hits += ask(x, &c->cells[i], &found);
    const volatile uint64_t sink = hits; /* so that the loop is not optimised away */
    (void)sink;
    return (clock_cpu_seconds() - start) * 1e9 / c->count;
}

static void find_truth(const bench_ray_cells *c, double *truth) {
    for (uint32_t i = 0; i < c->count; i++) {
        const cell_visit *v = &c->cells[i].visit;
        bool grazing;
        const long double s = first_root(&c->cells[i], &grazing);
        const long double t = v->t_in + s * ((long double)v->t_out - (long double)v->t_in);
        truth[i] = grazing ? (double)INFINITY : s < 0 ? (double)NAN : (double)t;
    }
}

static double percent(uint64_t part, uint64_t whole) {
    return whole ? 100.0 * (double)part / (double)whole : 0.0;
}

status bench_intersect(mem *m, const char *name, const bench_ray_cells *c, int runs,
                       bench_table *t) {
    double *truth = mem_array(m, c->count ? c->count : 1, sizeof *truth);
    double *times = mem_array(m, (size_t)runs * INTERSECTOR_COUNT, sizeof *times);
    status st = c->count ? ST_OK : status_describe(ST_USAGE, "no ray meets an active cell");
    if (!truth || !times)
        st = ST_NOMEM;
    if (st == ST_OK) {
        double median[INTERSECTOR_COUNT], spread[INTERSECTOR_COUNT];
        find_truth(c, truth);
        for (int run = 0; run < runs; run++)
            for (int k = 0; k < INTERSECTOR_COUNT; k++)
                times[k * runs + run] = time_one(intersector_at(k), c);
        for (int k = 0; k < INTERSECTOR_COUNT; k++)
            median[k] = bench_median(times + k * runs, runs, &spread[k]);
        for (int k = 0; k < INTERSECTOR_COUNT; k++) {
            tally sum = {0};
            judge(intersector_at(k), c, truth, &sum);
            const uint64_t met = sum.surfaces - sum.missed;
            bench_table_add(t, "%s", name);
            bench_table_add(t, "%s", intersector_at(k)->name);
            bench_table_add(t, "%llu", (unsigned long long)sum.judged);
            bench_table_add(t, "%llu", (unsigned long long)sum.surfaces);
            bench_table_add(t, "%llu", (unsigned long long)sum.missed);
            bench_table_add(t, "%.3f", percent(sum.missed, sum.surfaces));
            bench_table_add(t, "%llu", (unsigned long long)sum.made_up);
            bench_table_add(t, "%.3f", percent(sum.made_up, sum.judged - sum.surfaces));
            bench_table_add(t, "%.2e", met ? sqrt(sum.sum_squares / (double)met) : 0.0);
            bench_table_add(t, "%.2e", sum.worst);
            bench_table_add(t, "%.1f", median[k]);
            bench_table_add(t, "%.1f", spread[k]);
            bench_table_add(t, "%.2f", median[k] / median[INTERSECTOR_COUNT - 1]);
        }
    }
    mem_free(m, times);
    mem_free(m, truth);
    return st;
}
