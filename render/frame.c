#include "render/frame.h"

#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <string.h>

#include "render/integrator.h"
#include "render/kind.h"

enum {
    BATCH = 256, /* resumed rays a work item */
    CHUNK = 4096 /* records allocated at once */
};
static const uint32_t no_record = UINT32_MAX;

/* A thread's counters, apart from the others' cache lines. */
typedef struct tally {
    _Alignas(64) ray_counters counters;
} tally;

/* What a thread draws a tile in; then come records of rays that have suspended, on their way to
 * their place, and the tile's kernel has the rest of the scratch. */
typedef struct easel {
    _Alignas(64) tile_outcome todo;
    char *records; /* BATCH */
    uint32_t suspended;
} easel;

struct drawing {
    const frame *f;
    uint32_t side; /* of a tile */
    uint32_t tiles_x, tiles;
    tally *tallies;
    /* Records of suspended rays, in chunks that come as they are needed; guarded by lock. */
    pthread_mutex_t lock;
    char **chunks;
    uint32_t records_made, free_head, reserved;
    /* Buckets: per treelet the list of rays that wait for it, and which treelets have one; guarded
     * by lock. Treelets of all volumes, numbered through. */
    uint32_t first[FRAME_VOLUMES_MAX + 1];
    uint32_t *bucket;
    uint32_t *waiting;
    uint32_t waiting_count;
    /* This pass: rays to resume, then tiles to start. */
    uint32_t *runnable;
    uint32_t runnable_count, runnable_room;
    size_t batches;
    uint32_t *tiles_now, *tiles_later; /* not drawn yet: of this pass; put off to the next */
    uint32_t tiles_left, tiles_off, tiles_waiting; /* the last: put off until treelets come */
    tile_row *to_do;                               /* `side` rows a tile: pixels not begun */
    loader_request *requests;
    atomic_size_t finished; /* pixels */
    ray_counters total;
};

static uint32_t tile_side(const frame *f) {
    return f->tracer->kind->tile_side;
}

static size_t records_bytes(const frame *f) {
    return (BATCH * f->integrator->record_bytes + 63) / 64 * 64;
}

uint32_t frame_records_min(const frame *f) {
    return (uint32_t)pool_threads(f->threads) * tile_side(f) * tile_side(f);
}

size_t frame_record_bytes(const frame *f) {
    return f->integrator->record_bytes + sizeof(uint32_t);
}

size_t frame_scratch_bytes(const frame *f) {
    return sizeof(easel) + records_bytes(f) + f->tracer->kind->tile_scratch;
}

static easel *easel_of(const frame *f, int worker) {
    char *own = (char *)f->scratch + (size_t)worker * frame_scratch_bytes(f);
    easel *e = (easel *)own;
    e->records = own + sizeof *e;
    e->todo.scratch = e->records + records_bytes(f);
    e->suspended = 0;
    return e;
}

static uint32_t tiles_of(uint32_t pixels, uint32_t side) {
    return (pixels + side - 1) / side;
}

static uint32_t treelets_of(const frame *f) {
    uint32_t treelets = 0;
    for (int v = 0; v < f->volumes; v++)
        treelets += f->tracer[v].layout->treelets;
    return treelets;
}

size_t frame_bytes(const frame *f, uint32_t records_max) {
    const uint32_t side = tile_side(f);
    const size_t tiles = (size_t)tiles_of(f->width, side) * tiles_of(f->height, side);
    const size_t chunks = records_max / CHUNK + 1;
    return treelets_of(f) * (2 * sizeof(uint32_t) + sizeof(loader_request)) +
           tiles * (2 * sizeof(uint32_t) + side * sizeof(tile_row)) +
           chunks * (sizeof(void *) + 192) + CHUNK * f->integrator->record_bytes +
           ((size_t)pool_threads(f->threads) + 1) * sizeof(tally);
}

static ray_record *record(const drawing *d, uint32_t i) {
    return (ray_record *)(d->chunks[i / CHUNK] + i % CHUNK * d->f->integrator->record_bytes);
}

/* ---- The order of treelets ---- */

static uint64_t priority_of(const frame *f, int volume, uint32_t t, uint32_t leg) {
    const tracer *tr = &f->tracer[volume];
    const ray_bundle rays = f->integrator->bundle(f, leg);
    return (uint64_t)leg << 32 | tr->kind->rank(tr, t, &rays);
}

static uint64_t priority_for(const frame *f, const ray_record *r) {
    return priority_of(f, r->volume, r->blocked, r->leg);
}

/* The volume of a treelet among those of all. */
static int volume_of(const drawing *d, uint32_t t) {
    int v = 0;
    while (t >= d->first[v + 1])
        v++;
    return v;
}

/* ---- Records and buckets; with the lock held ---- */

static status make_chunk(drawing *d) {
    const frame *f = d->f;
    const uint32_t left = f->records_max - d->records_made, count = left < CHUNK ? left : CHUNK;
    char *chunk = mem_array(f->m, count, f->integrator->record_bytes);
    if (!chunk)
        return ST_NOMEM;
    d->chunks[d->records_made / CHUNK] = chunk;
    for (uint32_t i = d->records_made + count; i-- > d->records_made;) {
        record(d, i)->next = d->free_head;
        d->free_head = i;
    }
    d->records_made += count;
    return ST_OK;
}

static void suspend(drawing *d, uint32_t i) {
    const frame *f = d->f;
    ray_record *r = record(d, i);
    const uint32_t t = d->first[r->volume] + r->blocked;
    if (d->bucket[t] == no_record) {
        d->waiting[d->waiting_count++] = t;
        loader_want(f->tracer[r->volume].treelets, r->blocked, priority_for(f, r));
    }
    r->next = d->bucket[t];
    d->bucket[t] = i;
}

static void release(drawing *d, uint32_t i) {
    record(d, i)->next = d->free_head;
    d->free_head = i;
}

/* ---- Work items ---- */

/* Pixels of a tile that are not begun. */
static tile_row *rows_to_do(const drawing *d, uint32_t tile) {
    return d->to_do + (size_t)tile * d->side;
}

static bool reserve(drawing *d, uint32_t count) {
    pthread_mutex_lock(&d->lock);
    const bool fits = d->reserved + count <= d->f->records_max;
    if (fits)
        d->reserved += count;
    pthread_mutex_unlock(&d->lock);
    return fits;
}

/* A tile whose rays met absent treelets asks for them and is taken up again when they have come;
 * but rays wait one by one where treelets have to take turns, and where a preview goes on without
 * them. */
static bool wait_for_treelets(drawing *d, uint32_t tile, const tile_outcome *todo) {
    const frame *f = d->f;
    loader *treelets = f->tracer->treelets;
    if (todo->absent_count == 0 || f->tracer->preview || !loader_has_room(treelets))
        return false;
    for (int i = 0; i < todo->absent_count; i++)
        loader_want(treelets, todo->absent[i], priority_of(f, 0, todo->absent[i], 0));
    memcpy(rows_to_do(d, tile), todo->waits, d->side * sizeof *todo->waits);
    pthread_mutex_lock(&d->lock);
    d->tiles_later[d->tiles_off++] = tile;
    d->tiles_waiting++;
    pthread_mutex_unlock(&d->lock);
    return true;
}

static void begin_tile(drawing *d, uint32_t tile, uint32_t x0, uint32_t y0, tile_outcome *todo,
                       ray_counters *counters) {
    const frame *f = d->f;
    if (!f->projection) {
        memcpy(todo->open, rows_to_do(d, tile), d->side * sizeof *todo->open);
        memset(todo->found, 0, sizeof todo->found);
        memset(todo->waits, 0, sizeof todo->waits);
        return;
    }
    f->integrator->tile(f)(f, x0, y0, rows_to_do(d, tile), todo, counters);
    if (wait_for_treelets(d, tile, todo))
        return;
    for (uint32_t y = 0; y < d->side; y++)
        todo->open[y] |= todo->waits[y];
    memset(todo->waits, 0, sizeof todo->waits);
}

static uint32_t pixels_of(const tile_row rows[], uint32_t side) {
    uint32_t count = 0;
    for (uint32_t y = 0; y < side; y++)
        count += (uint32_t)__builtin_popcount(rows[y]);
    return count;
}

/* The reservation has made sure of room. */
static status keep_suspended(drawing *d, easel *e) {
    const size_t bytes = d->f->integrator->record_bytes;
    status st = ST_OK;
    pthread_mutex_lock(&d->lock);
    for (uint32_t i = 0; i < e->suspended && st == ST_OK; i++) {
        if (d->free_head == no_record)
            st = make_chunk(d);
        if (st != ST_OK)
            break;
        const uint32_t r = d->free_head;
        d->free_head = record(d, r)->next;
        memcpy(record(d, r), e->records + i * bytes, bytes);
        suspend(d, r);
    }
    pthread_mutex_unlock(&d->lock);
    e->suspended = 0;
    return st;
}

static void unreserve(drawing *d, uint32_t count) {
    pthread_mutex_lock(&d->lock);
    d->reserved -= count;
    pthread_mutex_unlock(&d->lock);
}

/* What tiles have left to single rays of one row. *kept: how many were suspended, by then. */
static status draw_row(drawing *d, easel *e, uint32_t x0, uint32_t y0, uint32_t y, uint32_t *kept,
                       ray_counters *counters) {
    const frame *f = d->f;
    const integrator *in = f->integrator;
    const tile_outcome *todo = &e->todo;
    status st = ST_OK;
    for (tile_row left = todo->open[y] | todo->found[y]; left && st == ST_OK; left &= left - 1) {
        const uint32_t x = (uint32_t)__builtin_ctz(left), i = d->side * y + x;
        const uint32_t pixel = (y0 + y) * f->width + x0 + x;
        ray_record *r = (ray_record *)(e->records + e->suspended * in->record_bytes);
        if (todo->open[y] >> x & 1u)
            in->begin(f, pixel, r);
        else
            in->found(f, pixel, &todo->hits[i], todo->at[i], r);
        if (in->advance(f, r, counters))
            continue;
        ++*kept;
        if (++e->suspended == BATCH)
            st = keep_suspended(d, e);
    }
    return st;
}

/* Trace a tile's rays, all together as far as that goes. */
static status draw_tile(drawing *d, uint32_t tile, easel *e, ray_counters *counters) {
    uint32_t kept = 0;
    const uint32_t x0 = tile % d->tiles_x * d->side, y0 = tile / d->tiles_x * d->side;
    const uint32_t asked = pixels_of(rows_to_do(d, tile), d->side);
    begin_tile(d, tile, x0, y0, &e->todo, counters);
    status st = ST_OK;
    for (uint32_t y = 0; y < d->side && st == ST_OK; y++)
        st = draw_row(d, e, x0, y0, y, &kept, counters);
    if (st == ST_OK)
        st = keep_suspended(d, e);
    const uint32_t begun = asked - pixels_of(e->todo.waits, d->side);
    counters->primary_rays += begun;
    atomic_fetch_add_explicit(&d->finished, begun - kept, memory_order_relaxed);
    unreserve(d, d->side * d->side - kept);
    return st;
}

static void resume_batch(drawing *d, size_t batch, ray_counters *counters) {
    const size_t from = batch * BATCH;
    const size_t to = from + BATCH < d->runnable_count ? from + BATCH : d->runnable_count;
    bool done[BATCH];
    size_t finished = 0;
    for (size_t i = from; i < to; i++) {
        done[i - from] = d->f->integrator->advance(d->f, record(d, d->runnable[i]), counters);
        finished += done[i - from];
    }
    atomic_fetch_add_explicit(&d->finished, finished, memory_order_relaxed);
    pthread_mutex_lock(&d->lock);
    for (size_t i = from; i < to; i++) {
        if (done[i - from]) {
            release(d, d->runnable[i]);
            d->reserved--;
        } else {
            suspend(d, d->runnable[i]);
        }
    }
    pthread_mutex_unlock(&d->lock);
}

static void put_off(drawing *d, uint32_t tile) {
    pthread_mutex_lock(&d->lock);
    d->tiles_later[d->tiles_off++] = tile;
    pthread_mutex_unlock(&d->lock);
}

static double share_done(drawing *d) {
    const size_t finished = atomic_load_explicit(&d->finished, memory_order_relaxed);
    return (double)finished / ((double)d->f->width * d->f->height);
}

static status run_item(void *ctx, size_t index, int worker) {
    drawing *d = ctx;
    const frame *f = d->f;
    ray_counters *counters = &d->tallies[worker].counters;
    if (f->watch && !f->watch(f->watch_ctx, share_done(d)))
        return status_describe(ST_STOPPED, "stopped");
    if (index < d->batches) {
        resume_batch(d, index, counters);
        return ST_OK;
    }
    const uint32_t tile = d->tiles_now[index - d->batches];
    if (!reserve(d, d->side * d->side)) {
        put_off(d, tile);
        return ST_OK;
    }
    return draw_tile(d, tile, easel_of(f, worker), counters);
}

/* ---- Passes ---- */

/* Room for every record there is: most frames have none. */
static status make_room(drawing *d) {
    if (d->records_made <= d->runnable_room)
        return ST_OK;
    mem_free(d->f->m, d->runnable);
    d->runnable = mem_array(d->f->m, d->records_made, sizeof *d->runnable);
    d->runnable_room = d->runnable ? d->records_made : 0;
    return d->runnable ? ST_OK : ST_NOMEM;
}

/* Empty the buckets whose treelets have come. */
static status collect_runnable(drawing *d) {
    uint32_t kept = 0;
    status st = make_room(d);
    if (st != ST_OK)
        return st;
    d->runnable_count = 0;
    for (uint32_t i = 0; i < d->waiting_count; i++) {
        const uint32_t t = d->waiting[i];
        const int v = volume_of(d, t);
        if (!loader_lookup(d->f->tracer[v].treelets, t - d->first[v])) {
            d->waiting[kept++] = t;
            continue;
        }
        for (uint32_t r = d->bucket[t]; r != no_record; r = record(d, r)->next)
            d->runnable[d->runnable_count++] = r;
        d->bucket[t] = no_record;
    }
    d->waiting_count = kept;
    d->batches = (d->runnable_count + BATCH - 1) / BATCH;
    return ST_OK;
}

/* All rays wait: at least one treelet of each volume that some wait for comes. */
static status admit(drawing *d) {
    const frame *f = d->f;
    status st = ST_OK;
    for (int v = 0; v < f->volumes && st == ST_OK; v++) {
        size_t count = 0;
        for (uint32_t i = 0; i < d->waiting_count; i++) {
            const uint32_t t = d->waiting[i];
            if (t >= d->first[v] && t < d->first[v + 1])
                d->requests[count++] =
                    (loader_request){t - d->first[v], priority_for(f, record(d, d->bucket[t]))};
        }
        if (count > 0)
            st = loader_admit(f->tracer[v].treelets, d->requests, count);
    }
    return st;
}

/* The first volume's that has one. */
static status failure(const frame *f) {
    status st = ST_OK;
    for (int v = 0; v < f->volumes && st == ST_OK; v++)
        st = loader_failure(f->tracer[v].treelets);
    return st;
}

static status draw_passes(drawing *d, ray_counters *total) {
    const frame *f = d->f;
    for (;;) {
        status st = collect_runnable(d);
        if (st != ST_OK)
            return st;
        const bool room = d->tiles_left > 0 && d->reserved + d->side * d->side <= f->records_max;
        if (d->runnable_count == 0 && !room) {
            if (d->waiting_count == 0)
                return ST_OK;
            st = admit(d);
            if (st != ST_OK)
                return st;
            continue;
        }
        const uint32_t tiles = room ? d->tiles_left : 0;
        if (d->tiles_waiting > 0 && d->runnable_count == 0)
            st = loader_settle(f->tracer->treelets);
        if (st != ST_OK)
            return st;
        d->tiles_waiting = 0;
        if (room)
            d->tiles_off = 0;
        total->passes++;
        st = pool_run(f->threads, d->batches + tiles, run_item, d);
        if (st == ST_OK)
            st = failure(f);
        if (st != ST_OK)
            return st;
        if (room) {
            uint32_t *later = d->tiles_later;
            d->tiles_later = d->tiles_now;
            d->tiles_now = later;
            d->tiles_left = d->tiles_off;
        }
    }
}

static void drawing_release(drawing *d) {
    mem *m = d->f->m;
    for (uint32_t i = 0; i * CHUNK < d->records_made; i++)
        mem_free(m, d->chunks[i]);
    mem_free(m, d->requests);
    mem_free(m, d->runnable);
    mem_free(m, d->waiting);
    mem_free(m, d->bucket);
    mem_free(m, d->to_do);
    mem_free(m, d->tiles_later);
    mem_free(m, d->tiles_now);
    mem_free(m, d->chunks);
    mem_free(m, d->tallies);
    pthread_mutex_destroy(&d->lock);
}

/* A tile with all its pixels in the picture to do. */
static void begin_to_do(drawing *d, uint32_t tile) {
    const frame *f = d->f;
    const uint32_t x0 = tile % d->tiles_x * d->side, y0 = tile / d->tiles_x * d->side;
    const uint32_t columns = f->width - x0 < d->side ? f->width - x0 : d->side;
    for (uint32_t y = 0; y < d->side; y++)
        rows_to_do(d, tile)[y] = y0 + y < f->height ? (tile_row)((UINT64_C(1) << columns) - 1) : 0;
}

/* The even bits of a number below 2^8, together. */
static uint32_t even_bits(uint32_t n) {
    return (n & 1) | (n >> 1 & 2) | (n >> 2 & 4) | (n >> 3 & 8);
}

/* Squares of 8 x 8 tiles along a Z: what neighbours need is still in the cache. */
static void put_in_order(drawing *d) {
    enum { SIDE = 8 };
    const uint32_t tiles_y = d->tiles / d->tiles_x;
    uint32_t count = 0;
    for (uint32_t y0 = 0; y0 < tiles_y; y0 += SIDE) {
        for (uint32_t x0 = 0; x0 < d->tiles_x; x0 += SIDE) {
            for (uint32_t code = 0; code < SIDE * SIDE; code++) {
                const uint32_t x = x0 + even_bits(code), y = y0 + even_bits(code >> 1);
                if (x < d->tiles_x && y < tiles_y)
                    d->tiles_now[count++] = y * d->tiles_x + x;
            }
        }
    }
}

static status drawing_init(drawing *d, const frame *f) {
    const uint32_t treelets = treelets_of(f), side = tile_side(f);
    const int threads = pool_threads(f->threads);
    *d = (drawing){
        .f = f, .side = side, .tiles_x = tiles_of(f->width, side), .free_head = no_record};
    pthread_mutex_init(&d->lock, NULL);
    for (int v = 0; v < f->volumes; v++)
        d->first[v + 1] = d->first[v] + f->tracer[v].layout->treelets;
    d->tiles = d->tiles_left = d->tiles_x * tiles_of(f->height, side);
    d->tallies = mem_array(f->m, (size_t)threads, sizeof *d->tallies);
    d->chunks = mem_array(f->m, f->records_max / CHUNK + 1, sizeof *d->chunks);
    d->tiles_now = mem_array(f->m, d->tiles, sizeof *d->tiles_now);
    d->tiles_later = mem_array(f->m, d->tiles, sizeof *d->tiles_later);
    d->to_do = mem_array(f->m, d->tiles, side * sizeof *d->to_do);
    d->bucket = mem_array(f->m, treelets, sizeof *d->bucket);
    d->waiting = mem_array(f->m, treelets, sizeof *d->waiting);
    d->requests = mem_array(f->m, treelets, sizeof *d->requests);
    if (!d->tallies || !d->chunks || !d->tiles_now || !d->tiles_later || !d->to_do || !d->bucket ||
        !d->waiting || !d->requests)
        return ST_NOMEM;
    for (uint32_t i = 0; i < d->tiles; i++)
        begin_to_do(d, i);
    put_in_order(d);
    for (uint32_t t = 0; t < treelets; t++)
        d->bucket[t] = no_record;
    return ST_OK;
}

status frame_begin(const frame *f, drawing **out) {
    drawing *d = *out = mem_zalloc(f->m, sizeof *d);
    return d ? drawing_init(d, f) : ST_NOMEM;
}

status frame_advance(drawing *d, double until, bool *done) {
    (void)until;
    const status st = draw_passes(d, &d->total);
    *done = st == ST_OK;
    return st;
}

void frame_end(drawing *d, ray_counters *counters) {
    if (!d)
        return;
    ray_counters_add(counters, &d->total);
    for (int i = 0; d->tallies && i < pool_threads(d->f->threads); i++)
        ray_counters_add(counters, &d->tallies[i].counters);
    drawing_release(d);
    mem_free(d->f->m, d);
}

status frame_render(const frame *f, ray_counters *counters) {
    drawing *d = NULL;
    bool done;
    status st = frame_begin(f, &d);
    if (st == ST_OK)
        st = frame_advance(d, INFINITY, &done);
    frame_end(d, counters);
    return st;
}
