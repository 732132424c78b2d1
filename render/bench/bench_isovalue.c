#include "render/bench/bench_isovalue.h"

#include <math.h>

#include "formats/base/clock.h"
#include "formats/base/cpu.h"
#include "formats/leaf/leaf_unpacker.h"
#include "render/bench/bench_race.h"
#include "stream/active.h"

const char bench_isovalue_headings[] = "volume|isa|treelets|us/treelet|+-|select us|same ms|+-|"
                                       "new ms|+-|new/same";

static const double STANDARD = 2.2; /* distance of the view, in longest edges */

/* ---- masks alone ---- */

/* All payloads that hold the isovalue, in memory. */
typedef struct hoard {
    leaf_file *f;
    uint32_t *treelet;
    void **payload;
    uint32_t count;
    active_masks *masks; /* made over and over */
    double *seconds;     /* [isa][run] */
} hoard;

static void hoard_release(mem *m, hoard *h) {
    for (uint32_t i = 0; i < h->count; i++)
        mem_free(m, h->payload[i]);
    mem_free(m, h->seconds);
    mem_free(m, h->masks);
    mem_free(m, h->payload);
    mem_free(m, h->treelet);
    leaf_file_close(h->f);
}

static status hoard_fill(mem *m, hoard *h, double iso) {
    const leaf_layout *layout = &h->f->layout;
    const uint32_t most = leaf_layout_payload_max(layout);
    leaf_unpacker *u = NULL;
    status st = leaf_unpacker_create(m, h->f, &u);
    for (uint32_t t = 0; t < layout->treelets && st == ST_OK; t++) {
        if (!((double)h->f->own[t][0] < iso && iso <= (double)h->f->own[t][1]))
            continue;
        void *payload = mem_alloc(m, most);
        if (!payload) {
            st = ST_NOMEM;
            break;
        }
        h->payload[h->count] = payload;
        h->treelet[h->count++] = t;
        st = leaf_file_load(h->f, t, u, payload);
    }
    leaf_unpacker_destroy(u);
    return st;
}

static status hoard_open(mem *m, const char *path, double iso, int runs, hoard *h) {
    *h = (hoard){0};
    status st = leaf_file_open(m, path, &h->f);
    if (st != ST_OK)
        return st;
    if (h->f->mesh || h->f->besides)
        return status_describe(ST_UNSUPPORTED, "%s: masks are measured of grids", path);
    const uint32_t n = h->f->layout.treelets, k = h->f->layout.cells_log2 - LEAF_BLOCK_LOG2;
    h->treelet = mem_array(m, n, sizeof *h->treelet);
    h->payload = mem_array(m, n, sizeof *h->payload);
    h->seconds = mem_array(m, (size_t)runs * CPU_ISAS, sizeof *h->seconds);
    h->masks = mem_alloc(m, active_bytes(k));
    if (!h->treelet || !h->payload || !h->seconds || !h->masks)
        return ST_NOMEM;
    active_init(h->masks, k);
    return hoard_fill(m, h, iso);
}

/* Every version over all payloads, in turn. */
static void hoard_run(hoard *h, double iso, int runs) {
    const interest in = interest_of_isovalues(&iso, 1);
    for (int run = 0; run < runs; run++)
        for (int isa = 0; isa <= (int)cpu_best(); isa++) {
            const double start = clock_cpu_seconds();
            for (uint32_t i = 0; i < h->count; i++)
                active_for((cpu_isa)isa)(h->masks, h->f, h->treelet[i], h->payload[i], &in);
            h->seconds[isa * runs + run] = clock_cpu_seconds() - start;
        }
}

/* ---- frames ---- */

/* Two racers an ISA: the second selects anew before every picture. */
typedef struct heat {
    bench_racer racers[2 * CPU_ISAS];
    double *select; /* seconds, [isa][run] */
    double iso;
    int runs;
} heat;

/* Another isovalue as far as masks are concerned, but the same picture. */
static status select_anew(void *ctx, int racer, int run) {
    heat *h = ctx;
    bench_racer *r = &h->racers[racer];
    if (racer % 2 == 0)
        return ST_OK;
    const leafcast_surface surface =
        leafcast_surface_default(h->iso - 1e-12 * (run + 1) * fmax(fabs(h->iso), 1e-300));
    const double cpu = clock_cpu_seconds();
    status st = (status)leafcast_select(r->volume, &surface, 1);
    const double seconds = clock_cpu_seconds() - cpu;
    h->select[racer / 2 * h->runs + run] = seconds;
    r->seconds[run] += seconds;
    return st;
}

static status draw_frames(bench_job *job, const bench_subject *s, heat *h) {
    const int count = 2 * ((int)cpu_best() + 1);
    status st = ST_OK;
    for (int i = 0; i < count && st == ST_OK; i++) {
        const bench_entry e = {s->path,  cpu_isa_name((cpu_isa)(i / 2)), h->iso, 1,
                               STANDARD, job->view.camera.width};
        st = bench_race_enter(&e, &h->racers[i]);
    }
    if (st == ST_OK)
        st = bench_race_run(&job->m, h->racers, count, job->runs, job->progress, select_anew, h);
    return st;
}

/* ---- both ---- */

static void add_row(bench_job *job, const char *label, int isa, hoard *masks, heat *frames) {
    bench_table *t = &job->table;
    const bench_racer *same = &frames->racers[2 * isa], *fresh = same + 1;
    double spread;
    const double us = 1e6 / (masks->count ? masks->count : 1) *
                      bench_median(masks->seconds + isa * job->runs, job->runs, &spread);
    bench_table_add(t, "%s", label);
    bench_table_add(t, "%s", cpu_isa_name((cpu_isa)isa));
    bench_table_add(t, "%u", masks->count);
    bench_table_add(t, "%.2f", us);
    bench_table_add(t, "%.2f", 1e6 / (masks->count ? masks->count : 1) * spread);
    bench_table_add(t, "%.1f",
                    1e6 * bench_median(frames->select + isa * job->runs, job->runs, NULL));
    bench_table_add(t, "%.2f", same->median * 1e3);
    bench_table_add(t, "%.2f", same->spread * 1e3);
    bench_table_add(t, "%.2f", fresh->median * 1e3);
    bench_table_add(t, "%.2f", fresh->spread * 1e3);
    bench_table_add(t, "%.3f", fresh->median / same->median);
}

static status measure(bench_job *job, const bench_subject *s) {
    hoard masks;
    heat frames = {.iso = s->view.surfaces[0].isovalue, .runs = job->runs};
    status st = hoard_open(&job->m, s->path, frames.iso, job->runs, &masks);
    frames.select = mem_array(&job->m, (size_t)job->runs * CPU_ISAS, sizeof *frames.select);
    if (st == ST_OK && !frames.select)
        st = ST_NOMEM;
    if (st == ST_OK)
        hoard_run(&masks, frames.iso, job->runs);
    if (st == ST_OK)
        st = draw_frames(job, s, &frames);
    for (int isa = 0; isa <= (int)cpu_best() && st == ST_OK; isa++)
        add_row(job, s->label, isa, &masks, &frames);
    bench_race_leave(&job->m, frames.racers, 2 * CPU_ISAS);
    mem_free(&job->m, frames.select);
    hoard_release(&job->m, &masks);
    return st;
}

status bench_isovalue(bench_job *job) {
    static const char *const names[] = {"bonsai", "engine", "ch2better", "ml-256", "ml-512", NULL};
    static const char *const brief[] = {"ml-32", NULL};
    bench_table_init(&job->table,
                     "A new isovalue: masks of active cells; frames of one isovalue against frames "
                     "of one each, one thread, all resident; medians of CPU time, interleaved",
                     bench_isovalue_headings);
    return bench_suite_each(job, names, brief, measure);
}
