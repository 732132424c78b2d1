#include "render/frame/frame_work.h"

#include <math.h>

#include "formats/base/clock.h"
#include "render/ray/kind.h"

enum { NONE = -1, NOT_READY = -2 }; /* end of a list; not in the list of ready buckets */
static const uint32_t none = (uint32_t)NONE, not_ready = (uint32_t)NOT_READY;

/* ---- The order of treelets ---- */

/* A treelet to be requested. */
typedef struct wish {
    int volume;
    uint32_t t, leg;
} wish;

static wish wish_of(const ray_record *r) {
    return (wish){r->volume, r->blocked, r->leg};
}

static uint64_t priority_of(const frame *f, wish w) {
    const tracer *tr = &f->tracer[w.volume];
    const ray_bundle all = f->integrator->bundle(f, w.leg), rays = tracer_bundle(tr, &all);
    return (uint64_t)w.leg << 32 | tr->kind->walks->rank(tr, w.t, &rays);
}

/* Request up to WORK_BATCH treelets. */
static void ask_for(const frame *f, const wish wishes[], uint32_t count) {
    loader_request requests[WORK_BATCH];
    for (uint32_t i = 0, run = 0; i < count; i += run) {
        loader *from = f->tracer[wishes[i].volume].treelets;
        for (run = 0; i + run < count && wishes[i + run].volume == wishes[i].volume; run++)
            requests[run] = (loader_request){wishes[i + run].t, priority_of(f, wishes[i + run])};
        loader_want(from, requests, run);
    }
}

/* ---- Buckets; with the lock held ---- */

/* Bucket t's treelet is READY: append the bucket to the list of buckets that are ready, unless it
 * is in the list or empty. */
static void bucket_ready(frame_work *w, uint32_t t) {
    work_bucket *b = &w->buckets[t];
    if (b->next != not_ready || (b->rays == none && b->tiles == none))
        return;
    b->next = none;
    if (w->ready_first == none)
        w->ready_first = t;
    else
        w->buckets[w->ready_last].next = t;
    w->ready_last = t;
}

/* Call before something is put into a treelet's bucket. Returns whether the bucket was empty. */
static bool begin_waiting(frame_work *w, uint32_t t) {
    const work_bucket *b = &w->buckets[t];
    const bool first = b->rays == none && b->tiles == none;
    if (first)
        w->waiting[w->waiting_count++] = t;
    return first;
}

static void push_ray(frame_work *w, work_bucket *b, uint32_t record) {
    ray_records_at(w->records, record)->next = b->rays;
    b->rays = record;
    w->hung_up++;
}

static uint32_t pop_ray(frame_work *w, work_bucket *b) {
    const uint32_t record = b->rays;
    b->rays = ray_records_at(w->records, record)->next;
    w->hung_up--;
    return record;
}

static void push_tile(frame_work *w, uint32_t *list, uint32_t tile) {
    w->tiles[tile].next = *list;
    *list = tile;
}

static uint32_t pop_tile(frame_work *w, uint32_t *list) {
    const uint32_t tile = *list;
    *list = w->tiles[tile].next;
    return tile;
}

/* Put a ray into its treelet's bucket. Returns whether the caller must request the treelet: nothing
 * else waits for it, and it is still absent. */
static bool hang_up_ray(frame_work *w, uint32_t record) {
    const ray_record *r = ray_records_at(w->records, record);
    const uint32_t t = w->numbers[r->volume].first + r->blocked;
    const bool ready = loader_has_come(w->f->tracer[r->volume].treelets, r->blocked);
    const bool first = !ready && begin_waiting(w, t);
    push_ray(w, &w->buckets[t], record);
    if (ready)
        bucket_ready(w, t);
    return first;
}

/* Put a tile into the bucket of one of its absent treelets. If all of them are READY, put it among
 * the tiles that can go on. */
static void hang_up_tile(frame_work *w, uint32_t tile) {
    const work_tile *x = &w->tiles[tile];
    for (uint32_t i = 0; i < x->absent_count; i++) {
        const uint32_t t = x->absent[i];
        if (loader_has_come(w->f->tracer->treelets, t))
            continue;
        (void)begin_waiting(w, t);
        push_tile(w, &w->buckets[t].tiles, tile);
        w->hung_up++;
        return;
    }
    push_tile(w, &w->resumable, tile);
}

/* With the lock held: put the waiting tiles of a thread's hand into buckets. */
static void hang_up_hand(frame_work *w, work_hand *own) {
    while (own->tile_count > 0)
        hang_up_tile(w, own->tiles[--own->tile_count]);
}

/* ---- Arrivals ---- */

/* Whether any loader has arrivals. Takes no lock. */
static bool has_arrivals(const frame_work *w) {
    bool any = false;
    for (int i = 0; i < w->loader_count && !any; i++)
        any = arrivals_any(&w->numbers[i].from->arrivals);
    return any;
}

/* With the lock held: take all arrivals of the loaders. Returns whether all of them are READY. */
static bool take_arrivals(frame_work *w) {
    bool all = true;
    for (int i = 0; i < w->loader_count; i++) {
        loader *from = w->numbers[i].from;
        for (uint32_t t = arrivals_take(&from->arrivals), after; t != arrivals_end; t = after) {
            after = arrivals_after(&from->arrivals, t);
            if (loader_has_come(from, t))
                bucket_ready(w, w->numbers[i].first_of + t);
            else
                all = false;
        }
    }
    return all;
}

/* ---- Taking; with the lock held ---- */

static bool tile_left(frame_work *w) {
    return atomic_load_explicit(&w->tiles_begun, memory_order_relaxed) < w->tile_count;
}

static bool next_tile(frame_work *w, uint32_t *tile) {
    if (!tile_left(w))
        return false;
    const uint32_t i = atomic_fetch_add_explicit(&w->tiles_begun, 1, memory_order_relaxed);
    if (i >= w->tile_count)
        return false;
    *tile = w->order[i];
    return true;
}

/* Whether the round is over, as far as is known without the lock. */
static bool is_over(const frame_work *w) {
    return atomic_load_explicit(&w->over, memory_order_relaxed);
}

/* Whether there is work for one more thread. */
static bool has_work(frame_work *w) {
    const bool rays = w->ready_first != none, tiles = w->resumable != none;
    atomic_store_explicit(&w->look, rays || tiles || is_over(w), memory_order_relaxed);
    return rays || ((tiles || tile_left(w)) && ray_records_unpromised(w->records) >= w->tile_rays);
}

/* Unlock; call it after any change of what can be done. Wakes a thread if there is work for it;
 * that thread wakes the next. The lock is released first, since the woken thread takes it soon. */
static void unlock_and_wake(frame_work *w) {
    const bool claimed = has_work(w) && sleepers_claim(&w->sleepers);
    pthread_mutex_unlock(&w->lock);
    if (claimed)
        sleepers_wake(&w->sleepers);
}

static bool take_rays(frame_work *w, work_item *item) {
    item->is_tile = false;
    item->count = 0;
    while (item->count == 0 && w->ready_first != none) {
        work_bucket *b = &w->buckets[w->ready_first];
        while (b->tiles != none) {
            w->hung_up--;
            hang_up_tile(w, pop_tile(w, &b->tiles));
        }
        while (b->rays != none && item->count < WORK_BATCH)
            item->rays[item->count++] = pop_ray(w, b);
        if (b->rays == none) {
            w->ready_first = b->next;
            b->next = not_ready;
        }
    }
    return item->count > 0;
}

static bool take_tile(frame_work *w, ray_reserve *own, work_item *item) {
    item->is_tile = true;
    if (w->resumable == none && !tile_left(w))
        return false;
    if (!ray_records_promise(w->records, own, w->tile_rays))
        return false;
    if (w->resumable == none)
        return next_tile(w, &item->tile);
    item->tile = pop_tile(w, &w->resumable);
    return true;
}

static void end_round(frame_work *w) {
    atomic_store_explicit(&w->over, true, memory_order_relaxed);
    (void)has_work(w);
    sleepers_wake_all(&w->sleepers);
}

static bool loaders_read(const frame_work *w) {
    bool reading = false;
    for (int i = 0; i < w->loader_count && !reading; i++)
        reading = loader_is_reading(w->numbers[i].from);
    return reading;
}

bool frame_work_late(const frame_work *w) {
    return w->until < (double)INFINITY &&
           atomic_load_explicit(&w->progress, memory_order_relaxed) && clock_seconds() >= w->until;
}

/* Whether a treelet has arrived, or a read is under way whose end will wake a thread. */
static bool more_comes(const frame_work *w) {
    return loaders_read(w) || has_arrivals(w);
}

/* The time at which a sleeping thread must wake. */
static double alarm_time(const frame_work *w) {
    const bool timed = atomic_load_explicit(&w->progress, memory_order_relaxed);
    return timed ? w->until : (double)INFINITY;
}

static bool is_cancelled(const frame *f) {
    return f->cancel && atomic_load_explicit(f->cancel, memory_order_relaxed);
}

/* With the lock held: end the round if a read failed, the frame is cancelled, or the time is over.
 * Returns whether the round is over. */
static bool look_over(frame_work *w) {
    const bool failed = !take_arrivals(w);
    if (!is_over(w) && (failed || is_cancelled(w->f) || frame_work_late(w)))
        end_round(w);
    return is_over(w);
}

/* Returns whether this thread is to sleep until something changes. If it is the last thread awake
 * and nothing will change, end the round instead.
 */
static bool lie_down_or_end(frame_work *w, work_hand *own) {
    /* Give records back: other threads may wait for them. The last thread awake must see them when
     * it looks whether there are any. */
    (void)ray_records_keep(w->records, &own->reserve, 0);
    const bool last = sleepers_lie_down(&w->sleepers) == atomic_load(&w->inside);
    const bool ends = last && !(w->hung_up > 0 && more_comes(w));
    if (!ends && !has_arrivals(w))
        return true;
    sleepers_get_up(&w->sleepers);
    if (ends)
        end_round(w);
    return false;
}

/* Put the tiles of the hand into buckets, without taking an item. */
static void put_down_hand(frame_work *w, work_hand *own) {
    if (own->tile_count == 0)
        return;
    pthread_mutex_lock(&w->lock);
    hang_up_hand(w, own);
    unlock_and_wake(w);
}

void frame_work_enter(frame_work *w) {
    atomic_fetch_add(&w->inside, 1);
}

void frame_work_leave(frame_work *w, work_hand *own) {
    (void)ray_records_keep(w->records, &own->reserve, 0);
    put_down_hand(w, own);
    atomic_fetch_sub(&w->inside, 1);
}

/* Take a tile to begin while nothing else can be done. Takes no lock. */
static bool take_quickly(frame_work *w, const work_hand *own, work_item *item) {
    item->is_tile = true;
    return !atomic_load_explicit(&w->look, memory_order_relaxed) && !has_arrivals(w) &&
           own->reserve.promised >= w->tile_rays && !is_cancelled(w->f) && !frame_work_late(w) &&
           next_tile(w, &item->tile);
}

bool frame_work_take(frame_work *w, work_hand *own, work_item *item) {
    if (take_quickly(w, own, item))
        return true;
    bool got = false;
    while (!got && !is_over(w)) {
        pthread_mutex_lock(&w->lock);
        hang_up_hand(w, own);
        const bool over = look_over(w);
        got = !over && (take_rays(w, item) || take_tile(w, &own->reserve, item));
        const bool lies = !over && !got && lie_down_or_end(w, own);
        unlock_and_wake(w);
        if (lies)
            sleepers_sleep(&w->sleepers, alarm_time(w));
    }
    return got;
}

/* ---- Waiting ---- */

void frame_work_suspend(frame_work *w, work_hand *own, const uint32_t rays[], uint32_t count) {
    wish wishes[WORK_BATCH];
    uint32_t wished = 0;
    const bool gave = ray_records_keep(w->records, &own->reserve, w->tile_rays);
    if (count == 0 && !gave)
        return;
    pthread_mutex_lock(&w->lock);
    for (uint32_t i = 0; i < count; i++)
        if (hang_up_ray(w, rays[i]))
            wishes[wished++] = wish_of(ray_records_at(w->records, rays[i]));
    unlock_and_wake(w);
    ask_for(w->f, wishes, wished);
}

/* Keep a waiting tile in the thread's hand. Its treelets have been requested, so other threads need
 * not see it yet. */
static void take_in_hand(frame_work *w, work_hand *own, uint32_t tile) {
    own->tiles[own->tile_count++] = tile;
    if (own->tile_count == WORK_HAND)
        put_down_hand(w, own);
}

bool frame_work_wait(frame_work *w, work_hand *own, uint32_t tile, const tile_treelet absent[],
                     int count) {
    work_tile *x = &w->tiles[tile];
    if (!loader_has_room(w->f->tracer->treelets))
        return false;
    wish wishes[TILE_ABSENT_MAX] = {{0}};
    for (int i = 0; i < count; i++)
        wishes[i] = (wish){0, absent[i].t, absent[i].leg};
    ask_for(w->f, wishes, (uint32_t)count);
    x->absent_count = count < WORK_ABSENT_MAX ? (uint32_t)count : WORK_ABSENT_MAX;
    for (uint32_t i = 0; i < x->absent_count; i++)
        x->absent[i] = absent[i].t;
    take_in_hand(w, own, tile);
    return true;
}

void frame_work_stop(frame_work *w) {
    pthread_mutex_lock(&w->lock);
    end_round(w);
    pthread_mutex_unlock(&w->lock);
}

/* ---- Between rounds ---- */

/* Make all waiting tiles resumable. Keep in `waiting` only treelets that rays still wait for.
 * Returns whether there were any tiles. */
static bool look_over_waiting(frame_work *w) {
    bool tiles = false;
    uint32_t kept = 0;
    for (uint32_t i = 0; i < w->waiting_count; i++) {
        work_bucket *b = &w->buckets[w->waiting[i]];
        while (b->tiles != none) {
            w->hung_up--;
            push_tile(w, &w->resumable, pop_tile(w, &b->tiles));
            tiles = true;
        }
        if (b->rays != none)
            w->waiting[kept++] = w->waiting[i];
    }
    w->waiting_count = kept;
    return tiles;
}

/* The wish of the first ray in a treelet's bucket. */
static wish wish_for(const frame_work *w, uint32_t t) {
    return wish_of(ray_records_at(w->records, w->buckets[t].rays));
}

/* Write requests for all treelets of a loader that rays wait for to w->requests. Returns their
 * number. */
static size_t collect_requests(frame_work *w, const loader *from) {
    size_t count = 0;
    pthread_mutex_lock(&w->lock);
    for (uint32_t i = 0; i < w->waiting_count; i++) {
        const wish x = wish_for(w, w->waiting[i]);
        if (w->f->tracer[x.volume].treelets == from)
            w->requests[count++] = (loader_request){x.t, priority_of(w->f, x)};
    }
    pthread_mutex_unlock(&w->lock);
    return count;
}

bool frame_work_done(frame_work *w) {
    pthread_mutex_lock(&w->lock);
    const bool done = w->hung_up == 0 && w->resumable == none && !tile_left(w);
    pthread_mutex_unlock(&w->lock);
    return done;
}

status frame_work_admit(frame_work *w) {
    status st = ST_OK;
    pthread_mutex_lock(&w->lock);
    atomic_store_explicit(&w->over, false, memory_order_relaxed);
    const bool tiles = look_over_waiting(w);
    (void)has_work(w);
    pthread_mutex_unlock(&w->lock);
    /* Each loader that rays wait for brings at least one treelet. */
    for (int i = 0; i < w->loader_count && !tiles && st == ST_OK; i++) {
        loader *from = w->numbers[i].from;
        const size_t count = collect_requests(w, from);
        if (count > 0)
            st = loader_admit(from, w->requests, count);
    }
    /* Treelets that came meanwhile may have been evicted again: that is no failure. */
    pthread_mutex_lock(&w->lock);
    (void)take_arrivals(w);
    (void)has_work(w);
    pthread_mutex_unlock(&w->lock);
    return st;
}

/* Sort all buckets anew into ready ones and waiting ones. Other frames may have been
 * drawn since the last time: treelets that were READY may be evicted, and no request is left. */
static void sort_buckets(frame_work *w) {
    w->ready_first = none;
    w->waiting_count = 0;
    for (uint32_t t = 0; t < w->treelets; t++) {
        work_bucket *b = &w->buckets[t];
        b->next = not_ready;
        for (; b->tiles != none; w->hung_up--)
            push_tile(w, &w->resumable, pop_tile(w, &b->tiles));
        if (b->rays == none)
            continue;
        const wish x = wish_for(w, t);
        if (loader_has_come(w->f->tracer[x.volume].treelets, x.t))
            bucket_ready(w, t);
        else
            w->waiting[w->waiting_count++] = t;
    }
}

void frame_work_begin(frame_work *w, double until) {
    const frame *f = w->f;
    for (int i = 0; i < w->loader_count; i++)
        loader_listen(w->numbers[i].from, &w->sleepers);
    pthread_mutex_lock(&w->lock);
    w->until = until;
    atomic_store_explicit(&w->progress, false, memory_order_relaxed);
    atomic_store_explicit(&w->over, false, memory_order_relaxed);
    (void)take_arrivals(w); /* before the buckets are sorted */
    sort_buckets(w);
    (void)has_work(w);
    pthread_mutex_unlock(&w->lock);
    /* No other thread is in a round yet, so no lock is needed. */
    for (uint32_t i = 0; i < w->waiting_count; i++) {
        const wish x = wish_for(w, w->waiting[i]);
        ask_for(f, &x, 1);
    }
}

void frame_work_end(frame_work *w) {
    for (int i = 0; i < w->loader_count; i++)
        loader_listen(w->numbers[i].from, NULL);
}

/* ---- Making and ending ---- */

/* Returns the number of treelets of all loaders. Numbers them, unless w is NULL. */
static uint32_t number_treelets(const frame *f, frame_work *w) {
    uint32_t treelets = 0;
    int count = 0;
    for (int v = 0; v < f->volumes + f->lookups; v++) {
        const tracer *tr = &f->tracer[v];
        if (w && tr->twin == v) {
            w->numbers[count].from = tr->treelets;
            w->numbers[count].first_of = treelets;
        }
        if (w)
            w->numbers[v].first = tr->twin == v ? treelets : w->numbers[tr->twin].first;
        count += tr->twin == v;
        treelets += tr->twin == v ? tr->layout->treelets : 0;
    }
    if (w) {
        w->loader_count = count;
        w->treelets = treelets;
    }
    return treelets;
}

size_t frame_work_bytes(const frame *f, size_t tiles) {
    const uint32_t treelets = number_treelets(f, NULL);
    const size_t objects = (size_t)(f->volumes + f->lookups);
    return (objects > 1 ? objects * sizeof(frame_numbers) + 128 : 0) +
           treelets * (sizeof(work_bucket) + sizeof(uint32_t) + sizeof(loader_request)) +
           tiles * (sizeof(work_tile) + sizeof(uint32_t));
}

status frame_work_init(frame_work *w, const frame *f, ray_records *records, uint32_t tiles) {
    const uint32_t side = kind_tile_side(f->tracer->kind);
    *w = (frame_work){.f = f,
                      .records = records,
                      .tile_rays = side * side,
                      .until = (double)INFINITY,
                      .tile_count = tiles,
                      .ready_first = none,
                      .resumable = none};
    pthread_mutex_init(&w->lock, NULL);
    sleepers_init(&w->sleepers);
    const size_t objects = (size_t)(f->volumes + f->lookups);
    w->numbers = objects > 1 ? mem_array(f->m, objects, sizeof *w->numbers) : &w->only;
    if (!w->numbers)
        return ST_NOMEM;
    const uint32_t treelets = number_treelets(f, w);
    w->buckets = mem_array(f->m, treelets, sizeof *w->buckets);
    w->waiting = mem_array(f->m, treelets, sizeof *w->waiting);
    w->requests = mem_array(f->m, treelets, sizeof *w->requests);
    w->tiles = mem_array(f->m, tiles, sizeof *w->tiles);
    w->order = mem_array(f->m, tiles, sizeof *w->order);
    if (!w->buckets || !w->waiting || !w->requests || !w->tiles || !w->order)
        return ST_NOMEM;
    for (uint32_t t = 0; t < treelets; t++)
        w->buckets[t] = (work_bucket){none, none, not_ready};
    return ST_OK;
}

void frame_work_release(frame_work *w) {
    if (w->numbers != &w->only)
        mem_free(w->f->m, w->numbers);
    mem_free(w->f->m, w->order);
    mem_free(w->f->m, w->tiles);
    mem_free(w->f->m, w->requests);
    mem_free(w->f->m, w->waiting);
    mem_free(w->f->m, w->buckets);
    sleepers_release(&w->sleepers);
    pthread_mutex_destroy(&w->lock);
}
