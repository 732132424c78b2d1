#include "render/frame/frame.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

#include "render/frame/frame_work.h"
#include "render/frame/ray_advance.h"
#include "render/ray/kind.h"

/* A thread's counters and work in hand, on cache lines of its own. */
typedef struct tally {
    _Alignas(64) ray_counters counters;
    atomic_size_t finished; /* pixels */
    work_hand hand;
} tally;

/* The head of a thread's scratch. Room for a batch of rays follows, and room for integrator.take().
 * The room between them serves a tile's kernel first. Then it holds the rays that go on together,
 * with their records.
 */
typedef struct easel {
    _Alignas(64) tile_outcome todo;
    ray_group *rays;
    char *records; /* WORK_BATCH */
    ray_pieces *pieces;
} easel;
_Static_assert((int)WORK_BATCH == (int)RAY_BATCH, "an item's rays go on together");

struct drawing {
    const frame *f;
    uint32_t side; /* of a tile */
    uint32_t tiles_x, tiles;
    tally *tallies;
    ray_records records;
    frame_work work;
    tile_row *to_do; /* `side` rows a tile: pixels not begun */
    uint32_t *first; /* per tile: where the walk through its pixels to do begins (tile.h) */
    uint64_t rounds;
};

static size_t up_to_64(size_t bytes) {
    return (bytes + 63) / 64 * 64;
}

uint32_t frame_records_min(const frame *f) {
    return (uint32_t)pool_threads(f->threads) * kind_tile_side(f->tracer->kind) *
           kind_tile_side(f->tracer->kind);
}

size_t frame_record_bytes(const frame *f) {
    return f->integrator->record_bytes + f->record_more;
}

static size_t group_bytes(const frame *f) {
    return up_to_64(sizeof(ray_group) + WORK_BATCH * frame_record_bytes(f));
}

/* Returns the bytes of the room that serves a tile's kernel first, then rays that go on together.
 */
static size_t shared_scratch(const frame *f) {
    const size_t tile = up_to_64(f->tracer->kind->tiles ? f->tracer->kind->tiles->scratch : 0),
                 group = group_bytes(f);
    return tile > group ? tile : group;
}

static size_t batch_scratch(const frame *f) {
    size_t most = 0;
    for (int v = 0; v < f->volumes; v++) {
        const size_t own = kind_batch_scratch(f->tracer[v].kind);
        const tracer *other = f->stand_ins ? f->stand_ins[v] : NULL;
        const size_t others = other ? kind_batch_scratch(other->kind) : 0;
        most = own > most ? own : most;
        most = others > most ? others : most;
    }
    return up_to_64(most);
}

static size_t pieces_bytes(const frame *f) {
    return f->integrator->take ? ray_pieces_bytes(f->integrator) : 0;
}

size_t frame_scratch_bytes(const frame *f) {
    return sizeof(easel) + up_to_64(sizeof(ray_batch)) + batch_scratch(f) + shared_scratch(f) +
           pieces_bytes(f);
}

static easel *easel_of(const frame *f, int worker) {
    char *own = (char *)f->scratch + (size_t)worker * frame_scratch_bytes(f);
    easel *e = (easel *)own;
    char *batch = own + sizeof *e, *batch_scratch_at = batch + up_to_64(sizeof(ray_batch));
    char *shared = batch_scratch_at + batch_scratch(f);
    e->todo.batch = (ray_batch *)batch;
    e->todo.batch_scratch = batch_scratch_at;
    e->todo.scratch = shared;
    e->rays = (ray_group *)shared;
    e->records = shared + sizeof *e->rays;
    e->pieces = (ray_pieces *)(shared + shared_scratch(f));
    return e;
}

static uint32_t tiles_of(uint32_t pixels, uint32_t side) {
    return (pixels + side - 1) / side;
}

size_t frame_bytes(const frame *f, uint32_t records_max) {
    const uint32_t side = kind_tile_side(f->tracer->kind);
    const size_t tiles = (size_t)tiles_of(f->width, side) * tiles_of(f->height, side);
    return frame_work_bytes(f, tiles) + ray_records_bytes(frame_record_bytes(f), records_max) +
           tiles * (side * sizeof(tile_row) + sizeof(uint32_t)) +
           ((size_t)pool_threads(f->threads) + 1) * sizeof(tally) + sizeof(drawing) + 128;
}

/* ---- Work items ---- */

/* Pixels of a tile that are not begun. */
static tile_row *rows_to_do(const drawing *d, uint32_t tile) {
    return d->to_do + (size_t)tile * d->side;
}

/* If rays of a tile met absent treelets, let the tile wait for these; another thread may take it up
 * as soon as they come. Returns false if the tile is not to wait: no treelet was absent, there may
 * be no slots for them, or they may be done without. */
static bool wait_for_treelets(drawing *d, uint32_t tile, const tile_outcome *todo, tally *mine) {
    if (todo->absent_count == 0 || d->f->tracer->preview || d->f->tracer->lenient)
        return false;
    memcpy(rows_to_do(d, tile), todo->waits, d->side * sizeof *todo->waits);
    return frame_work_wait(&d->work, &mine->hand, tile, todo->absent, todo->absent_count);
}

static void begin_tile(drawing *d, uint32_t tile, uint32_t x0, uint32_t y0, tile_outcome *todo,
                       tally *mine) {
    const frame *f = d->f;
    const tile_fn together = f->integrator->tile ? f->integrator->tile(f) : NULL;
    if (!together) {
        memcpy(todo->open, rows_to_do(d, tile), d->side * sizeof *todo->open);
        memset(todo->waits, 0, sizeof todo->waits);
        return;
    }
    todo->first = d->first[tile];
    together(f, x0, y0, rows_to_do(d, tile), todo, &mine->counters);
    d->first[tile] = todo->first;
    if (wait_for_treelets(d, tile, todo, mine))
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

static void advance(const drawing *d, easel *e, tally *mine) {
    ray_advance(d->f, e->rays, e->todo.batch, e->pieces, e->todo.batch_scratch, &mine->counters);
}

/* Copy blocked rays to records, which were promised, and suspend them. */
static status keep_blocked(drawing *d, const ray_group *rays, uint32_t *count, work_hand *own) {
    uint32_t kept[WORK_BATCH];
    status st = ST_OK;
    *count = 0;
    for (uint32_t i = 0; i < rays->count && st == ST_OK; i++) {
        uint32_t *to = &kept[*count];
        if (!rays->blocked[i])
            continue;
        st = ray_records_take(&d->records, &own->reserve, to);
        if (st == ST_OK)
            memcpy(ray_records_at(&d->records, *to), rays->record[i], frame_record_bytes(d->f));
        ++*count;
    }
    if (st == ST_OK && *count > 0)
        frame_work_suspend(&d->work, own, kept, *count);
    return st;
}

static void count_finished(tally *t, size_t pixels) {
    const size_t before = atomic_load_explicit(&t->finished, memory_order_relaxed);
    atomic_store_explicit(&t->finished, before + pixels, memory_order_relaxed);
}

/* The rays of a square of pixels go on together: it has as many as a work item. */
enum { SQUARE = 16 };
_Static_assert(SQUARE *SQUARE == WORK_BATCH && TILE_MAX % SQUARE == 0, "a square is an item");

/* Begin the pixels that the kernel left open in the square at (x, y); x0, y0: the tile. */
static void begin_square(const drawing *d, easel *e, uint32_t x0, uint32_t y0, uint32_t x,
                         uint32_t y) {
    const frame *f = d->f;
    ray_group *rays = e->rays;
    const uint32_t end = y + SQUARE < d->side ? y + SQUARE : d->side;
    rays->count = 0;
    for (uint32_t row = y; row < end; row++) {
        tile_row left = e->todo.open[row] >> x & ((UINT32_C(1) << SQUARE) - 1);
        for (; left; left &= left - 1) {
            const uint32_t column = x0 + x + (uint32_t)__builtin_ctz(left);
            char *record = e->records + rays->count * frame_record_bytes(f);
            rays->record[rays->count] = (ray_record *)record;
            f->integrator->begin(f, (y0 + row) * f->width + column, (ray_record *)record);
            rays->count++;
        }
    }
}

/* Trace the pixels that the kernel left open. Adds the number of suspended rays to *kept. */
static status draw_rest(drawing *d, easel *e, uint32_t x0, uint32_t y0, uint32_t *kept,
                        tally *mine) {
    status st = ST_OK;
    for (uint32_t y = 0; y < d->side; y += SQUARE) {
        for (uint32_t x = 0; x < d->side && st == ST_OK; x += SQUARE) {
            uint32_t count = 0;
            begin_square(d, e, x0, y0, x, y);
            advance(d, e, mine);
            st = keep_blocked(d, e->rays, &count, &mine->hand);
            *kept += count;
        }
    }
    return st;
}

/* Trace a tile's rays: first by the kernel of tiles, then the ones that it left. */
static status draw_tile(drawing *d, uint32_t tile, easel *e, tally *mine) {
    uint32_t kept = 0;
    const uint32_t x0 = tile % d->tiles_x * d->side, y0 = tile / d->tiles_x * d->side;
    const uint32_t asked = pixels_of(rows_to_do(d, tile), d->side);
    begin_tile(d, tile, x0, y0, &e->todo, mine);
    const status st = draw_rest(d, e, x0, y0, &kept, mine);
    const uint32_t begun = asked - pixels_of(e->todo.waits, d->side);
    mine->counters.primary_rays += begun;
    count_finished(mine, begun - kept);
    if (begun > 0)
        frame_work_progress(&d->work);
    return st;
}

static void resume_rays(drawing *d, const work_item *item, easel *e, tally *mine) {
    uint32_t left[WORK_BATCH], count = 0;
    e->rays->count = item->count;
    for (uint32_t i = 0; i < item->count; i++)
        e->rays->record[i] = ray_records_at(&d->records, item->rays[i]);
    advance(d, e, mine);
    for (uint32_t i = 0; i < item->count; i++) {
        if (e->rays->blocked[i])
            left[count++] = item->rays[i];
        else
            ray_records_give(&d->records, &mine->hand.reserve, item->rays[i]);
    }
    count_finished(mine, item->count - count);
    frame_work_progress(&d->work);
    frame_work_suspend(&d->work, &mine->hand, left, count);
}

static double share_done(const drawing *d) {
    size_t finished = 0;
    for (int i = 0; i < pool_threads(d->f->threads); i++)
        finished += atomic_load_explicit(&d->tallies[i].finished, memory_order_relaxed);
    return (double)finished / ((double)d->f->width * d->f->height);
}

static status draw_item(drawing *d, const work_item *item, int worker) {
    const frame *f = d->f;
    tally *mine = &d->tallies[worker];
    if (f->watch && !f->watch(f->watch_ctx, share_done(d)))
        return status_describe(ST_STOPPED, "stopped");
    easel *e = easel_of(f, worker);
    if (item->is_tile)
        return draw_tile(d, item->tile, e, mine);
    resume_rays(d, item, e, mine);
    return ST_OK;
}

/* One thread's part in a round. */
static status draw_items(void *ctx, size_t index, int worker) {
    drawing *d = ctx;
    work_item item;
    status st = ST_OK;
    (void)index;
    frame_work_enter(&d->work);
    while (st == ST_OK && frame_work_take(&d->work, &d->tallies[worker].hand, &item))
        st = draw_item(d, &item, worker);
    if (st != ST_OK)
        frame_work_stop(&d->work);
    frame_work_leave(&d->work, &d->tallies[worker].hand);
    return st;
}

/* Returns the failure of the first loader that has one, else ST_OK. */
static status failure(const frame *f) {
    status st = ST_OK;
    for (int v = 0; v < f->volumes + f->lookups && st == ST_OK; v++)
        if (f->tracer[v].twin == v)
            st = loader_failure(f->tracer[v].treelets);
    return st;
}

/* Run a round on all threads: until the frame is done, treelets must be evicted to go on, or the
 * time is over. */
static status draw_round(drawing *d) {
    const frame *f = d->f;
    d->rounds++;
    status st = pool_run(f->threads, (size_t)pool_threads(f->threads), draw_items, d);
    if (st == ST_OK)
        st = failure(f);
    if (st == ST_OK && f->cancel && atomic_load(f->cancel))
        st = status_describe(ST_STOPPED, "stopped");
    return st;
}

status frame_advance(drawing *d, double until, bool *done) {
    status st = ST_OK;
    *done = false;
    frame_work_begin(&d->work, until);
    for (bool again = true; again && st == ST_OK;) {
        st = draw_round(d);
        *done = st == ST_OK && frame_work_done(&d->work);
        again = !*done && !frame_work_late(&d->work);
        if (again && st == ST_OK)
            st = frame_work_admit(&d->work);
    }
    frame_work_end(&d->work);
    return st;
}

/* Mark all pixels of a tile that lie in the picture as to do. */
static void begin_to_do(drawing *d, uint32_t tile) {
    const frame *f = d->f;
    const uint32_t x0 = tile % d->tiles_x * d->side, y0 = tile / d->tiles_x * d->side;
    const uint32_t columns = f->width - x0 < d->side ? f->width - x0 : d->side;
    for (uint32_t y = 0; y < d->side; y++)
        rows_to_do(d, tile)[y] = y0 + y < f->height ? (tile_row)((UINT64_C(1) << columns) - 1) : 0;
}

/* Gather the even bits of a number below 2^8. */
static uint32_t even_bits(uint32_t n) {
    return (n & 1) | (n >> 1 & 2) | (n >> 2 & 4) | (n >> 3 & 8);
}

/* Order tiles in squares of 8 x 8 along a Z curve: data that neighbours share is then still
 * cached. */
static void put_in_order(drawing *d) {
    enum { SIDE = 8 };
    const uint32_t tiles_y = d->tiles / d->tiles_x;
    uint32_t count = 0;
    for (uint32_t y0 = 0; y0 < tiles_y; y0 += SIDE) {
        for (uint32_t x0 = 0; x0 < d->tiles_x; x0 += SIDE) {
            for (uint32_t code = 0; code < SIDE * SIDE; code++) {
                const uint32_t x = x0 + even_bits(code), y = y0 + even_bits(code >> 1);
                if (x < d->tiles_x && y < tiles_y)
                    d->work.order[count++] = y * d->tiles_x + x;
            }
        }
    }
}

static status drawing_init(drawing *d, const frame *f) {
    const uint32_t side = kind_tile_side(f->tracer->kind);
    *d = (drawing){.f = f, .side = side, .tiles_x = tiles_of(f->width, side)};
    d->tiles = d->tiles_x * tiles_of(f->height, side);
    const status records =
        ray_records_init(&d->records, f->m, frame_record_bytes(f), f->records_max);
    const status work = frame_work_init(&d->work, f, &d->records, d->tiles);
    d->tallies = mem_array(f->m, (size_t)pool_threads(f->threads), sizeof *d->tallies);
    d->to_do = mem_array(f->m, d->tiles, side * sizeof *d->to_do);
    d->first = mem_array(f->m, d->tiles, sizeof *d->first);
    if (records != ST_OK || work != ST_OK || !d->tallies || !d->to_do || !d->first)
        return ST_NOMEM;
    for (uint32_t i = 0; i < d->tiles; i++)
        begin_to_do(d, i);
    put_in_order(d);
    return ST_OK;
}

status frame_begin(const frame *f, drawing **out) {
    drawing *d = mem_alloc(f->m, sizeof *d);
    if (!d)
        return ST_NOMEM;
    const status st = drawing_init(d, f);
    if (st == ST_OK)
        *out = d;
    else
        frame_end(d, NULL);
    return st;
}

static void add_counters(const drawing *d, ray_counters *total) {
    total->passes += d->rounds;
    for (int i = 0; i < pool_threads(d->f->threads); i++)
        ray_counters_add(total, &d->tallies[i].counters);
}

void frame_end(drawing *d, ray_counters *total) {
    if (!d)
        return;
    mem *m = d->f->m;
    if (total && d->tallies)
        add_counters(d, total);
    frame_work_release(&d->work);
    ray_records_release(&d->records);
    mem_free(m, d->first);
    mem_free(m, d->to_do);
    mem_free(m, d->tallies);
    mem_free(m, d);
}

status frame_render(const frame *f, ray_counters *counters) {
    drawing *d = NULL;
    bool done = false;
    status st = frame_begin(f, &d);
    if (st == ST_OK)
        st = frame_advance(d, (double)INFINITY, &done);
    frame_end(d, counters);
    return st;
}
