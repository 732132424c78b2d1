#include "stream/loader.h"

#include <pthread.h>
#include <sched.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/clock.h"
#include "formats/base/fault.h"
#include "formats/mesh_leaf_check.h"

typedef enum residence { ABSENT, QUEUED, LOADING, READY, SPARE, FAILED } residence;

typedef struct reader {
    loader *owner;
    source_scratch scratch;
    pthread_t thread;
} reader;

struct loader_private {
    source *source;
    pthread_mutex_t lock;
    pthread_cond_t work, done;
    /* Guarded by lock: */
    uint8_t *state;        /* residence, a treelet */
    loader_request *queue; /* binary heap, smallest urgency first */
    size_t queued;
    treelet **places; /* READY ones, oldest first */
    treelet **spares; /* SPARE ones; they have places only as long as nothing else needs them */
    uint32_t filled, spare, loading, capacity;
    bool quit, sweeping;
    status_note failure;
    loader_stats stats;
    /* The selected isovalues; read-only while anything is traced or loaded. */
    double isovalues[ACTIVE_ISOS_MAX];
    active_set isos;
    active_fn *compute;
    atomic_size_t masks; /* made */
    uint8_t *existing;   /* a treelet's octants that are there */
    uint8_t *held;       /* whether a treelet's subtree holds an isovalue: room for a sweep */
    treelet_tree tree;   /* of a mesh */
    uint32_t set;        /* of a mesh's values */
    size_t place_bytes;
    reader *readers;
    int started;
};

/* ---- The queue: a binary heap by (urgency, treelet) ---- */

static bool more_urgent(loader_request a, loader_request b) {
    return a.urgency != b.urgency ? a.urgency < b.urgency : a.t < b.t;
}

static void queue_push(struct loader_private *h, loader_request r) {
    size_t i = h->queued++;
    while (i > 0 && more_urgent(r, h->queue[(i - 1) / 2])) {
        h->queue[i] = h->queue[(i - 1) / 2];
        i = (i - 1) / 2;
    }
    h->queue[i] = r;
}

static loader_request queue_pop(struct loader_private *h) {
    loader_request top = h->queue[0], last = h->queue[--h->queued];
    size_t i = 0;
    for (;;) {
        size_t child = 2 * i + 1;
        if (child >= h->queued)
            break;
        if (child + 1 < h->queued && more_urgent(h->queue[child + 1], h->queue[child]))
            child++;
        if (!more_urgent(h->queue[child], last))
            break;
        h->queue[i] = h->queue[child];
        i = child;
    }
    h->queue[i] = last;
    return top;
}

/* ---- One treelet in and out ---- */

static uint64_t stored_bytes(const loader *l, uint32_t t) {
    const leaf_file *f = l->file;
    return f->sizes[t] +
           (l->tree ? f->sizes[leaf_layout_values(&f->layout, l->hidden->set, t)] : 0);
}

static void treelet_free(loader *l, treelet *tr) {
    if (!tr)
        return;
    if (tr->payload)
        source_evict(l->hidden->source, tr->id, tr->payload);
    if (tr->values)
        source_evict(l->hidden->source,
                     leaf_layout_values(&l->file->layout, l->hidden->set, tr->id), tr->values);
    mem_free(l->m, tr);
}

/* A treelet and its masks share one block; these begin there. */
enum { TREELET_HEAD = (sizeof(treelet) + 63) / 64 * 64 };

static status grid_load(loader *l, uint32_t t, source_scratch *scratch, treelet **out) {
    const leaf_layout *layout = &l->file->layout;
    leaf_payload shape = leaf_layout_payload(layout, t);
    treelet *tr = mem_zalloc(l->m, TREELET_HEAD + active_bytes(shape.node_levels));
    if (!tr)
        return ST_NOMEM;
    tr->id = t;
    tr->level = layout->level_of[t];
    for (int a = 0; a < 3; a++)
        tr->first_cell[a] = layout->place[t][a] << layout->cells_log2;
    tr->shape = shape;
    tr->masks = active_init((char *)tr + TREELET_HEAD, shape.node_levels);
    status st = source_load(l->hidden->source, t, scratch, &tr->payload);
    if (st != ST_OK) {
        treelet_free(l, tr);
        return st;
    }
    tr->samples = (const char *)tr->payload + shape.samples_at;
    loader_mask(l, tr);
    *out = tr;
    return ST_OK;
}

static status mesh_load(loader *l, uint32_t t, source_scratch *scratch, treelet **out) {
    const leaf_file *f = l->file;
    const uint32_t values = leaf_layout_values(&f->layout, l->hidden->set, t);
    const mesh_shape shape = mesh_leaf_shape(f->mesh->counts[t]);
    treelet *tr = mem_zalloc(l->m, TREELET_HEAD + mesh_active_bytes(&shape));
    if (!tr)
        return ST_NOMEM;
    tr->id = t;
    tr->mesh = shape;
    tr->active = mesh_active_init((char *)tr + TREELET_HEAD, &shape);
    tr->first_tet = f->mesh->first_tet[t];
    tr->bounds = f->mesh->bounds[t];
    tr->planes = mesh_leaf_frame(tr->bounds);
    status st = source_load(l->hidden->source, t, scratch, &tr->payload);
    if (st == ST_OK)
        st = mesh_leaf_check_loaded(f, t, tr->payload);
    if (st == ST_OK)
        st = source_load(l->hidden->source, values, scratch, &tr->values);
    if (st != ST_OK) {
        treelet_free(l, tr);
        return st;
    }
    loader_mask(l, tr);
    *out = tr;
    return ST_OK;
}

static status treelet_load(loader *l, uint32_t t, source_scratch *scratch, treelet **out) {
    if (l->tree)
        return mesh_load(l, t, scratch, out);
    return grid_load(l, t, scratch, out);
}

static void publish(loader *l, treelet *tr) {
    struct loader_private *h = l->hidden;
    h->state[tr->id] = READY;
    h->places[h->filled++] = tr;
    atomic_store_explicit(&l->resident[tr->id], tr, memory_order_release);
}

/* Give a treelet back; its place is the caller's to close. */
static void evict(loader *l, treelet *tr) {
    atomic_store_explicit(&l->resident[tr->id], NULL, memory_order_relaxed);
    l->hidden->state[tr->id] = ABSENT;
    treelet_free(l, tr);
}

/* Give spare ones back until so many more treelets have places. */
static void make_room(loader *l, uint32_t more) {
    struct loader_private *h = l->hidden;
    while (h->spare > 0 && h->filled + h->loading + h->spare + more > h->capacity)
        evict(l, h->spares[--h->spare]);
}

/* Take a treelet out of the rays' sight, as it is. */
static void lay_aside(loader *l, treelet *tr) {
    struct loader_private *h = l->hidden;
    atomic_store_explicit(&l->resident[tr->id], NULL, memory_order_relaxed);
    h->state[tr->id] = SPARE;
    h->spares[h->spare++] = tr;
}

/* A spare one is wanted after all. */
static void take_back(loader *l, uint32_t t) {
    struct loader_private *h = l->hidden;
    uint32_t i = 0;
    while (h->spares[i]->id != t)
        i++;
    publish(l, h->spares[i]);
    h->spares[i] = h->spares[--h->spare];
}

static void evict_oldest(loader *l, uint32_t count) {
    struct loader_private *h = l->hidden;
    for (uint32_t i = 0; i < count; i++)
        evict(l, h->places[i]);
    h->filled -= count;
    memmove(h->places, h->places + count, h->filled * sizeof *h->places);
}

static void *read_treelets(void *arg) {
    reader *self = arg;
    loader *l = self->owner;
    struct loader_private *h = l->hidden;
    pthread_mutex_lock(&h->lock);
    for (;;) {
        while (!h->quit && (h->queued == 0 || h->filled + h->loading >= h->capacity))
            pthread_cond_wait(&h->work, &h->lock);
        if (h->quit)
            break;
        uint32_t t = queue_pop(h).t;
        make_room(l, 1);
        h->state[t] = LOADING;
        h->loading++;
        pthread_mutex_unlock(&h->lock);

        double start = clock_seconds();
        treelet *tr = NULL;
        status st = treelet_load(l, t, &self->scratch, &tr);
        double seconds = clock_seconds() - start;

        pthread_mutex_lock(&h->lock);
        h->loading--;
        h->stats.load_s += seconds;
        if (st == ST_OK) {
            h->stats.loads++;
            h->stats.bytes_read += stored_bytes(l, t);
            publish(l, tr);
        } else {
            h->state[t] = FAILED;
            if (h->failure.st == ST_OK)
                status_note_take(&h->failure, st);
        }
        pthread_cond_broadcast(&h->done);
    }
    pthread_mutex_unlock(&h->lock);
    return NULL;
}

/* ---- Masks ---- */

static void relax(unsigned spins) {
    if (spins % 64 == 63)
        (void)sched_yield(); /* the one that makes them may have been put off its core */
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
            if (tr->masks)
                h->compute(tr->masks, l->file, tr->id, tr->payload, &h->isos);
            else
                mesh_active_compute(tr->active, &tr->mesh, tr->payload, tr->values,
                                    h->isos.isovalues, h->isos.count);
            atomic_fetch_add_explicit(&h->masks, 1, memory_order_relaxed);
            atomic_store_explicit(&tr->masked, l->selection, memory_order_release);
            return;
        }
        relax(spins);
    }
}

/* ---- Making and ending ---- */

/* Which octants of every treelet there are: needed with every selection. */
static uint8_t *existing_octants(mem *m, const leaf_layout *layout) {
    uint8_t *existing = mem_array(m, layout->treelets, 1);
    for (uint32_t t = 0; existing && t < layout->treelets; t++)
        existing[t] = leaf_layout_children(layout, t);
    return existing;
}

/* What a resident treelet costs at most. */
static size_t place_bytes_of(const loader *l) {
    const leaf_layout *layout = &l->file->layout;
    size_t most = 0;
    if (!l->tree)
        most = leaf_layout_payload_max(layout) + active_bytes(layout->cells_log2 - LEAF_BLOCK_LOG2);
    for (uint32_t t = 0; l->tree && t < layout->treelets; t++) {
        const mesh_shape shape = mesh_leaf_shape(l->file->mesh->counts[t]);
        const size_t bytes =
            (size_t)shape.topology_bytes + shape.values_bytes + mesh_active_bytes(&shape);
        most = bytes > most ? bytes : most;
    }
    return most + (l->tree ? 2 : 1) * source_overhead_bytes(l->hidden->source) + TREELET_HEAD + 256;
}

/* A mesh's directory as a tree. */
static status grow_tree(loader *l) {
    if (l->file->header.kind != LEAF_KIND_MESH)
        return ST_OK;
    status st =
        treelet_tree_init(&l->hidden->tree, l->m, l->file->mesh->bounds, l->file->layout.treelets);
    l->tree = &l->hidden->tree;
    return st;
}

status loader_create(mem *m, leaf_file *f, source_kind kind, int workers, cpu_isa isa,
                     loader **out) {
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
    pthread_cond_init(&h->work, NULL);
    pthread_cond_init(&h->done, NULL);
    h->capacity = 1;
    h->compute = active_for(isa);
    l->own = mem_array(m, n, 1);
    l->children = mem_array(m, n, 1);
    l->resident = mem_array(m, n, sizeof *l->resident);
    h->state = mem_array(m, n, 1);
    h->queue = mem_array(m, n, sizeof *h->queue);
    h->places = mem_array(m, n, sizeof *h->places);
    h->spares = mem_array(m, n, sizeof *h->spares);
    h->existing = existing_octants(m, &f->layout);
    h->held = mem_array(m, n, 1);
    h->readers = mem_array(m, (size_t)workers, sizeof *h->readers);
    if (!l->own || !l->children || !l->resident || !h->state || !h->queue || !h->places ||
        !h->spares || !h->existing || !h->held || !h->readers)
        goto fail;
    st = grow_tree(l);
    if (st == ST_OK)
        st = source_open(m, f, kind, &h->source);
    if (st != ST_OK)
        goto fail;
    h->place_bytes = place_bytes_of(l);
    for (; h->started < workers; h->started++) {
        reader *r = &h->readers[h->started];
        r->owner = l;
        st = source_scratch_init(h->source, &r->scratch);
        if (st != ST_OK)
            goto fail;
        if (fault_hit(FAULT_THREAD) || pthread_create(&r->thread, NULL, read_treelets, r) != 0) {
            source_scratch_release(h->source, &r->scratch);
            st = status_describe(ST_FAILED, "loader thread %d of %d could not be created",
                                 h->started + 1, workers);
            goto fail;
        }
    }
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
        pthread_mutex_lock(&h->lock);
        h->quit = true;
        pthread_cond_broadcast(&h->work);
        pthread_mutex_unlock(&h->lock);
        for (int i = 0; i < h->started; i++) {
            pthread_join(h->readers[i].thread, NULL);
            source_scratch_release(h->source, &h->readers[i].scratch);
        }
        if (h->places)
            evict_oldest(l, h->filled);
        while (h->spare > 0)
            evict(l, h->spares[--h->spare]);
        pthread_cond_destroy(&h->done);
        pthread_cond_destroy(&h->work);
        pthread_mutex_destroy(&h->lock);
        source_close(h->source);
        treelet_tree_release(&h->tree);
        mem_free(l->m, h->readers);
        mem_free(l->m, h->held);
        mem_free(l->m, h->existing);
        mem_free(l->m, h->spares);
        mem_free(l->m, h->places);
        mem_free(l->m, h->queue);
        mem_free(l->m, h->state);
        mem_free(l->m, h);
    }
    mem_free(l->m, l->resident);
    mem_free(l->m, l->children);
    mem_free(l->m, l->own);
    mem_free(l->m, l);
}

/* ---- Selecting ---- */

/* Forget everything queued, and wait for the reads under way. With the lock held. */
static void quiesce(struct loader_private *h) {
    while (h->queued > 0)
        h->state[h->queue[--h->queued].t] = ABSENT;
    while (h->loading > 0)
        pthread_cond_wait(&h->done, &h->lock);
}

/* The end of a picture's wishes, its sweep too. With the lock held. */
static void rest(struct loader_private *h) {
    h->sweeping = false;
    quiesce(h);
}

/* Of each range whether it holds an isovalue: compared as floats, without a branch. */
static void holding(const float (*ranges)[2], uint32_t count, const active_set *isos,
                    uint8_t *held) {
    memset(held, 0, count);
    for (int i = 0; i < isos->count; i++) {
        const float at = active_threshold(isos->isovalues[i]);
        for (uint32_t t = 0; t < count; t++)
            held[t] |= (uint8_t)((ranges[t][0] < at) & (ranges[t][1] >= at));
    }
}

/* The isovalue sweep: which treelets hold a surface themselves, and which children's subtrees do.
 */
static void sweep_ranges(loader *l) {
    const leaf_file *f = l->file;
    const struct loader_private *h = l->hidden;
    const uint32_t treelets = f->layout.treelets, inner = f->layout.level[0].first;
    const size_t first = (size_t)treelets * h->set;
    holding((const float(*)[2])f->own + first, treelets, &h->isos, l->own);
    holding((const float(*)[2])f->ranges + first, treelets, &h->isos, h->held);
    uint64_t bytes = 0;
    uint32_t active = 0;
    for (uint32_t t = 0; t < treelets; t++) {
        bytes += l->own[t] ? stored_bytes(l, t) : 0;
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

/* Resident treelets that hold a surface are READY, the others SPARE. */
static void sort_resident(loader *l) {
    struct loader_private *h = l->hidden;
    const uint32_t filled = h->filled;
    uint32_t spare = 0;
    h->filled = 0;
    for (uint32_t i = 0; i < filled; i++) {
        treelet *tr = h->places[i];
        if (l->own[tr->id])
            h->places[h->filled++] = tr;
        else
            lay_aside(l, tr);
    }
    for (uint32_t i = 0; i < h->spare; i++) {
        treelet *tr = h->spares[i];
        if (l->own[tr->id])
            publish(l, tr);
        else
            h->spares[spare++] = tr;
    }
    h->spare = spare;
}

void loader_select(loader *l, const double *isovalues, int count) {
    struct loader_private *h = l->hidden;
    const size_t bytes = (size_t)count * sizeof *isovalues;
    pthread_mutex_lock(&h->lock);
    rest(h);
    if (count != h->isos.count || memcmp(h->isovalues, isovalues, bytes) != 0) {
        memcpy(h->isovalues, isovalues, bytes);
        h->isos = (active_set){count, h->isovalues};
        l->selection++;
        sweep_ranges(l);
        sort_resident(l);
    }
    pthread_mutex_unlock(&h->lock);
}

size_t loader_place_bytes(const loader *l) {
    return l->hidden->place_bytes;
}

void loader_set_capacity(loader *l, uint32_t places) {
    struct loader_private *h = l->hidden;
    pthread_mutex_lock(&h->lock);
    h->capacity = places > 0 ? places : 1;
    rest(h);
    make_room(l, 0);
    evict_oldest(l, h->filled > h->capacity ? h->filled - h->capacity : 0);
    pthread_mutex_unlock(&h->lock);
}

uint32_t loader_capacity(const loader *l) {
    return l->hidden->capacity;
}

/* ---- Wanting ---- */

static void want_locked(loader *l, uint32_t t, uint64_t urgency) {
    struct loader_private *h = l->hidden;
    if (h->state[t] != ABSENT)
        return;
    h->state[t] = QUEUED;
    queue_push(h, (loader_request){t, urgency});
}

void loader_want(loader *l, uint32_t t, uint64_t urgency) {
    struct loader_private *h = l->hidden;
    pthread_mutex_lock(&h->lock);
    want_locked(l, t, urgency);
    if (h->filled + h->loading < h->capacity)
        pthread_cond_signal(&h->work);
    pthread_mutex_unlock(&h->lock);
}

static void sweep_locked(loader *l) {
    for (uint32_t t = 0; t < l->file->layout.treelets; t++)
        if (l->own[t])
            want_locked(l, t, UINT64_MAX);
}

void loader_sweep(loader *l) {
    struct loader_private *h = l->hidden;
    pthread_mutex_lock(&h->lock);
    h->sweeping = true;
    sweep_locked(l);
    pthread_cond_broadcast(&h->work);
    pthread_mutex_unlock(&h->lock);
}

static int by_urgency(const void *a, const void *b) {
    return more_urgent(*(const loader_request *)a, *(const loader_request *)b) ? -1 : 1;
}

status loader_admit(loader *l, loader_request *requests, size_t count) {
    struct loader_private *h = l->hidden;
    qsort(requests, count, sizeof *requests, by_urgency);
    pthread_mutex_lock(&h->lock);
    quiesce(h);
    bool ready = false;
    for (size_t i = 0; i < count; i++) {
        if (h->state[requests[i].t] == SPARE)
            take_back(l, requests[i].t);
        ready = ready || h->state[requests[i].t] == READY;
    }
    if (!ready) {
        /* Oldest first: front to back, those are the ones that rays have left behind. */
        const uint32_t room = count < h->capacity ? (uint32_t)count : h->capacity;
        const uint32_t fit = h->capacity - h->filled;
        evict_oldest(l, room > fit ? room - fit : 0);
    }
    for (size_t i = 0; i < count; i++)
        want_locked(l, requests[i].t, requests[i].urgency);
    /* What the rays leave room for. */
    if (h->sweeping && h->filled + h->queued < h->capacity)
        sweep_locked(l);
    pthread_cond_broadcast(&h->work);
    const uint64_t before = h->stats.loads;
    while (!ready && h->stats.loads == before && h->failure.st == ST_OK)
        pthread_cond_wait(&h->done, &h->lock);
    status st = h->failure.st == ST_OK ? ST_OK : status_note_raise(&h->failure);
    pthread_mutex_unlock(&h->lock);
    return st;
}

bool loader_has_room(loader *l) {
    struct loader_private *h = l->hidden;
    pthread_mutex_lock(&h->lock);
    const bool room = h->filled + h->loading + h->queued < h->capacity;
    pthread_mutex_unlock(&h->lock);
    return room;
}

status loader_settle(loader *l) {
    struct loader_private *h = l->hidden;
    pthread_mutex_lock(&h->lock);
    while (h->failure.st == ST_OK && (h->loading > 0 || (h->queued > 0 && h->filled < h->capacity)))
        pthread_cond_wait(&h->done, &h->lock);
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
            if (h->state[t] == FAILED)
                h->state[t] = ABSENT;
    h->failure.st = ST_OK;
    pthread_mutex_unlock(&h->lock);
}

loader_stats loader_statistics(loader *l) {
    struct loader_private *h = l->hidden;
    pthread_mutex_lock(&h->lock);
    loader_stats s = h->stats;
    s.masks = atomic_load_explicit(&h->masks, memory_order_relaxed);
    pthread_mutex_unlock(&h->lock);
    return s;
}

void loader_reset_statistics(loader *l) {
    struct loader_private *h = l->hidden;
    pthread_mutex_lock(&h->lock);
    h->stats = (loader_stats){0};
    atomic_store_explicit(&h->masks, 0, memory_order_relaxed);
    pthread_mutex_unlock(&h->lock);
}
