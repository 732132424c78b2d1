#include "render/door/point_samples.h"

#include <math.h>
#include <string.h>

#include "formats/base/clock.h"
#include "formats/base/pool.h"
#include "render/door/coarse_preview.h"
#include "render/door/leafcast_device.h"
#include "render/door/leafcast_turn.h"
#include "render/door/leafcast_volume.h"
#include "render/ray/kind.h"

enum {
    BLOCK = 1024,        /* points that a thread takes at a time */
    CHUNK_LEAST = BLOCK, /* points that may wait at a time */
    CHUNK_MOST = 1 << 22,
    BATCH_MOST = 1024 /* treelets requested at a time */
};

/* NO_POINT ends a list. NOT_SEEN: no point has waited for this treelet yet. */
#define NO_POINT UINT32_MAX
#define NOT_SEEN (UINT32_MAX - 1)

/* A chunk of points, and the lists of points that wait. Points are numbered from `first` on. */
typedef struct waiting {
    const point_samples *job;
    size_t first;
    uint32_t count;
    uint32_t *treelet; /* per point: waits for this; LEAF_NO_TREELET: done */
    uint32_t *next;    /* per point: the next point in its list */
    uint32_t *picked;  /* points whose treelets are resident */
    uint32_t *list;    /* per treelet: the first point that waits for it */
    uint32_t low;      /* lists of earlier treelets are empty */
    loader_request *batch;
    uint32_t batch_room;
    uint32_t chunk; /* most points of a chunk */
    size_t done;    /* points, in all chunks so far */
    uint64_t treelets, bytes;
    uint32_t family; /* whose shared bytes were counted last */
} waiting;

/* Memory that one point takes while it waits. */
enum { POINT_BYTES = 3 * sizeof(uint32_t) };

/* ---- The budget ---- */

/* Returns the bytes in use or promised, without points and treelets. The bytes that begun frames
 * have reserved include the scratch. */
static size_t fixed_bytes(const point_samples *p) {
    const leafcast *v = p->volume;
    const leafcast_device *d = v->device;
    const size_t frames = d->frames_bytes ? d->frames_bytes : d->scratch_bytes;
    const size_t lists = v->file->layout.treelets * sizeof(uint32_t);
    return d->base_bytes + d->beside + frames + p->beside + coarse_preview_bytes(v) + lists +
           BATCH_MOST * sizeof(loader_request) + 4096;
}

/* Returns the bytes of other volumes' treelets. Evicts these if they take over half of `rest`. */
static size_t others_bytes(const leafcast *v, size_t rest) {
    size_t held = 0;
    for (const leafcast *w = v->device->volumes; w; w = w->next)
        held += w == v ? 0 : loader_statistics(w->treelets).bytes_resident;
    if (held <= rest / 2)
        return held;
    for (const leafcast *w = v->device->volumes; w; w = w->next)
        if (w != v)
            loader_clear(w->treelets);
    return 0;
}

/* Share the budget: up to a quarter for waiting points, the rest for treelets. */
static status share_budget(waiting *w) {
    const point_samples *p = w->job;
    const size_t limit = p->volume->m->limit, slot = loader_slot_bytes(p->volume->treelets);
    const size_t wanted = p->count < CHUNK_MOST ? p->count : CHUNK_MOST;
    const size_t least = wanted < CHUNK_LEAST ? wanted : CHUNK_LEAST;
    w->chunk = (uint32_t)wanted;
    if (limit == 0) {
        budget_slots(p->volume, SIZE_MAX);
        return ST_OK;
    }
    const size_t needed = fixed_bytes(p) + slot + least * POINT_BYTES;
    if (needed > limit)
        return status_describe(ST_NOMEM,
                               "the memory budget of %zu bytes is too small for these points: %zu "
                               "bytes would do",
                               limit, budget_enough(p->volume->device, needed));
    size_t rest = limit - fixed_bytes(p);
    rest -= others_bytes(p->volume, rest - slot - least * POINT_BYTES);
    size_t chunk = rest / 4 / POINT_BYTES;
    chunk = chunk < least ? least : chunk < wanted ? chunk : wanted;
    if (rest - slot < chunk * POINT_BYTES)
        chunk = (rest - slot) / POINT_BYTES;
    w->chunk = (uint32_t)chunk;
    budget_slots(p->volume, rest - chunk * POINT_BYTES);
    return ST_OK;
}

static void release(waiting *w) {
    mem *m = w->job->volume->m;
    mem_free(m, w->treelet);
    mem_free(m, w->next);
    mem_free(m, w->picked);
    mem_free(m, w->list);
    mem_free(m, w->batch);
}

static status prepare(waiting *w) {
    mem *m = w->job->volume->m;
    const uint32_t treelets = w->job->volume->file->layout.treelets;
    status st = share_budget(w);
    if (st != ST_OK)
        return st;
    w->batch_room = treelets < BATCH_MOST ? treelets : BATCH_MOST;
    w->treelet = mem_alloc(m, w->chunk * sizeof *w->treelet);
    w->next = mem_alloc(m, w->chunk * sizeof *w->next);
    w->picked = mem_alloc(m, w->chunk * sizeof *w->picked);
    w->list = mem_alloc(m, treelets * sizeof *w->list);
    w->batch = mem_alloc(m, w->batch_room * sizeof *w->batch);
    if (!w->treelet || !w->next || !w->picked || !w->list || !w->batch)
        return ST_NOMEM;
    w->family = LEAF_NO_TREELET;
    for (uint32_t t = 0; t < treelets; t++)
        w->list[t] = NOT_SEEN;
    return ST_OK;
}

/* ---- Lists ---- */

static bool is_empty(const waiting *w, uint32_t t) {
    return w->list[t] == NO_POINT || w->list[t] == NOT_SEEN;
}

static void push(waiting *w, uint32_t point) {
    const uint32_t t = w->treelet[point];
    if (w->list[t] == NOT_SEEN) {
        w->treelets++;
        w->bytes += loader_stored_bytes(w->job->volume->treelets, t, &w->family);
    }
    w->next[point] = is_empty(w, t) ? NO_POINT : w->list[t];
    w->list[t] = point;
}

/* Put waiting points into their lists, and count the others as done. numbers: which points; NULL:
 * the first `count`. */
static void sort_out(waiting *w, const uint32_t *numbers, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t point = numbers ? numbers[i] : i;
        if (w->treelet[point] == LEAF_NO_TREELET)
            w->done++;
        else
            push(w, point);
    }
}

/* Append all points that wait for treelet t to `picked`. Returns the new length. */
static uint32_t pick(waiting *w, uint32_t t, uint32_t picked) {
    for (uint32_t point = w->list[t]; point != NO_POINT; point = w->next[point])
        w->picked[picked++] = point;
    w->list[t] = NO_POINT;
    return picked;
}

/* ---- Points, by all threads ---- */

static void point_of(const waiting *w, uint32_t point, double at[3]) {
    w->job->point(w->job->ctx, w->first + point, at);
}

static void tell(const waiting *w, uint32_t point, const double at[3],
                 const leafcast_sample *sample) {
    w->job->found(w->job->ctx, w->first + point, at, sample);
    w->treelet[point] = LEAF_NO_TREELET;
}

static const leafcast_sample NOTHING = {.value = (double)NAN, .nearest = (double)NAN};

static void locate(const waiting *w, uint32_t point, uint32_t after) {
    const point_samples *p = w->job;
    double at[3];
    point_of(w, point, at);
    w->treelet[point] = p->volume->kind->walks->treelet_at(p->volume, p->level, at, after);
    if (w->treelet[point] == LEAF_NO_TREELET)
        tell(w, point, at, &NOTHING);
}

static status locate_block(void *ctx, size_t index, int worker) {
    const waiting *w = ctx;
    const uint32_t begin = (uint32_t)index * BLOCK;
    const uint32_t end = w->count - begin < BLOCK ? w->count : begin + BLOCK;
    (void)worker;
    for (uint32_t point = begin; point < end; point++)
        locate(w, point, LEAF_NO_TREELET);
    return ST_OK;
}

static void sample(const waiting *w, uint32_t point) {
    const leafcast *v = w->job->volume;
    leafcast_sample s = NOTHING;
    double at[3];
    point_of(w, point, at);
    v->kind->cell_in(v, loader_lookup(v->treelets, w->treelet[point]), at, &s);
    if (s.inside)
        tell(w, point, at, &s);
    else
        locate(w, point, w->treelet[point]);
}

typedef struct picked_points {
    const waiting *w;
    uint32_t count;
} picked_points;

static status sample_block(void *ctx, size_t index, int worker) {
    const picked_points *p = ctx;
    const uint32_t begin = (uint32_t)index * BLOCK;
    const uint32_t end = p->count - begin < BLOCK ? p->count : begin + BLOCK;
    (void)worker;
    for (uint32_t i = begin; i < end; i++)
        sample(p->w, p->w->picked[i]);
    return ST_OK;
}

static size_t blocks_of(size_t points) {
    return (points + BLOCK - 1) / BLOCK;
}

/* ---- Treelets ---- */

/* Fill the batch with the first treelets that points wait for. Returns their number. */
static uint32_t next_batch(waiting *w) {
    const uint32_t treelets = w->job->volume->file->layout.treelets;
    uint32_t count = 0;
    while (w->low < treelets && is_empty(w, w->low))
        w->low++;
    for (uint32_t t = w->low; t < treelets && count < w->batch_room; t++)
        if (!is_empty(w, t))
            w->batch[count++] = (loader_request){t, t};
    return count;
}

/* Pick the points of the batch's resident treelets. Move the other treelets to the front of the
 * batch; *absent is their number. */
static uint32_t pick_ready(waiting *w, uint32_t count, uint32_t *absent) {
    const loader *l = w->job->volume->treelets;
    uint32_t picked = 0;
    *absent = 0;
    for (uint32_t i = 0; i < count; i++) {
        const loader_request r = w->batch[i];
        if (loader_is_ready(l, r.t))
            picked = pick(w, r.t, picked);
        else
            w->batch[(*absent)++] = r;
    }
    return picked;
}

/* Sample points of resident treelets while others load. If there are none, wait for one. */
static status go_on(waiting *w, uint32_t count) {
    leafcast *v = w->job->volume;
    uint32_t absent;
    const picked_points picked = {w, pick_ready(w, count, &absent)};
    if (picked.count == 0)
        return loader_admit(v->treelets, w->batch, absent);
    loader_want(v->treelets, w->batch, absent);
    const status st =
        pool_run(v->device->threads, blocks_of(picked.count), sample_block, (void *)&picked);
    sort_out(w, w->picked, picked.count);
    return st;
}

static status watch(const waiting *w) {
    const point_samples *p = w->job;
    if (p->watch && !p->watch(p->watch_ctx, (double)w->done / (double)p->count))
        return ST_STOPPED;
    return ST_OK;
}

static status run_chunk(waiting *w) {
    const size_t left = w->job->count - w->first;
    w->count = left < w->chunk ? (uint32_t)left : w->chunk;
    w->low = 0;
    status st = pool_run(w->job->volume->device->threads, blocks_of(w->count), locate_block, w);
    if (st == ST_OK)
        sort_out(w, NULL, w->count);
    for (uint32_t batch; st == ST_OK && (batch = next_batch(w)) > 0;) {
        st = watch(w);
        if (st == ST_OK)
            st = go_on(w, batch);
    }
    w->first += w->count;
    return st == ST_OK ? watch(w) : st;
}

/* ---- Statistics ---- */

static void describe(const waiting *w, const loader_stats *before, double seconds,
                     leafcast_stats *stats) {
    const leafcast *v = w->job->volume;
    const loader_stats l = loader_statistics(v->treelets);
    *stats = (leafcast_stats){.size = sizeof *stats,
                              .open_s = v->open_s,
                              .load_s = l.load_s - before->load_s,
                              .render_s = seconds,
                              .treelets_total = v->file->layout.treelets,
                              .treelets_active = w->treelets,
                              .treelets_loaded = l.loads - before->loads,
                              .bytes_file = v->file->header.file_bytes,
                              .bytes_active = w->bytes,
                              .bytes_visible = w->bytes,
                              .bytes_read = l.bytes_read - before->bytes_read,
                              .bytes_resident = l.bytes_resident,
                              .bytes_peak = mem_peak(v->m),
                              .threads = pool_threads(v->device->threads),
                              .isa = v->device->isa_name};
}

status point_samples_run(const point_samples *p, leafcast_stats *stats) {
    leafcast *v = p->volume;
    const double start = clock_seconds();
    const uint32_t coarsest = v->file->layout.sampled - 1;
    point_samples job = *p;
    job.level = job.level < coarsest ? job.level : coarsest;
    waiting w = {.job = &job};
    loader_forget_failures(v->treelets);
    loader_select_set(v->treelets, v->set = p->set);
    const loader_stats before = loader_statistics(v->treelets);
    status st = prepare(&w);
    while (st == ST_OK && w.first < p->count)
        st = run_chunk(&w);
    release(&w);
    if (stats)
        describe(&w, &before, clock_seconds() - start, stats);
    return st;
}
