#include "render/bench/bench_intersect.h"

#include <math.h>
#include <string.h>

#include "formats/base/clock.h"
#include "render/experiments/intersect_walk.h"
#include "render/experiments/walk_choices.h"
#include "render/grid/cell_batch.h"

const char bench_intersect_headings[] =
    "field|intersector|ray-cells|surfaces|missed|missed %|false|"
    "false %|rms cells|worst cells|ns/ray-cell|+-|x marmitt|16: scalar ns|sse42 ns|avx2 ns|"
    "avx512 ns|x scalar|differ";

/* ---- ray-cells ---- */

/* What record() writes to: experiments draw one picture at a time. */
static bench_ray_cells *tape;
static uint32_t tape_cells[3]; /* of the grid */

/* The cell of this index in a grid of unit cells; whether the visit was one of it, to the bit. */
static bool unit_box(const ray *r, const cell_visit *visit, uint64_t cell, cell_box *box) {
    cell_visit again;
    for (int a = 0; a < 3; a++) {
        box->lo[a] = (double)(cell % tape_cells[a]);
        box->hi[a] = box->lo[a] + 1.0;
        box->inv[a] = 1.0;
        box->last[a] = cell % tape_cells[a] == tape_cells[a] - 1;
        cell /= tape_cells[a];
        if (r->d[a] == 0.0)
            return false;
    }
    return cell_visit_of(r, box, &again) && memcmp(&again, visit, sizeof again) == 0;
}

static bool record(const ray *r, const cell_visit *visit, const float samples[8], double iso,
                   int32_t iso_index, uint64_t cell, const hit *after, hit *found) {
    if (tape->count < tape->max) {
        bench_ray_cell *c = &tape->cells[tape->count++];
        c->r = *r;
        c->visit = *visit;
        memcpy(c->samples, samples, sizeof c->samples);
        c->iso = iso;
        c->unit = unit_box(r, visit, cell, &c->box);
    }
    return cell_next_hit(r, visit, samples, iso, iso_index, cell, after, found);
}

static bool walk_and_record(const walk_scene *scene, const resident_grid *tr, const ray *r,
                            double t_in, double t_out, unsigned octants, const hit *after,
                            hit *best, ray_counters *counters) {
    return intersect_walk(record, scene, tr, r, t_in, t_out, octants, after, best, counters);
}

status bench_ray_cells_record(mem *m, leafcast *volume, const leafcast_scene *scene,
                              const leafcast_camera *camera, uint32_t max, bench_ray_cells *out) {
    static const walk_choice recording = {"recording", walk_and_record, 0, false};
    const leafcast_image nothing = {.size = sizeof(leafcast_image)};
    *out = (bench_ray_cells){mem_array(m, max, sizeof *out->cells), 0, max};
    if (!out->cells)
        return ST_NOMEM;
    tape = out;
    for (int a = 0; a < 3; a++)
        tape_cells[a] = leafcast_describe(volume).dims[a] - 1;
    const walk_choice *before = walk_choice_use(volume, &recording);
    status st = (status)leafcast_trace(volume, scene, camera, &nothing, NULL, NULL, NULL);
    walk_choice_use(volume, before);
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
    cell_box *box = &c->box;
    c->r = (ray){.t0 = 0.0, .t1 = INFINITY};
    c->unit = true;
    for (int a = 0; a < 3; a++) {
        box->lo[a] = cell[a];
        box->hi[a] = cell[a] + 1;
        box->inv[a] = 1.0;
        box->last[a] = cell[a] == SIDE - 2;
        c->r.o[a] = eye[a];
        c->r.d[a] = cell[a] + random_unit(seed) - eye[a];
        c->unit &= c->r.d[a] != 0.0;
    }
    return cell_visit_of(&c->r, box, &c->visit);
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

/* ---- sixteen at a time ---- */

/* So many batches are made, then timed while they lie in the second-level cache, as they do when a
 * tile is traced; the first pass brings them there. */
enum { CHUNK = 64, CHUNKS_MAX = 128, PASSES = 3 };

typedef struct batches {
    cell_batch chunk[CHUNK];
    uint32_t next; /* ray-cell */
} batches;

static void put(const bench_ray_cell *c, int lane, cell_batch *b) {
    b->t0[lane] = c->r.t0;
    b->t1[lane] = c->r.t1;
    for (int a = 0; a < 3; a++) {
        b->d[a][lane] = c->r.d[a];
        b->lo[a][lane] = c->box.lo[a] - c->r.o[a];
        b->hi[a][lane] = c->box.hi[a] - c->r.o[a];
        b->inv[a][lane] = c->box.inv[a];
    }
    for (int i = 0; i < 8; i++)
        b->samples[i][lane] = c->samples[i];
}

/* The next chunk of ray-cells with the first one's isovalue; false: not that many are left. */
static bool fill(batches *b, const bench_ray_cells *c) {
    int n = 0;
    for (; b->next < c->count && n < CHUNK * CELL_BATCH; b->next++)
        if (c->cells[b->next].unit && c->cells[b->next].iso == c->cells[0].iso) {
            put(&c->cells[b->next], n % CELL_BATCH, &b->chunk[n / CELL_BATCH]);
            n++;
        }
    return n == CHUNK * CELL_BATCH;
}

static uint64_t differences(const cell_batch_hits *x, const cell_batch_hits *y) {
    uint32_t differ =
        (x->found ^ y->found) | (x->entering ^ y->entering) | (x->at_exit ^ y->at_exit);
    for (uint32_t rest = x->found & y->found; rest; rest &= rest - 1) {
        const int k = __builtin_ctz(rest);
        if (memcmp(&x->t[k], &y->t[k], sizeof x->t[k]) != 0 || x->iso[k] != y->iso[k])
            differ |= 1u << k;
    }
    return (uint64_t)__builtin_popcount(differ);
}

/* Only the exact intersector has batches. ns[isa]: a ray-cell; 0 where there is no such ISA or too
 * few ray-cells. Adds to *differ. */
static void time_batches(const bench_ray_cells *c, batches *b, double ns[CPU_ISAS],
                         uint64_t *differ) {
    static cell_batch_hits hits[CHUNK], truth[CHUNK]; /* large */
    int chunks = 0;
    b->next = 0;
    for (int isa = 0; isa < CPU_ISAS; isa++)
        ns[isa] = 0.0;
    for (; chunks < CHUNKS_MAX && fill(b, c); chunks++)
        for (int isa = 0; isa <= (int)cpu_best(); isa++) {
            const cell_batch_fn run = cell_batch_kernels[(cpu_isa)isa];
            double start = 0.0;
            for (int pass = 0; pass < PASSES; pass++) {
                if (pass == 1)
                    start = clock_cpu_seconds();
                for (int k = 0; k < CHUNK; k++)
                    run(&b->chunk[k], CELL_BATCH, &c->cells[0].iso, 1, &hits[k]);
            }
            ns[isa] += clock_cpu_seconds() - start;
            if (isa == 0)
                memcpy(truth, hits, sizeof truth);
            for (int k = 0; k < CHUNK; k++)
                *differ += differences(&hits[k], &truth[k]);
        }
    for (int isa = 0; isa < CPU_ISAS && chunks > 0; isa++)
        ns[isa] *= 1e9 / ((double)chunks * CHUNK * CELL_BATCH * (PASSES - 1));
}

typedef struct race {
    double alone, spread;     /* ns a ray-cell, after the visit */
    double batched[CPU_ISAS]; /* with it, sixteen at a time */
    uint64_t differ;
} race;

/* All intersectors against the clock; times: room for runs a column. */
static void run_races(const bench_ray_cells *c, int runs, batches *b, double *times,
                      race out[INTERSECTOR_COUNT]) {
    enum { COLUMNS = CPU_ISAS + 1 };
    for (int k = 0; k < INTERSECTOR_COUNT; k++)
        out[k].differ = 0;
    for (int run = 0; run < runs; run++)
        for (int k = 0; k < INTERSECTOR_COUNT; k++) {
            double ns[CPU_ISAS] = {0.0}, *row = times + (size_t)k * COLUMNS * runs + run;
            row[0] = time_one(intersector_at(k), c);
            if (intersector_at(k)->id == LEAFCAST_MARMITT)
                time_batches(c, b, ns, &out[k].differ);
            for (int isa = 0; isa < CPU_ISAS; isa++)
                row[(isa + 1) * runs] = ns[isa];
        }
    for (int k = 0; k < INTERSECTOR_COUNT; k++) {
        double *row = times + (size_t)k * COLUMNS * runs;
        out[k].alone = bench_median(row, runs, &out[k].spread);
        for (int isa = 0; isa < CPU_ISAS; isa++)
            out[k].batched[isa] = bench_median(row + (isa + 1) * runs, runs, NULL);
    }
}

/* ---- the table ---- */

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

static void add_race(const race *r, double marmitt, bench_table *t) {
    bench_table_add(t, "%.1f", r->alone);
    bench_table_add(t, "%.1f", r->spread);
    bench_table_add(t, "%.2f", r->alone / marmitt);
    for (int isa = 0; isa < CPU_ISAS; isa++)
        if (r->batched[isa] > 0.0)
            bench_table_add(t, "%.1f", r->batched[isa]);
        else
            bench_table_add(t, "-");
    const double best = r->batched[cpu_best()];
    if (best > 0.0) {
        bench_table_add(t, "%.2f", r->batched[CPU_SCALAR] / best);
        bench_table_add(t, "%llu", (unsigned long long)r->differ);
    } else {
        bench_table_add(t, "-");
        bench_table_add(t, "-");
    }
}

static void add_row(const char *name, const intersector *x, const tally *sum, bench_table *t) {
    const uint64_t met = sum->surfaces - sum->missed;
    bench_table_add(t, "%s", name);
    bench_table_add(t, "%s", x->name);
    bench_table_add(t, "%llu", (unsigned long long)sum->judged);
    bench_table_add(t, "%llu", (unsigned long long)sum->surfaces);
    bench_table_add(t, "%llu", (unsigned long long)sum->missed);
    bench_table_add(t, "%.3f", percent(sum->missed, sum->surfaces));
    bench_table_add(t, "%llu", (unsigned long long)sum->made_up);
    bench_table_add(t, "%.3f", percent(sum->made_up, sum->judged - sum->surfaces));
    bench_table_add(t, "%.2e", met ? sqrt(sum->sum_squares / (double)met) : 0.0);
    bench_table_add(t, "%.2e", sum->worst);
}

status bench_intersect(mem *m, const char *name, const bench_ray_cells *c, int runs,
                       bench_table *t) {
    enum { ALIGNED = 64 };
    double *truth = mem_array(m, c->count ? c->count : 1, sizeof *truth);
    double *times = mem_array(m, (size_t)runs * INTERSECTOR_COUNT * (CPU_ISAS + 1), sizeof *times);
    char *room = mem_array(m, sizeof(batches) + ALIGNED, 1);
    status st = c->count ? ST_OK : status_describe(ST_USAGE, "no ray meets an active cell");
    if (!truth || !times || !room)
        st = ST_NOMEM;
    if (st == ST_OK) {
        race races[INTERSECTOR_COUNT];
        batches *b = (batches *)(void *)(room + (ALIGNED - (uintptr_t)room % ALIGNED) % ALIGNED);
        find_truth(c, truth);
        run_races(c, runs, b, times, races);
        for (int k = 0; k < INTERSECTOR_COUNT; k++) {
            tally sum = {0};
            judge(intersector_at(k), c, truth, &sum);
            add_row(name, intersector_at(k), &sum, t);
            add_race(&races[k], races[INTERSECTOR_COUNT - 1].alone, t);
        }
    }
    mem_free(m, room);
    mem_free(m, times);
    mem_free(m, truth);
    return st;
}
