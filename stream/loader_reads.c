#include "stream/loader_reads.h"

#include "formats/base/clock.h"
#include "formats/base/heap.h"
#include "stream/loader_expect.h"
#include "stream/loader_slots.h"

/* The queue: a binary heap by (priority, treelet), of which any may be taken. */

bool loader_reads_before(const loader_request *a, const loader_request *b) {
    return a->priority != b->priority ? a->priority < b->priority : a->t < b->t;
}

HEAP_RISE(request, loader_request, loader_reads_before)
HEAP_SINK(request, loader_request, loader_reads_before)

void loader_reads_push(struct loader_private *h, loader_request r) {
    request_rise(h->queue, h->queued++, r);
}

/* How many rows behind the last one a treelet's is, in a circle; 0 of those that are in none. */
static uint32_t rows_behind(const struct loader_private *h, uint32_t t) {
    const leaf_file *f = h->store.file;
    return leaf_file_is_outside(f, t) ? (leaf_file_row(f, t) + h->rows - h->row) % h->rows : 0;
}

/* Find the request that is read next: the first one; or, where treelets of a row cost little one
 * after the other, the first of the next row that has any. So all rows take turns. */
static size_t find_next(const struct loader_private *h) {
    size_t next = 0;
    uint32_t least = h->rows ? rows_behind(h, h->queue[0].t) : 0;
    for (size_t i = 1; i < h->queued && h->rows; i++) {
        const uint32_t behind = rows_behind(h, h->queue[i].t);
        if (behind < least ||
            (behind == least && loader_reads_before(&h->queue[i], &h->queue[next])))
            next = i;
        least = behind < least ? behind : least;
    }
    return next;
}

static loader_request queue_pop(struct loader_private *h) {
    const size_t at = find_next(h);
    const loader_request found = h->queue[at], last = h->queue[--h->queued];
    if (at < h->queued && loader_reads_before(&last, &found))
        request_rise(h->queue, at, last);
    else if (at < h->queued)
        request_sink(h->queue, at, h->queued, last);
    h->ahead[found.t] = 0;
    if (h->rows && leaf_file_is_outside(h->store.file, found.t))
        h->row = leaf_file_row(h->store.file, found.t);
    return found;
}

/* List the requests near the front of the queue that are not being read ahead yet, each once: all
 * of them when the first one is, else once they are half. Needs the lock. */
static void list_ahead(struct loader_private *h, loader_seat *seat) {
    uint32_t count = 0;
    seat->ahead_set = h->set;
    for (size_t i = 0; i < LOADER_AHEAD && i < h->queued; i++)
        if (!h->ahead[h->queue[i].t])
            seat->ahead[count++] = h->queue[i].t;
    const bool enough = count >= LOADER_AHEAD / 2 || (count > 0 && !h->ahead[h->queue[0].t]);
    seat->ahead_count = enough ? count : 0;
    for (uint32_t i = 0; i < seat->ahead_count; i++)
        h->ahead[seat->ahead[i]] = 1;
}

/* Returns whether something is queued, and has a slot. Needs the lock. */
static bool has_slot(const struct loader_private *h) {
    return h->queued > 0 && h->filled + h->loading < h->capacity;
}

/* Returns whether a thread could begin a read now. Needs the lock. */
static bool can_begin(const struct loader_private *h) {
    return has_slot(h) && h->free_seats;
}

/* Likewise, of the expected set. Needs the lock. */
static bool can_expect(const struct loader_private *h) {
    return loader_expect_any(h) && h->free_seats;
}

bool loader_reads_pending(const struct loader_private *h) {
    return h->loading > 0 || (h->queued > 0 && h->filled < h->capacity);
}

void loader_reads_tell(struct loader_private *h) {
    atomic_store(&h->reading, loader_reads_pending(h));
    const bool wanted = can_begin(h), waiting = wanted || can_expect(h);
    if (waiting || h->customer.waiting)
        readers_tell(h->readers, &h->customer, waiting, wanted ? h->queue[0].priority : UINT64_MAX);
}

void loader_reads_quiesce(struct loader_private *h) {
    while (h->queued > 0) {
        const uint32_t t = h->queue[--h->queued].t;
        loader_slots_set_state(h, t, ABSENT);
        h->ahead[t] = 0;
    }
    loader_expect_end(h);
    loader_reads_tell(h);
    while (h->loading + h->early > 0)
        pthread_cond_wait(&h->done, &h->lock);
}

void loader_reads_rest(struct loader_private *h) {
    h->sweep_end = 0;
    loader_reads_quiesce(h);
}

static bool is_tolerable(const struct loader_private *h, status st) {
    return h->tolerant && (st == ST_CORRUPT || st == ST_IO);
}

/* Note that treelet t failed, and free what was made of it. */
static void take_failure(loader *l, uint32_t t, treelet *tr, status st) {
    struct loader_private *h = l->hidden;
    loader_slots_set_state(h, t, FAILED);
    if (is_tolerable(h, st)) {
        if (h->lost++ == 0)
            status_note_take(&h->why, st);
    } else if (h->failure.st == ST_OK) {
        status_note_take(&h->failure, st);
    }
    if (tr)
        loader_slots_discard(l, tr);
    else
        loader_slots_release(h, t);
    arrivals_add(&l->arrivals, t);
}

/* Returns a treelet that helps with treelet t of this set, or NULL, which nobody evicts during the
 * read: a READY one of another set, or one that is taken out of the cache. */
static treelet *take_helper(const loader *l, uint32_t t, uint32_t set) {
    struct loader_private *h = l->hidden;
    treelet *tr = atomic_load_explicit(&l->resident[t], memory_order_relaxed);
    if (!h->kind->helps || (tr && h->kind->helps(&h->store, tr, set)))
        return h->kind->helps ? tr : NULL;
    tr = h->cache.of[t];
    while (tr && (tr->set == TREELET_NO_SET || !h->kind->helps(&h->store, tr, set)))
        tr = tr->next;
    if (tr)
        treelet_cache_remove(&h->cache, tr);
    return tr;
}

static void read_ahead(const struct loader_private *h, const loader_seat *seat) {
    uint32_t payloads[RESIDENT_PAYLOADS * LOADER_AHEAD], count = 0;
    for (uint32_t i = 0; i < seat->ahead_count; i++)
        count += h->kind->ahead(&h->store, seat->ahead_set, seat->ahead[i], payloads + count);
    source_ahead(h->source, payloads, count);
}

/* Count a read for a set that is not selected yet. */
static void count_early(struct loader_private *h, uint32_t set, uint64_t bytes) {
    if (h->early_set != set)
        h->early_loads = h->early_bytes = 0;
    h->early_set = set;
    h->early_loads++;
    h->early_bytes += bytes;
    h->stats.early++;
}

/* Take what is made of treelet t of the expected set. */
static void take_early(loader *l, uint32_t t, treelet *tr, status st) {
    struct loader_private *h = l->hidden;
    if (st == ST_OK) {
        treelet_cache_put(&h->cache, tr);
        return;
    }
    loader_expect_end(h);
    if (tr)
        loader_slots_discard(l, tr);
    else
        loader_slots_release(h, t);
}

/* Read treelet t of a set: of the selected one to publish it, of another one for the cache. Needs
 * the lock, and releases it during the read. */
static void bring_in(loader *l, uint32_t t, uint32_t set, loader_seat *seat) {
    struct loader_private *h = l->hidden;
    const bool early = set != h->set;
    uint64_t read = 0;
    treelet *tr = treelet_cache_find(&h->cache, t, TREELET_NO_SET);
    const void *payload = tr ? tr->payload : loader_slots_share(h, t);
    if (tr) {
        treelet_cache_remove(&h->cache, tr);
        h->bytes -= tr->bytes;
    }
    treelet *helper = take_helper(l, t, set);
    if (!loader_slots_make_room(l, 1) && helper && helper != loader_peek(l, t)) {
        loader_slots_discard(l, helper);
        helper = NULL;
    }
    uint32_t *reads = early ? &h->early : &h->loading;
    if (!early)
        loader_slots_set_state(h, t, LOADING);
    ++*reads;
    if (early)
        loader_expect_ahead(h, seat);
    else
        list_ahead(h, seat);
    loader_reads_tell(h);
    pthread_mutex_unlock(&h->lock);

    double start = clock_seconds();
    read_ahead(h, seat);
    status st = h->kind->load(&h->store, t, set, payload, helper, &seat->scratch, &tr, &read);
    if (st == ST_OK)
        loader_mask(l, tr);
    double seconds = clock_seconds() - start;

    pthread_mutex_lock(&h->lock);
    --*reads;
    h->stats.load_s += early ? 0.0 : seconds;
    h->stats.bytes_read += early ? 0 : read;
    h->stats.bytes_read_ever += read;
    if (helper && helper != loader_peek(l, t))
        treelet_cache_put(&h->cache, helper);
    if (tr) {
        h->bytes += tr->bytes;
        loader_slots_offer(h, tr);
    }
    if (early) {
        if (st == ST_OK)
            count_early(h, set, read);
        take_early(l, t, tr, st);
        return;
    }
    if (st != ST_OK) {
        take_failure(l, t, tr, st);
        return;
    }
    h->stats.loads++;
    loader_slots_publish(l, tr);
}

/* Read the most urgent treelet, or else one of the expected set. Needs the lock. Returns whether
 * one of the selected set came. */
static bool read_one(loader *l, loader_seat *seat) {
    struct loader_private *h = l->hidden;
    if (has_slot(h)) {
        const uint32_t t = queue_pop(h).t;
        if (!loader_slots_take_back(l, t))
            bring_in(l, t, h->set, seat);
        return true;
    }
    const uint32_t t = loader_expect_next(l);
    if (t != LEAF_NO_TREELET)
        bring_in(l, t, h->expected, seat);
    return false;
}

/* Do one read for the readers. Wake a listener at the end, when the lock is released. */
static void read_most_urgent(void *ctx) {
    loader *l = ctx;
    struct loader_private *h = l->hidden;
    pthread_mutex_lock(&h->lock);
    bool came = false;
    if (can_begin(h) || can_expect(h)) {
        loader_seat *mine = h->free_seats;
        h->free_seats = mine->next;
        came = read_one(l, mine);
        mine->next = h->free_seats;
        h->free_seats = mine;
        pthread_cond_broadcast(&h->done);
    }
    loader_reads_tell(h);
    sleepers *listeners = h->listeners;
    const bool claimed = came && listeners && sleepers_claim(listeners);
    pthread_mutex_unlock(&h->lock);
    if (claimed)
        sleepers_wake(listeners);
}

static status scratch_init(struct loader_private *h, resident_scratch *scratch) {
    const size_t bytes = h->kind->scratch(&h->store);
    *scratch = (resident_scratch){.room = bytes ? mem_alloc(h->store.m, bytes) : NULL};
    if (bytes && !scratch->room)
        return ST_NOMEM;
    status st = leaf_unpacker_share(h->store.m, h->store.file, h->shells, &scratch->unpacker);
    if (st != ST_OK)
        mem_free(h->store.m, scratch->room);
    return st;
}

static void scratch_release(struct loader_private *h, resident_scratch *scratch) {
    leaf_unpacker_destroy(scratch->unpacker);
    mem_free(h->store.m, scratch->room);
}

/* The room for shells: they are few, and each serves up to eight treelets. */
static size_t shells_room(size_t limit) {
    enum { MOST = 12 << 20, SHARE = 32 };
    return limit && limit / SHARE < MOST ? limit / SHARE : MOST;
}

size_t loader_more_bytes(const loader *l, size_t limit) {
    const leaf_layout *layout = &leaf_file_stores(l->file)->layout;
    const int seats = l->hidden->seats_made;
    const size_t now = leaf_shells_memory(layout, seats, shells_room(l->m->limit));
    const size_t then = leaf_shells_memory(layout, seats, shells_room(limit));
    return then > now ? then - now : 0;
}

/* Make scratch for `count` reads at a time. */
static status make_seats(loader *l, int count) {
    struct loader_private *h = l->hidden;
    h->seats = mem_array(l->m, (size_t)count, sizeof *h->seats);
    status st = h->seats ? leaf_shells_create(l->m, &leaf_file_stores(l->file)->layout, count,
                                              shells_room(l->m->limit), &h->shells)
                         : ST_NOMEM;
    while (st == ST_OK && h->seats_made < count) {
        loader_seat *s = &h->seats[h->seats_made];
        st = scratch_init(h, &s->scratch);
        if (st != ST_OK)
            break;
        h->seats_made++;
        s->next = h->free_seats;
        h->free_seats = s;
    }
    return st;
}

static void release_seats(loader *l, loader_seat *seats, int count, leaf_shells *shells) {
    for (int i = 0; i < count; i++)
        scratch_release(l->hidden, &seats[i].scratch);
    mem_free(l->m, seats);
    leaf_shells_destroy(shells);
}

status loader_reads_renew(loader *l) {
    struct loader_private *h = l->hidden;
    loader_seat *const seats = h->seats, *const free_seats = h->free_seats;
    leaf_shells *const shells = h->shells;
    const int count = h->seats_made;
    h->seats = h->free_seats = NULL;
    h->shells = NULL;
    h->seats_made = 0;
    const status st = make_seats(l, count);
    if (st == ST_OK) {
        release_seats(l, seats, count, shells);
        return ST_OK;
    }
    release_seats(l, h->seats, h->seats_made, h->shells);
    h->seats = seats;
    h->free_seats = free_seats;
    h->shells = shells;
    h->seats_made = count;
    return st;
}

status loader_reads_begin(loader *l, readers *given, int workers) {
    struct loader_private *h = l->hidden;
    h->customer = (reader_customer){.read = read_most_urgent, .ctx = l};
    status st = make_seats(l, workers);
    if (st == ST_OK && !given)
        st = readers_create(l->m, &h->own_readers);
    if (st != ST_OK)
        return st;
    h->readers = given ? given : h->own_readers;
    st = readers_join(h->readers, &h->customer, workers);
    h->joined = st == ST_OK;
    return st;
}

void loader_reads_end(loader *l) {
    struct loader_private *h = l->hidden;
    if (h->joined)
        readers_leave(h->readers, &h->customer);
    readers_destroy(h->own_readers);
    release_seats(l, h->seats, h->seats_made, h->shells);
}
