#include "stream/loader.h"

#include <pthread.h>
#include <sched.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/clock.h"
#include "formats/base/heap.h"
#include "stream/sweep.h"
#include "stream/treelet_cache.h"

typedef enum residence { ABSENT, QUEUED, LOADING, READY, FAILED } residence;

/* Scratch for one read; there is one per read that may run at a time. */
typedef struct seat {
    resident_scratch scratch;
    struct seat *next; /* in the list of free seats */
} seat;

/* A payload that treelets of several sets share. */
typedef struct shared {
    const void *payload;
    uint32_t users;
} shared;

struct loader_private {
    source *source;
    const resident_kind *kind;
    resident_store store;
    pthread_mutex_t lock;
    pthread_cond_t done;
    /* Guarded by lock: */
    atomic_uchar *state;   /* residence, per treelet; ABSENT or not: readable without the lock */
    loader_request *queue; /* binary heap, smallest priority first */
    size_t queued;
    treelet **slots;     /* READY treelets, oldest first */
    treelet_cache cache; /* ABSENT treelets, while nothing else needs their memory */
    shared *shared;      /* per treelet; NULL: nothing is shared */
    uint32_t filled, loading, capacity;
    _Atomic uint32_t claimed; /* filled, loading and queued; readable without the lock */
    size_t bytes, room;       /* memory of all treelets; the most that it may be */
    uint64_t published;       /* how often a treelet became READY */
    uint32_t sweep_end;       /* the sweep wants treelets before this one; 0: none */
    bool stepped;             /* another set was selected since the last loader_follow() */
    status_note failure;
    loader_stats stats;
    seat *free_seats;
    atomic_bool reading; /* loader_is_reading() */
    sleepers *listeners; /* loader_listen() */
    interest selected;   /* read-only while anything is traced or loaded */
    atomic_size_t masks; /* how many were made */
    uint8_t *existing;   /* per treelet: octants that exist */
    uint8_t *held;       /* per treelet: its subtree meets the interest; scratch of sweep() */
    treelet_tree tree;   /* for a mesh, whose treelets overlap */
    uint32_t set;        /* the selected one */
    size_t slot_bytes;
    readers *readers, *own_readers; /* own_readers NULL: the caller's readers */
    reader_customer customer;
    bool joined;
    seat *seats;
    int seats_made;
};

/* ---- The queue: a binary heap by (priority, treelet) ---- */

static bool more_urgent(const loader_request *a, const loader_request *b) {
    return a->priority != b->priority ? a->priority < b->priority : a->t < b->t;
}

HEAP_RISE(request, loader_request, more_urgent)
HEAP_SINK(request, loader_request, more_urgent)

static void queue_push(struct loader_private *h, loader_request r) {
    request_rise(h->queue, h->queued++, r);
}

static loader_request queue_pop(struct loader_private *h) {
    const loader_request first = h->queue[0], last = h->queue[--h->queued];
    request_sink(h->queue, 0, h->queued, last);
    return first;
}

/* ---- One treelet in and out ---- */

uint64_t loader_stored_bytes(const loader *l, uint32_t t) {
    return l->hidden->kind->stored(&l->hidden->store, l->hidden->set, t);
}

/* Add a user of a shared payload. Returns the payload, or NULL if absent. Needs the lock. */
static const void *share_payload(struct loader_private *h, uint32_t t) {
    if (!h->shared)
        return NULL;
    h->shared[t].users++;
    return h->shared[t].payload;
}

/* Drop a user; the last one frees the payload. Needs the lock. */
static void release_payload(struct loader_private *h, uint32_t t) {
    if (--h->shared[t].users > 0 || !h->shared[t].payload)
        return;
    source_evict(h->source, t, h->shared[t].payload);
    h->bytes -= h->kind->shared_bytes(&h->store, t);
    h->shared[t].payload = NULL;
}

/* Let other treelets share a treelet's payload. Needs the lock. */
static void offer(struct loader_private *h, const treelet *tr) {
    if (!h->shared || h->shared[tr->id].payload || !tr->payload)
        return;
    h->shared[tr->id].payload = tr->payload;
    h->bytes += h->kind->shared_bytes(&h->store, tr->id);
}

static residence state_of(const struct loader_private *h, uint32_t t) {
    return (residence)atomic_load_explicit(&h->state[t], memory_order_relaxed);
}

static bool claims_slot(residence r) {
    return r == QUEUED || r == LOADING || r == READY;
}

static void set_state(struct loader_private *h, uint32_t t, residence to) {
    const uint32_t claimed = atomic_load_explicit(&h->claimed, memory_order_relaxed);
    const int more = claims_slot(to) - claims_slot(state_of(h, t));
    atomic_store_explicit(&h->state[t], (unsigned char)to, memory_order_relaxed);
    atomic_store_explicit(&h->claimed, claimed + (uint32_t)more, memory_order_relaxed);
}

static void publish(loader *l, treelet *tr) {
    struct loader_private *h = l->hidden;
    set_state(h, tr->id, READY);
    h->slots[h->filled++] = tr;
    h->published++;
    atomic_store_explicit(&l->resident[tr->id], tr, memory_order_release);
    arrivals_add(&l->arrivals, tr->id);
}

/* Free a treelet that is neither READY nor in the cache. */
static void discard(loader *l, treelet *tr) {
    struct loader_private *h = l->hidden;
    const uint32_t t = tr->id;
    h->bytes -= tr->bytes;
    h->kind->destroy(&h->store, tr);
    if (h->shared)
        release_payload(h, t);
}

/* Hide a treelet from rays. The caller must close the gap in `slots`. */
static void withdraw(loader *l, treelet *tr) {
    atomic_store_explicit(&l->resident[tr->id], NULL, memory_order_relaxed);
    set_state(l->hidden, tr->id, ABSENT);
}

/* Evict from the cache, oldest first, until there is room for `more` treelets. */
static void make_room(loader *l, uint32_t more) {
    struct loader_private *h = l->hidden;
    const size_t wanted = (size_t)(h->loading + more) * h->slot_bytes;
    while (h->cache.oldest && (h->bytes > h->room || h->room - h->bytes < wanted)) {
        treelet *tr = h->cache.oldest;
        treelet_cache_remove(&h->cache, tr);
        discard(l, tr);
    }
}

static void evict_oldest(loader *l, uint32_t count) {
    struct loader_private *h = l->hidden;
    for (uint32_t i = 0; i < count; i++) {
        withdraw(l, h->slots[i]);
        discard(l, h->slots[i]);
    }
    h->filled -= count;
    memmove(h->slots, h->slots + count, h->filled * sizeof *h->slots);
}

/* Make treelet t READY from the cache. Returns false if the cache lacks it in the selected set. */
static bool take_back(loader *l, uint32_t t) {
    struct loader_private *h = l->hidden;
    treelet *tr = treelet_cache_find(&h->cache, t, h->set);
    if (!tr)
        return false;
    treelet_cache_remove(&h->cache, tr);
    publish(l, tr);
    return true;
}

/* Returns whether a thread could begin a read now. Needs the lock. */
static bool can_begin(const struct loader_private *h) {
    return h->queued > 0 && h->filled + h->loading < h->capacity && h->free_seats;
}

/* Returns whether a read is under way, or is queued and has a slot. Needs the lock. */
static bool is_reading(const struct loader_private *h) {
    return h->loading > 0 || (h->queued > 0 && h->filled < h->capacity);
}

/* Tell the readers, after the queue or the slots have changed. Needs the lock. */
static void tell_readers(struct loader_private *h) {
    atomic_store(&h->reading, is_reading(h));
    const bool waiting = can_begin(h);
    if (waiting || h->customer.waiting)
        readers_tell(h->readers, &h->customer, waiting, waiting ? h->queue[0].priority : 0);
}

/* Read treelet t and publish it. Needs the lock, and releases it during the read. */
static void bring_in(loader *l, uint32_t t, resident_scratch *scratch) {
    struct loader_private *h = l->hidden;
    uint64_t read = 0;
    treelet *tr = treelet_cache_find(&h->cache, t, TREELET_NO_SET);
    const void *payload = tr ? tr->payload : share_payload(h, t);
    if (tr) {
        treelet_cache_remove(&h->cache, tr);
        h->bytes -= tr->bytes;
    }
    make_room(l, 1);
    set_state(h, t, LOADING);
    h->loading++;
    tell_readers(h);
    pthread_mutex_unlock(&h->lock);

    double start = clock_seconds();
    status st = h->kind->load(&h->store, t, h->set, payload, scratch, &tr, &read);
    if (st == ST_OK)
        loader_mask(l, tr);
    double seconds = clock_seconds() - start;

    pthread_mutex_lock(&h->lock);
    h->loading--;
    h->stats.load_s += seconds;
    h->stats.bytes_read += read;
    h->stats.bytes_read_ever += read;
    if (tr) {
        h->bytes += tr->bytes;
        offer(h, tr);
    }
    if (st == ST_OK) {
        h->stats.loads++;
        publish(l, tr);
        return;
    }
    set_state(h, t, FAILED);
    if (h->failure.st == ST_OK)
        status_note_take(&h->failure, st);
    if (tr)
        discard(l, tr);
    else if (h->shared)
        release_payload(h, t);
    arrivals_add(&l->arrivals, t);
}

/* Do one read for the readers. Wake a listener at the end, when the lock is released. */
static void read_most_urgent(void *ctx) {
    loader *l = ctx;
    struct loader_private *h = l->hidden;
    pthread_mutex_lock(&h->lock);
    const bool can = can_begin(h);
    if (can) {
        const uint32_t t = queue_pop(h).t;
        seat *mine = h->free_seats;
        h->free_seats = mine->next;
        if (!take_back(l, t))
            bring_in(l, t, &mine->scratch);
        mine->next = h->free_seats;
        h->free_seats = mine;
        pthread_cond_broadcast(&h->done);
    }
    tell_readers(h);
    sleepers *listeners = h->listeners;
    const bool claimed = can && listeners && sleepers_claim(listeners);
    pthread_mutex_unlock(&h->lock);
    if (claimed)
        sleepers_wake(listeners);
}

/* ---- Masks ---- */

static void relax(unsigned spins) {
    if (spins % 64 == 63)
        (void)sched_yield(); /* the thread that makes them may not be running */
#if defined __x86_64__ || defined __i386__
    __builtin_ia32_pause();
#endif
}

void loader_mask(const loader *l, treelet *tr) {
    struct loader_private *h = l->hidden;
    for (unsigned spins = 0;; spins++) {
        size_t seen = atomic_load_explicit(&tr->masked, memory_order_acquire);
        if (seen == l->selection)
            return;
        if (seen != LOADER_MASKING &&
            atomic_compare_exchange_strong_explicit(&tr->masked, &seen, LOADER_MASKING,
                                                    memory_order_acquire, memory_order_relaxed)) {
            h->kind->mask(&h->store, tr, &h->selected);
            atomic_fetch_add_explicit(&h->masks, 1, memory_order_relaxed);
            atomic_store_explicit(&tr->masked, l->selection, memory_order_release);
            return;
        }
        relax(spins);
    }
}

/* ---- Making and ending ---- */

/* Find the octants of every treelet that exist: every selection needs them. */
static uint8_t *existing_octants(mem *m, const leaf_layout *layout) {
    uint8_t *existing = mem_array(m, layout->treelets, 1);
    for (uint32_t t = 0; existing && t < layout->treelets; t++)
        existing[t] = leaf_layout_children(layout, t);
    return existing;
}

/* Returns the most memory of a resident treelet. */
static size_t slot_bytes_of(const loader *l) {
    const struct loader_private *h = l->hidden;
    size_t most = 0;
    for (uint32_t t = 0; t < l->file->layout.treelets; t++) {
        const size_t bytes = h->kind->bytes(&h->store, t);
        most = bytes > most ? bytes : most;
    }
    return most;
}

/* Build a tree over treelets that overlap, and room for shared payloads. */
static status grow_tree(loader *l) {
    struct loader_private *h = l->hidden;
    const uint32_t treelets = l->file->layout.treelets;
    const treelet_bounds *boxes = h->kind->boxes(l->file, 0);
    if (h->kind->shares)
        h->shared = mem_array(l->m, treelets, sizeof *h->shared);
    if (h->kind->shares && !h->shared)
        return ST_NOMEM;
    if (!boxes)
        return ST_OK;
    l->tree = &h->tree;
    return treelet_tree_init(&h->tree, l->m, boxes, treelets);
}

static status scratch_init(struct loader_private *h, resident_scratch *scratch) {
    const size_t bytes = h->kind->scratch(&h->store);
    *scratch = (resident_scratch){.room = bytes ? mem_alloc(h->store.m, bytes) : NULL};
    if (bytes && !scratch->room)
        return ST_NOMEM;
    status st = source_scratch_init(h->source, &scratch->source);
    if (st != ST_OK)
        mem_free(h->store.m, scratch->room);
    return st;
}

static void scratch_release(struct loader_private *h, resident_scratch *scratch) {
    source_scratch_release(h->source, &scratch->source);
    mem_free(h->store.m, scratch->room);
}

/* Make scratch for `count` reads at a time. */
static status make_seats(loader *l, int count) {
    struct loader_private *h = l->hidden;
    h->seats = mem_array(l->m, (size_t)count, sizeof *h->seats);
    status st = h->seats ? ST_OK : ST_NOMEM;
    while (st == ST_OK && h->seats_made < count) {
        seat *s = &h->seats[h->seats_made];
        st = scratch_init(h, &s->scratch);
        if (st != ST_OK)
            break;
        h->seats_made++;
        s->next = h->free_seats;
        h->free_seats = s;
    }
    return st;
}

/* Join the caller's reader threads, or create own ones. */
static status join_readers(loader *l, readers *given, int workers) {
    struct loader_private *h = l->hidden;
    h->customer = (reader_customer){.read = read_most_urgent, .ctx = l};
    status st = given ? ST_OK : readers_create(l->m, &h->own_readers);
    h->readers = given ? given : h->own_readers;
    if (st == ST_OK)
        st = readers_join(h->readers, &h->customer, workers);
    h->joined = st == ST_OK;
    return st;
}

status loader_create(mem *m, leaf_file *f, const loader_options *o, readers *given, loader **out) {
    const size_t n = f->layout.treelets;
    status st = ST_NOMEM;
    loader *l = mem_zalloc(m, sizeof *l);
    if (!l)
        return ST_NOMEM;
    l->m = m;
    l->file = f;
    struct loader_private *h = l->hidden = mem_zalloc(m, sizeof *h);
    if (!h)
        goto fail;
    pthread_mutex_init(&h->lock, NULL);
    pthread_cond_init(&h->done, NULL);
    h->capacity = 1;
    h->kind = resident_kind_of(f);
    l->own = mem_array(m, n, 1);
    l->whole = mem_array(m, n, 1);
    l->children = mem_array(m, n, 1);
    l->resident = mem_array(m, n, sizeof *l->resident);
    h->state = mem_array(m, n, sizeof *h->state);
    h->queue = mem_array(m, n, sizeof *h->queue);
    h->slots = mem_array(m, n, sizeof *h->slots);
    treelet_cache_init(&h->cache, m, (uint32_t)n);
    h->existing = existing_octants(m, &f->layout);
    h->held = mem_array(m, n, 1);
    st = arrivals_init(&l->arrivals, m, (uint32_t)n);
    if (!l->own || !l->whole || !l->children || !l->resident || !h->state || !h->queue ||
        !h->slots || !h->cache.of || !h->existing || !h->held)
        st = ST_NOMEM;
    if (st == ST_OK)
        st = grow_tree(l);
    if (st == ST_OK)
        st = source_open(m, f, o->source, &h->source);
    if (st != ST_OK)
        goto fail;
    h->store = (resident_store){.m = m,
                                .file = f,
                                .source = h->source,
                                .compute = active_for(o->isa),
                                .schema = o->schema,
                                .derived = o->derived};
    h->room = h->slot_bytes = slot_bytes_of(l);
    st = make_seats(l, o->workers);
    if (st == ST_OK)
        st = join_readers(l, given, o->workers);
    if (st != ST_OK)
        goto fail;
    *out = l;
    return ST_OK;
fail:
    loader_destroy(l);
    return st;
}

void loader_destroy(loader *l) {
    if (!l)
        return;
    struct loader_private *h = l->hidden;
    if (h) {
        if (h->joined)
            readers_leave(h->readers, &h->customer);
        readers_destroy(h->own_readers);
        for (int i = 0; i < h->seats_made; i++)
            scratch_release(h, &h->seats[i].scratch);
        if (h->slots)
            evict_oldest(l, h->filled);
        h->room = 0;
        if (h->cache.of)
            make_room(l, 1);
        pthread_cond_destroy(&h->done);
        pthread_mutex_destroy(&h->lock);
        source_close(h->source);
        treelet_tree_release(&h->tree);
        mem_free(l->m, h->seats);
        mem_free(l->m, h->held);
        mem_free(l->m, h->existing);
        treelet_cache_release(&h->cache, l->m);
        mem_free(l->m, h->shared);
        mem_free(l->m, h->slots);
        mem_free(l->m, h->queue);
        mem_free(l->m, h->state);
        mem_free(l->m, h);
    }
    arrivals_release(&l->arrivals, l->m);
    mem_free(l->m, l->resident);
    mem_free(l->m, l->children);
    mem_free(l->m, l->whole);
    mem_free(l->m, l->own);
    mem_free(l->m, l);
}

/* ---- Selecting ---- */

/* Forget everything queued, and wait for the reads under way. Needs the lock. */
static void quiesce(struct loader_private *h) {
    while (h->queued > 0)
        set_state(h, h->queue[--h->queued].t, ABSENT);
    tell_readers(h);
    while (h->loading > 0)
        pthread_cond_wait(&h->done, &h->lock);
}

/* Forget all that a picture wanted, its sweep included. Needs the lock. */
static void rest(struct loader_private *h) {
    h->sweep_end = 0;
    quiesce(h);
}

/* The sweep: find the active treelets, and the children with active treelets in their subtrees. */
static void sweep(loader *l) {
    const leaf_file *f = l->file;
    const struct loader_private *h = l->hidden;
    const uint32_t treelets = f->layout.treelets, inner = f->layout.level[0].first;
    const size_t first = (size_t)treelets * h->set;
    sweep_ranges((const float(*)[2])f->own + first, treelets, &h->selected, l->own);
    sweep_ranges((const float(*)[2])f->ranges + first, treelets, &h->selected, h->held);
    memset(l->whole, 0, treelets);
    if (!l->tree) /* grids: treelets lie side by side */
        sweep_whole(f, h->set, &h->selected.whole, l->own, l->whole);
    uint64_t bytes = 0;
    uint32_t active = 0;
    for (uint32_t t = 0; t < treelets; t++) {
        bytes += l->own[t] ? loader_stored_bytes(l, t) : 0;
        active += l->own[t];
    }
    l->bytes_active = bytes;
    l->treelets_active = active;
    for (uint32_t t = 0; t < inner; t++) {
        const uint8_t *child = h->held + f->layout.first_child[t];
        unsigned mask = 0;
        for (unsigned left = h->existing[t]; left; left &= left - 1)
            mask |= (unsigned)*child++ << __builtin_ctz(left);
        l->children[t] = (uint8_t)mask;
    }
    if (l->tree)
        treelet_tree_select(&l->hidden->tree, l->own);
}

/* Move inactive and other sets' treelets to the cache, and active ones back to free slots. */
static void sort_resident(loader *l) {
    struct loader_private *h = l->hidden;
    const uint32_t filled = h->filled;
    h->filled = 0;
    for (uint32_t i = 0; i < filled; i++) {
        treelet *tr = h->slots[i];
        if (l->own[tr->id] && tr->set == h->set) {
            h->slots[h->filled++] = tr;
            continue;
        }
        withdraw(l, tr);
        treelet_cache_put(&h->cache, tr);
    }
    for (treelet *tr = h->cache.newest, *older; tr && h->filled < h->capacity; tr = older) {
        older = tr->older;
        if (tr->set == h->set && l->own[tr->id])
            (void)take_back(l, tr->id);
    }
}

/* Apply another selection. Needs the lock. */
static void select_anew(loader *l) {
    sweep(l);
    sort_resident(l);
}

void loader_rest(loader *l) {
    struct loader_private *h = l->hidden;
    pthread_mutex_lock(&h->lock);
    rest(h);
    pthread_mutex_unlock(&h->lock);
}

void loader_select(loader *l, const interest *in) {
    struct loader_private *h = l->hidden;
    pthread_mutex_lock(&h->lock);
    rest(h);
    if (!interest_same(in, &h->selected)) {
        h->selected = *in;
        l->selection++;
        select_anew(l);
    }
    pthread_mutex_unlock(&h->lock);
}

/* Take their set's data from treelets in the cache (resident_kind.strip). */
static void strip_cache(loader *l) {
    struct loader_private *h = l->hidden;
    for (treelet *tr = h->cache.oldest; tr; tr = tr->newer) {
        h->bytes -= tr->bytes;
        h->kind->strip(&h->store, tr);
        h->bytes += tr->bytes;
    }
}

void loader_select_set(loader *l, uint32_t set) {
    struct loader_private *h = l->hidden;
    pthread_mutex_lock(&h->lock);
    rest(h);
    if (set != h->set) {
        h->stepped = true;
        h->set = set;
        if (l->file->layout.moved_steps)
            treelet_tree_move(&h->tree, h->kind->boxes(l->file, set));
        select_anew(l);
        if (h->store.schema == MESH_REFIT)
            strip_cache(l);
    }
    pthread_mutex_unlock(&h->lock);
}

void loader_select_gradients(loader *l, bool needed) {
    struct loader_private *h = l->hidden;
    pthread_mutex_lock(&h->lock);
    rest(h);
    if (needed != h->store.gradients) {
        for (uint32_t i = 0; i < h->filled; i++) {
            withdraw(l, h->slots[i]);
            treelet_cache_put(&h->cache, h->slots[i]);
        }
        h->filled = 0;
        strip_cache(l);
        h->store.gradients = needed;
        h->slot_bytes = slot_bytes_of(l);
        sweep(l);
    }
    pthread_mutex_unlock(&h->lock);
}

readers *loader_readers(const loader *l) {
    return l->hidden->readers;
}

size_t loader_slot_bytes(const loader *l) {
    return l->hidden->slot_bytes;
}

void loader_set_capacity(loader *l, uint32_t slots, size_t beside) {
    struct loader_private *h = l->hidden;
    pthread_mutex_lock(&h->lock);
    rest(h);
    h->capacity = slots > 0 ? slots : 1;
    h->room = h->capacity * h->slot_bytes;
    h->room = beside < SIZE_MAX - h->room ? h->room + beside : SIZE_MAX;
    evict_oldest(l, h->filled > h->capacity ? h->filled - h->capacity : 0);
    make_room(l, 0);
    pthread_mutex_unlock(&h->lock);
}

void loader_clear(loader *l) {
    struct loader_private *h = l->hidden;
    pthread_mutex_lock(&h->lock);
    rest(h);
    evict_oldest(l, h->filled);
    h->room = 0;
    make_room(l, 0);
    h->room = h->capacity * h->slot_bytes;
    pthread_mutex_unlock(&h->lock);
}

/* ---- Wanting ---- */

static void want_locked(loader *l, uint32_t t, uint64_t priority) {
    struct loader_private *h = l->hidden;
    if (state_of(h, t) != ABSENT)
        return;
    set_state(h, t, QUEUED);
    queue_push(h, (loader_request){t, priority});
}

void loader_want(loader *l, const loader_request *requests, size_t count) {
    struct loader_private *h = l->hidden;
    size_t i = 0;
    while (i < count && state_of(h, requests[i].t) != ABSENT)
        i++;
    if (i == count)
        return;
    pthread_mutex_lock(&h->lock);
    for (; i < count; i++)
        want_locked(l, requests[i].t, requests[i].priority);
    tell_readers(h);
    pthread_mutex_unlock(&h->lock);
}

static void sweep_locked(loader *l) {
    for (uint32_t t = 0; t < l->hidden->sweep_end; t++)
        if (l->own[t])
            want_locked(l, t, UINT64_MAX);
}

void loader_sweep_level(loader *l, uint32_t level) {
    struct loader_private *h = l->hidden;
    const leaf_layout *layout = &l->file->layout;
    pthread_mutex_lock(&h->lock);
    h->sweep_end = level > 0 ? layout->level[level - 1].first : layout->treelets;
    sweep_locked(l);
    tell_readers(h);
    pthread_mutex_unlock(&h->lock);
}

static void wait_idle(struct loader_private *h) {
    while (h->failure.st == ST_OK && is_reading(h))
        pthread_cond_wait(&h->done, &h->lock);
}

void loader_follow(loader *l, const atomic_uchar touched[]) {
    struct loader_private *h = l->hidden;
    pthread_mutex_lock(&h->lock);
    for (uint32_t t = 0; h->stepped && t < l->file->layout.treelets; t++)
        if (l->own[t] && atomic_load_explicit(&touched[t], memory_order_relaxed))
            want_locked(l, t, 0);
    if (h->stepped) {
        tell_readers(h);
        wait_idle(h);
    }
    h->stepped = false;
    pthread_mutex_unlock(&h->lock);
}

static int by_priority(const void *a, const void *b) {
    return more_urgent(a, b) ? -1 : 1;
}

status loader_admit(loader *l, loader_request *requests, size_t count) {
    struct loader_private *h = l->hidden;
    qsort(requests, count, sizeof *requests, by_priority);
    pthread_mutex_lock(&h->lock);
    quiesce(h);
    bool ready = false;
    for (size_t i = 0; i < count; i++) {
        if (state_of(h, requests[i].t) == ABSENT && h->filled < h->capacity)
            (void)take_back(l, requests[i].t);
        ready = ready || state_of(h, requests[i].t) == READY;
    }
    if (!ready) {
        /* Evict the oldest: rays go front to back, and have left those behind. */
        const uint32_t room = count < h->capacity ? (uint32_t)count : h->capacity;
        const uint32_t fit = h->capacity - h->filled;
        evict_oldest(l, room > fit ? room - fit : 0);
    }
    for (size_t i = 0; i < count; i++)
        want_locked(l, requests[i].t, requests[i].priority);
    /* Sweep into the slots that rays leave free. */
    if (h->sweep_end > 0 && h->filled + h->queued < h->capacity)
        sweep_locked(l);
    tell_readers(h);
    const uint64_t before = h->published;
    while (!ready && h->published == before && h->failure.st == ST_OK)
        pthread_cond_wait(&h->done, &h->lock);
    status st = h->failure.st == ST_OK ? ST_OK : status_note_raise(&h->failure);
    pthread_mutex_unlock(&h->lock);
    return st;
}

bool loader_has_room(const loader *l) {
    const struct loader_private *h = l->hidden;
    return atomic_load_explicit(&h->claimed, memory_order_relaxed) < h->capacity;
}

void loader_listen(loader *l, sleepers *listeners) {
    struct loader_private *h = l->hidden;
    pthread_mutex_lock(&h->lock);
    h->listeners = listeners;
    pthread_mutex_unlock(&h->lock);
}

bool loader_is_reading(const loader *l) {
    return atomic_load(&l->hidden->reading);
}

status loader_settle(loader *l) {
    struct loader_private *h = l->hidden;
    pthread_mutex_lock(&h->lock);
    wait_idle(h);
    status st = h->failure.st == ST_OK ? ST_OK : status_note_raise(&h->failure);
    pthread_mutex_unlock(&h->lock);
    return st;
}

status loader_failure(loader *l) {
    struct loader_private *h = l->hidden;
    pthread_mutex_lock(&h->lock);
    status st = h->failure.st == ST_OK ? ST_OK : status_note_raise(&h->failure);
    pthread_mutex_unlock(&h->lock);
    return st;
}

void loader_forget_failures(loader *l) {
    struct loader_private *h = l->hidden;
    pthread_mutex_lock(&h->lock);
    rest(h);
    if (h->failure.st != ST_OK)
        for (uint32_t t = 0; t < l->file->layout.treelets; t++)
            if (state_of(h, t) == FAILED)
                set_state(h, t, ABSENT);
    h->failure.st = ST_OK;
    pthread_mutex_unlock(&h->lock);
}

loader_stats loader_statistics(loader *l) {
    struct loader_private *h = l->hidden;
    pthread_mutex_lock(&h->lock);
    loader_stats s = h->stats;
    s.bytes_resident = h->bytes;
    s.masks = atomic_load_explicit(&h->masks, memory_order_relaxed);
    pthread_mutex_unlock(&h->lock);
    return s;
}

void loader_reset_statistics(loader *l) {
    struct loader_private *h = l->hidden;
    pthread_mutex_lock(&h->lock);
    h->stats = (loader_stats){.bytes_read_ever = h->stats.bytes_read_ever};
    atomic_store_explicit(&h->masks, 0, memory_order_relaxed);
    pthread_mutex_unlock(&h->lock);
}
