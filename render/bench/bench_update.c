#include "render/bench/bench_update.h"

#include <string.h>

#include "formats/base/clock.h"
#include "formats/base/cpu.h"
#include "formats/base/pool.h"
#include "formats/leaf/leaf_unpacker.h"
#include "stream/active.h"

/* Columns, in the order of add_row(); all of a change from one step to the next, medians over all
 * changes and runs, CPU time where there is one thread:
 *   treelets   of level 0 that hold what is asked for; new: of these, whose bytes are others than
 *              in the step before; MB: of these, stored; means over all changes
 *   pass us    over the directory, to find them
 *   load ms    the new ones alone; ms: and their masks
 *   cells      active ones, of all steps
 *   differ     treelets whose masks are not those that the scalar version makes of the step
 *              converted alone (of a file that is given: of the same file) */
const char bench_update_headings[] = "series|asked|threads|steps|treelets|new|MB|pass us|load ms|"
                                     "ms|+-|us/treelet|x 1 thread|cells|differ";

enum { ASKED = 2 };
static const char *const asked_names[ASKED] = {"surface", "all values"};

/* What one thread loads into. */
typedef struct desk {
    void *payload;
    active_masks *masks;
} desk;

typedef struct series {
    leaf_file *f;
    interest in;
    uint32_t step;
    uint32_t *fresh; /* payloads */
    uint32_t count;
    desk *desks;
    leaf_unpacker **unpackers; /* NULL: of a raw file */
    bool masks;                /* are made, too */
} series;

/* Of all changes of a case. */
typedef struct tally {
    uint64_t held, fresh, bytes, cells, differ;
    double *pass, *load, *all; /* seconds, a change */
    int changes;
} tally;

/* ---- one change ---- */

static bool holds(const series *s, uint32_t p) {
    return interest_meets(&s->in, s->f->own[p][0], s->f->own[p][1]);
}

static uint32_t payload_of(const series *s, uint32_t step, uint32_t treelet) {
    return leaf_layout_samples(&s->f->layout, leaf_layout_set(&s->f->layout, 0, step), treelet);
}

/* Payloads of one value have no bytes: they are the same where the value is. */
static bool is_same(const series *s, uint32_t p, uint32_t q) {
    if (leaf_file_has_bytes(s->f, p) || leaf_file_has_bytes(s->f, q))
        return leaf_file_home(s->f, p) == leaf_file_home(s->f, q);
    return memcmp(s->f->own[p], s->f->own[q], sizeof s->f->own[p]) == 0 &&
           !leaf_file_is_outside(s->f, p);
}

/* Find what the step needs that the step before did not have. Returns how many hold the interest.
 */
static uint32_t pass(series *s, uint32_t step) {
    const leaf_layout *l = &s->f->layout;
    uint32_t held = 0;
    s->count = 0;
    for (uint32_t t = 0; t < l->treelets; t++) {
        const uint32_t p = payload_of(s, step, t);
        if (l->level_of[t] != 0 || !holds(s, p))
            continue;
        held++;
        if (!is_same(s, p, payload_of(s, step - 1, t)))
            s->fresh[s->count++] = p;
    }
    return held;
}

static status bring(void *ctx, size_t index, int worker) {
    const series *s = ctx;
    const desk *d = &s->desks[worker];
    leaf_unpacker *u = s->unpackers ? s->unpackers[worker] : NULL;
    status st = leaf_file_load(s->f, s->fresh[index], u, d->payload);
    if (st == ST_OK && s->masks)
        active_for(cpu_best())(d->masks, s->f, s->fresh[index], d->payload, &s->in);
    return st;
}

static status timed(series *s, pool *threads, bool masks, double *seconds) {
    s->masks = masks;
    const double cpu = clock_cpu_seconds(), wall = clock_seconds();
    status st = pool_run(threads, s->count, bring, s);
    *seconds = pool_threads(threads) > 1 ? clock_seconds() - wall : clock_cpu_seconds() - cpu;
    return st;
}

static status change(series *s, pool *threads, uint32_t step, bool count, tally *t) {
    const double cpu = clock_cpu_seconds();
    const uint32_t held = pass(s, step);
    t->pass[t->changes] = clock_cpu_seconds() - cpu;
    for (uint32_t i = 0; i < s->count && count; i++)
        t->bytes += leaf_file_stored(s->f, s->fresh[i]);
    t->held += count ? held : 0;
    t->fresh += count ? s->count : 0;
    status st = timed(s, threads, false, &t->load[t->changes]);
    if (st == ST_OK)
        st = timed(s, threads, true, &t->all[t->changes]);
    t->changes++;
    return st;
}

/* ---- whether it is right ---- */

static status masks_of(leaf_file *f, leaf_unpacker *u, const desk *d, uint32_t p, active_fn *make,
                       const interest *in) {
    const uint32_t k = f->layout.cells_log2 - LEAF_BLOCK_LOG2;
    active_init(d->masks, k);
    status st = leaf_file_load(f, p, u, d->payload);
    if (st == ST_OK)
        make(d->masks, f, p, d->payload, in);
    return st;
}

static uint64_t cells_of(const active_masks *masks, uint32_t k) {
    uint64_t sum = 0;
    for (size_t i = 0; i < (size_t)1 << (3 * k); i++)
        sum += (uint64_t)__builtin_popcountll(masks->cells[i]);
    return sum;
}

static bool same_masks(const active_masks *a, const active_masks *b, uint32_t k) {
    return a->root == b->root && memcmp(a->nodes, b->nodes, active_nodes_at(k)) == 0 &&
           memcmp(a->cells, b->cells, sizeof *a->cells << (3 * k)) == 0;
}

/* The masks of a step's treelets, beside those of the step alone, from its payload `from` on. */
static status judge_step(series *s, uint32_t step, leaf_file *alone, uint32_t from, desk yardstick,
                         tally *t) {
    const leaf_layout *l = &s->f->layout;
    const uint32_t k = l->cells_log2 - LEAF_BLOCK_LOG2;
    leaf_unpacker *u = NULL;
    status st = leaf_unpacker_create(s->f->m, alone, &u);
    for (uint32_t n = 0; n < l->treelets && st == ST_OK; n++) {
        const uint32_t p = payload_of(s, step, n);
        if (l->level_of[n] != 0 || !holds(s, p))
            continue;
        st = masks_of(alone, u, &yardstick, from + n, active_for(CPU_SCALAR), &s->in);
        if (st == ST_OK)
            st = masks_of(s->f, s->unpackers ? s->unpackers[0] : NULL, &s->desks[0], p,
                          active_for(cpu_best()), &s->in);
        if (st != ST_OK)
            break;
        t->cells += cells_of(yardstick.masks, k);
        t->differ += !same_masks(s->desks[0].masks, yardstick.masks, k);
    }
    leaf_unpacker_destroy(u);
    return st;
}

static status judge(bench_job *job, const bench_subject *subject, series *s, desk yardstick,
                    tally *t) {
    status st = ST_OK;
    for (uint32_t step = 0; step < s->f->layout.steps && st == ST_OK; step++) {
        char path[PATH_MAX];
        leaf_file *alone = NULL;
        bench_store_alone(subject->path, step, path);
        if (subject->name)
            st = leaf_file_open(&job->m, path, &alone);
        if (st == ST_OK && alone && alone->layout.treelets != s->f->layout.treelets)
            st = status_describe(ST_CORRUPT, "%s: has %u treelets, expected %u as its series", path,
                                 alone->layout.treelets, s->f->layout.treelets);
        if (st == ST_OK)
            st = judge_step(s, step, alone ? alone : s->f, alone ? 0 : payload_of(s, step, 0),
                            yardstick, t);
        leaf_file_close(alone);
    }
    return st;
}

/* ---- rows ---- */

static void add_row(bench_job *job, const char *label, const series *s, int asked, int threads,
                    tally *t, double *one) {
    bench_table *table = &job->table;
    const double changes = s->f->layout.steps - 1.0, fresh = (double)t->fresh / changes;
    double spread;
    const double all = bench_median(t->all, t->changes, &spread);
    *one = threads == 1 ? all : *one;
    bench_table_add(table, "%s", label);
    bench_table_add(table, "%s", asked_names[asked]);
    bench_table_add(table, "%d", threads);
    bench_table_add(table, "%u", s->f->layout.steps);
    bench_table_add(table, "%.1f", (double)t->held / changes);
    bench_table_add(table, "%.1f", fresh);
    bench_table_add(table, "%.3f", 1e-6 * (double)t->bytes / changes);
    bench_table_add(table, "%.1f", 1e6 * bench_median(t->pass, t->changes, NULL));
    bench_table_add(table, "%.3f", 1e3 * bench_median(t->load, t->changes, NULL));
    bench_table_add(table, "%.3f", 1e3 * all);
    bench_table_add(table, "%.3f", 1e3 * spread);
    bench_table_add(table, "%.2f", 1e6 * all / (fresh > 1.0 ? fresh : 1.0));
    bench_table_add(table, "%.2f", *one / all);
    bench_table_add(table, "%llu", (unsigned long long)t->cells);
    bench_table_add(table, "%llu", (unsigned long long)t->differ);
}

static status run(bench_job *job, const bench_subject *subject, series *s, int asked) {
    const uint32_t changes = s->f->layout.steps - 1;
    const size_t room = (size_t)changes * (size_t)job->runs;
    tally t = {.pass = mem_array(&job->m, room, sizeof *t.pass),
               .load = mem_array(&job->m, room, sizeof *t.load),
               .all = mem_array(&job->m, room, sizeof *t.all)};
    double one = 0;
    status st = t.pass && t.load && t.all ? ST_OK : ST_NOMEM;
    if (st == ST_OK)
        st = judge(job, subject, s, s->desks[job->threads], &t);
    for (int threads = 1; threads <= job->threads && st == ST_OK; threads *= 2) {
        pool *p = NULL;
        t.held = t.fresh = t.bytes = 0;
        t.changes = 0;
        st = pool_create(&job->m, threads, &p);
        for (int n = 0; n < job->runs && st == ST_OK; n++)
            for (uint32_t step = 1; step <= changes && st == ST_OK; step++)
                st = change(s, p, step, n == 0, &t);
        pool_destroy(p);
        if (st == ST_OK)
            add_row(job, subject->label, s, asked, threads, &t, &one);
    }
    mem_free(&job->m, t.all);
    mem_free(&job->m, t.load);
    mem_free(&job->m, t.pass);
    return st;
}

/* ---- a series ---- */

/* A desk for each thread, and one for the yardstick. */
static status furnish(bench_job *job, series *s) {
    const leaf_layout *l = &s->f->layout;
    const uint32_t k = l->cells_log2 - LEAF_BLOCK_LOG2;
    s->fresh = mem_array(&job->m, l->treelets, sizeof *s->fresh);
    s->desks = mem_array(&job->m, (size_t)job->threads + 1, sizeof *s->desks);
    if (!s->fresh || !s->desks)
        return ST_NOMEM;
    memset(s->desks, 0, ((size_t)job->threads + 1) * sizeof *s->desks);
    for (int i = 0; i <= job->threads; i++) {
        s->desks[i].payload = mem_alloc(&job->m, leaf_layout_payload_max(l));
        s->desks[i].masks = mem_alloc(&job->m, active_bytes(k));
        if (!s->desks[i].payload || !s->desks[i].masks)
            return ST_NOMEM;
        active_init(s->desks[i].masks, k);
    }
    return leaf_unpackers_create(&job->m, s->f, job->threads, &s->unpackers);
}

static void clear(bench_job *job, series *s) {
    leaf_unpackers_destroy(&job->m, s->unpackers, job->threads);
    for (int i = 0; i <= job->threads && s->desks; i++) {
        mem_free(&job->m, s->desks[i].masks);
        mem_free(&job->m, s->desks[i].payload);
    }
    mem_free(&job->m, s->desks);
    mem_free(&job->m, s->fresh);
    leaf_file_close(s->f);
}

static status measure(bench_job *job, const bench_subject *subject) {
    const interest asked[ASKED] = {interest_of_isovalues(&subject->view.surfaces[0].isovalue, 1),
                                   interest_of_all()};
    series s = {0};
    status st = leaf_file_open(&job->m, subject->path, &s.f);
    if (st == ST_OK && (s.f->mesh || s.f->besides || s.f->layout.steps < 2))
        st = status_describe(ST_UNSUPPORTED, "%s: no time series of a grid", subject->path);
    if (st == ST_OK)
        st = furnish(job, &s);
    for (int i = 0; i < ASKED && st == ST_OK; i++) {
        s.in = asked[i];
        st = run(job, subject, &s, i);
    }
    clear(job, &s);
    return st;
}

status bench_update(bench_job *job) {
    static const char *const names[] = {"vortex-64", "vortex-128", "vortex-256", "vortex-512",
                                        "drop-128",  "jets-128",   "fingers",    "isabel",
                                        "ocean",     "fluid",      NULL};
    static const char *const brief[] = {"drop-64", "jets-64", "vortex-64", NULL};
    bench_table_init(&job->table,
                     "M08 tables 5.1, 5.2: from one step of a grid to the next: what is new is "
                     "loaded, its masks of active cells are made; medians",
                     bench_update_headings);
    return bench_suite_each(job, names, brief, measure);
}
