#include "tests/support/block_lab.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "render/grid/cell_kernel.h"
#include "tests/support/fields.h"

enum {
    CHUNK = 256,
    SIZE = 4, /* nodes an axis, about */
    SHOWN = 3,
    FACES = 20,     /* rays beside each, of which only the faces' sides are looked at */
    SAMPLED = 16,   /* one ray in so many is asked whether it grazes, besides those that differ */
    ROOTS_MAX = 64, /* along a ray through a block */
    VISITS_MAX = 64
};

static const char *const names[] = {"noise-f32", "noise-u8", "plateau",    "terraces",
                                    "checker",   "waves",    "rectilinear"};

int block_lab_count(void) {
    return (int)(sizeof names / sizeof names[0]);
}

const char *block_lab_name(int which) {
    return names[which];
}

typedef struct block {
    field f;
    ref_volume v;
    long cells[3];
} block;

static void block_make(block *b, int which, uint64_t seed) {
    if (!field_make(&b->f, names[which], SIZE, seed + (uint64_t)which))
        abort(); /* the names are ours */
    b->v = field_volume(&b->f);
    memset(b->v.to_world, 0, sizeof b->v.to_world);
    for (int a = 0; a < 3; a++) {
        b->v.to_world[a][a] = 1;
        b->cells[a] = b->f.dims[a] - 1;
    }
}

static cell_box block_cell(const block *b, long index, float samples[8]) {
    const long at[3] = {index % b->cells[0], index / b->cells[0] % b->cells[1],
                        index / b->cells[0] / b->cells[1]};
    cell_box box;
    for (int a = 0; a < 3; a++) {
        box.lo[a] = b->f.axis[a] ? b->f.axis[a][at[a]] : (double)at[a];
        box.hi[a] = b->f.axis[a] ? b->f.axis[a][at[a] + 1] : (double)(at[a] + 1);
        box.inv[a] = 1 / (box.hi[a] - box.lo[a]);
        box.last[a] = at[a] == b->cells[a] - 1;
    }
    for (int n = 0; n < 8; n++)
        samples[n] =
            b->f.samples[at[0] + (n & 1) +
                         b->f.dims[0] * (at[1] + (n >> 1 & 1) + b->f.dims[1] * (at[2] + (n >> 2)))];
    return box;
}

static long cell_count(const block *b) {
    return b->cells[0] * b->cells[1] * b->cells[2];
}

/* ---- what must hold ---- */

/* Where all 4 samples of a face lie on one side, so does every point of it: the cell behind it may
 * hold no surface. */
static bool face_keeps_side(const double at[3], const float samples[8], double iso, double value) {
    for (int a = 0; a < 3; a++) {
        if (at[a] != 0 && at[a] != 1)
            continue;
        int inside = 0;
        for (int n = 0; n < 8; n++)
            inside += (n >> a & 1) == (int)at[a] && (double)samples[n] >= iso;
        if ((inside == 4 && !(value >= 0)) || (inside == 0 && value >= 0))
            return false;
    }
    return true;
}

static int by_t(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Roots of the kernel in all cells of the block that it visits, in order. */
static int block_roots(const block *b, const ray *r, double t[ROOTS_MAX], bool *faces) {
    int count = 0;
    for (long i = 0; i < cell_count(b); i++) {
        float samples[8];
        double cubic[4], roots[3];
        cell_visit visit;
        const cell_box box = block_cell(b, i, samples);
        if (!cell_visit_of(r, &box, &visit) || !cell_cubic(&visit, samples, b->f.iso, cubic))
            continue;
        if (!face_keeps_side(visit.in, samples, b->f.iso, cubic[0]) ||
            !face_keeps_side(visit.out, samples, b->f.iso, cubic[3]))
            *faces = false;
        const int n = cell_roots(cubic, roots);
        for (int k = 0; k < n && count < ROOTS_MAX - 1; k++)
            t[count++] = cell_root_t(&visit, roots[k]);
    }
    qsort(t, (size_t)count, sizeof t[0], by_t);
    return count;
}

/* The kernel visits the very cells that the reference walks through, zero-length visits too; and
 * both cells at a face see the same value there, to the bit. */
static bool walks_alike(const block *b, const ray *r, const ref_visit *walk, size_t length) {
    long visited = 0;
    float samples[8];
    cell_visit visit;
    for (long i = 0; i < cell_count(b); i++) {
        const cell_box box = block_cell(b, i, samples);
        visited += cell_visit_of(r, &box, &visit) && visit.t_out > 0;
    }
    double exit_value = NAN;
    for (size_t i = 0; i < length; i++) {
        if (walk[i].t_out == 0) /* begun on a plane and gone at once: nothing to see */
            continue;
        visited--;
        const cell_box box = block_cell(b, (long)walk[i].cell, samples);
        double cubic[4] = {NAN, NAN, NAN, NAN};
        if (!cell_visit_of(r, &box, &visit))
            return false;
        const bool active = cell_cubic(&visit, samples, b->f.iso, cubic);
        if (active && !isnan(exit_value) && cubic[0] != exit_value)
            return false;
        exit_value = active ? cubic[3] : NAN;
    }
    return visited == 0;
}

/* Whether the number of surfaces hangs on the last bits: a ray that passes the surface's edge,
 * within rounding. */
static bool on_the_edge(const block *b, const ref_ray *line, size_t truth) {
    ref_hit hits[ROOTS_MAX];
    const double less = b->f.iso * (1 - 1e-14), more = b->f.iso * (1 + 1e-14);
    return ref_trace(&b->v, line, &less, 1, NULL, hits, ROOTS_MAX) != truth ||
           ref_trace(&b->v, line, &more, 1, NULL, hits, ROOTS_MAX) != truth;
}

/* ---- one ray ---- */

/* The index-th ray of a block; *aimed: at a grid point as nearly as rounding allows, so that planes
 * are crossed in an order that depends on the last bit. */
static ref_ray block_ray(const block *b, int which, uint64_t seed, uint64_t i, bool *aimed) {
    field_random mix = {(seed + (uint64_t)which) * 0x9e3779b97f4a7c15u + i};
    field_random r = {field_random_bits(&mix)};
    const double margin = i & 1 ? 4 : -0.2;
    const int kind = b->f.axis[0] ? 0 : (int)(i >> 1 & 3);
    *aimed = kind == 1;
    if (kind < 2)
        return *aimed ? field_aimed_ray(&b->v, &r, margin) : field_random_ray(&b->v, &r, margin);
    ref_ray line = field_exact_ray(&b->v, &r);
    for (int a = 0; margin < 0 && a < 3; a++)
        line.o[a] += 64 * line.d[a]; /* begin on the grid */
    return line;
}

static ray kernel_ray(const ref_ray *line) {
    ray r = {.t0 = 0, .t1 = INFINITY};
    for (int a = 0; a < 3; a++) {
        r.o[a] = r.held[a] = line->o[a];
        r.d[a] = line->d[a] == 0 ? 0 : line->d[a];
    }
    return r;
}

/* Rays that pass grid points to within rounding. */
static bool faces_keep_sides(const block *b, uint64_t seed, uint64_t index) {
    bool faces = true;
    field_random mix = {~seed * 0x9e3779b97f4a7c15u + index};
    field_random r = {field_random_bits(&mix)};
    for (int i = 0; i < FACES; i++) {
        const ref_ray line = field_aimed_ray(&b->v, &r, i & 1 ? 4 : -0.2);
        const ray k = kernel_ray(&line);
        double t[ROOTS_MAX];
        block_roots(b, &k, t, &faces);
    }
    return faces;
}

static ref_verdict judge_ray(const block *b, const ref_ray *line, bool aimed, uint64_t seed,
                             uint64_t index, ref_tally *tally, bool *sound) {
    ref_visit walk[VISITS_MAX];
    ref_hit hits[ROOTS_MAX];
    double t[ROOTS_MAX];
    const ray r = kernel_ray(line);
    *sound = b->f.axis[0] || faces_keep_sides(b, seed, index);
    if (!aimed) {
        const size_t length = ref_visits(&b->v, line, NULL, walk, VISITS_MAX);
        *sound = *sound && length <= VISITS_MAX && walks_alike(b, &r, walk, length);
    }
    const size_t truth = ref_trace(&b->v, line, &b->f.iso, 1, NULL, hits, ROOTS_MAX);
    const int count = block_roots(b, &r, t, sound);
    bool ask = index % SAMPLED == 0 || count != (int)truth;
    for (int i = 0; !ask && i < count; i++)
        ask = !(fabs(t[i] - hits[i].t) * hits[i].cells_per_t <= REF_GRAZING_CHANGE / 2);
    const bool grazing = ask && (ref_grazing(&b->v, line, &b->f.iso, 1, NULL, ROOTS_MAX) ||
                                 (aimed && on_the_edge(b, line, truth)));
    return ref_judge_roots(tally, hits, (int)truth, t, count, grazing);
}

/* ---- many ---- */

typedef struct chunk {
    ref_tally tally;
    uint64_t broken;
    uint64_t faults[SHOWN];
    const char *what[SHOWN];
    int noted;
} chunk;

typedef struct run_context {
    const block_lab_job *job;
    const block *b;
    chunk *chunks;
} run_context;

static bool is_fault(ref_verdict verdict) {
    return verdict != REF_SAME && verdict != REF_GRAZING;
}

static status run_chunk(void *ctx, size_t at, int worker) {
    (void)worker;
    const run_context *run = ctx;
    const block_lab_job *job = run->job;
    chunk *c = &run->chunks[at];
    for (uint64_t i = at * CHUNK; i < job->count && i < (at + 1) * CHUNK; i++) {
        bool aimed, sound;
        const ref_ray line = block_ray(run->b, job->which, job->seed, i, &aimed);
        const ref_verdict verdict =
            judge_ray(run->b, &line, aimed, job->seed, i, &c->tally, &sound);
        c->broken += !sound;
        if ((is_fault(verdict) || !sound) && c->noted < SHOWN) {
            c->what[c->noted] = sound ? ref_verdict_name(verdict) : "broken walk or face";
            c->faults[c->noted++] = i;
        }
    }
    return ST_OK;
}

status block_lab_run(pool *p, const block_lab_job *job, ref_tally *tally, uint64_t *broken) {
    const size_t count = (size_t)((job->count + CHUNK - 1) / CHUNK);
    block b;
    run_context run = {job, &b, calloc(count ? count : 1, sizeof(chunk))};
    if (!run.chunks)
        return status_describe(ST_NOMEM, "no room for %zu parts", count);
    block_make(&b, job->which, job->seed);
    status st = pool_run(p, count, run_chunk, &run);
    int shown = 0;
    *tally = (ref_tally){0};
    *broken = 0;
    for (size_t at = 0; at < count; at++) {
        const chunk *c = &run.chunks[at];
        ref_tally_add(tally, &c->tally);
        *broken += c->broken;
        for (int n = 0; n < c->noted && shown < SHOWN; n++, shown++)
            fprintf(job->log, "%s; rerun: %s block %s %llu %llu\n", c->what[n], job->rerun,
                    names[job->which], (unsigned long long)job->seed,
                    (unsigned long long)c->faults[n]);
    }
    field_release(&b.f);
    free(run.chunks);
    return st;
}

int block_lab_rerun(int argc, char **argv) {
    int which = block_lab_count();
    while (which-- > 0 && !(argc == 3 && strcmp(names[which], argv[0]) == 0))
        ;
    if (which < 0)
        return 2;
    block b;
    ref_tally tally = {0};
    bool aimed, sound;
    const uint64_t seed = strtoull(argv[1], NULL, 10), index = strtoull(argv[2], NULL, 10);
    block_make(&b, which, seed);
    const ref_ray line = block_ray(&b, which, seed, index, &aimed);
    const ref_verdict verdict = judge_ray(&b, &line, aimed, seed, index, &tally, &sound);
    printf("o %.17g %.17g %.17g\nd %.17g %.17g %.17g\n%s%s\n", line.o[0], line.o[1], line.o[2],
           line.d[0], line.d[1], line.d[2], ref_verdict_name(verdict),
           sound ? "" : ", broken walk or face");
    field_release(&b.f);
    return is_fault(verdict) || !sound;
}
