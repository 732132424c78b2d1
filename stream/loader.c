#include "stream/loader.h"

#include <sched.h>

#include "stream/loader_reads.h"
#include "stream/loader_slots.h"

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

/* Find the octants of every treelet that exist: every selection needs them. */
static uint8_t *existing_octants(mem *m, const leaf_layout *layout) {
    uint8_t *existing = mem_array(m, layout->treelets, 1);
    for (uint32_t t = 0; existing && t < layout->treelets; t++)
        existing[t] = leaf_layout_children(layout, t);
    return existing;
}

/* Build a tree over treelets that overlap, and room for shared payloads. */
static status grow_tree(loader *l) {
    struct loader_private *h = l->hidden;
    const uint32_t treelets = l->file->layout.treelets;
    const treelet_bounds *boxes = h->kind->boxes(l->file, 0);
    const bool shares = h->kind->shares && h->kind->shares(l->file);
    if (shares)
        h->shared = mem_array(l->m, treelets, sizeof *h->shared);
    if (shares && !h->shared)
        return ST_NOMEM;
    if (!boxes)
        return ST_OK;
    l->tree = &h->tree;
    return treelet_tree_init(&h->tree, l->m, boxes, treelets);
}

status loader_create(mem *m, leaf_file *f, const loader_options *o, readers *given, loader **out) {
    const size_t n = f->layout.treelets;
    status st = ST_NOMEM;
    loader *l = mem_zalloc(m, sizeof *l);
    if (!l)
        return ST_NOMEM;
    l->m = m;
    l->file = f;
    l->selection = 1; /* treelet.masked is 0 of what has no masks */
    struct loader_private *h = l->hidden = mem_zalloc(m, sizeof *h);
    if (!h)
        goto fail;
    pthread_mutex_init(&h->lock, NULL);
    pthread_cond_init(&h->done, NULL);
    h->capacity = 1;
    h->expected = h->early_set = TREELET_NO_SET;
    h->kind = resident_kind_of(f);
    l->own = mem_array(m, n, 1);
    l->whole = mem_array(m, n, 1);
    l->children = mem_array(m, n, 1);
    l->resident = mem_array(m, n, sizeof *l->resident);
    h->state = mem_array(m, n, sizeof *h->state);
    h->queue = mem_array(m, n, sizeof *h->queue);
    h->ahead = mem_array(m, n, sizeof *h->ahead);
    h->slots = mem_array(m, n, sizeof *h->slots);
    treelet_cache_init(&h->cache, m, (uint32_t)n);
    h->existing = existing_octants(m, &f->layout);
    h->held = mem_array(m, n, 1);
    st = arrivals_init(&l->arrivals, m, (uint32_t)n);
    if (!l->own || !l->whole || !l->children || !l->resident || !h->state || !h->queue ||
        !h->ahead || !h->slots || !h->cache.of || !h->existing || !h->held)
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
    h->rows = leaf_file_rows(f);
    h->room = h->slot_bytes = loader_slots_most_bytes(l);
    if (h->kind->head) /* most treelets are of level 0, whose treelets come last */
        st = block_runs_create(m, h->kind->head(&h->store, (uint32_t)n - 1), n, &h->store.heads);
    if (st == ST_OK)
        st = loader_reads_begin(l, given, o->workers);
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
        loader_reads_end(l);
        if (h->slots)
            loader_slots_evict(l, h->filled);
        h->room = 0;
        if (h->cache.of)
            loader_slots_make_room(l, 1);
        pthread_cond_destroy(&h->done);
        pthread_mutex_destroy(&h->lock);
        block_runs_destroy(h->store.heads);
        source_close(h->source);
        treelet_tree_release(&h->tree);
        mem_free(l->m, h->held);
        mem_free(l->m, h->existing);
        treelet_cache_release(&h->cache, l->m);
        mem_free(l->m, h->shared);
        mem_free(l->m, h->slots);
        mem_free(l->m, h->ahead);
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

readers *loader_readers(const loader *l) {
    return l->hidden->readers;
}

size_t loader_slot_bytes(const loader *l) {
    return l->hidden->slot_bytes;
}

uint64_t loader_stored_bytes(const loader *l, uint32_t t, uint32_t *family) {
    return l->hidden->kind->stored(&l->hidden->store, l->hidden->set, t, family);
}

loader_stats loader_statistics(loader *l) {
    struct loader_private *h = l->hidden;
    pthread_mutex_lock(&h->lock);
    loader_stats s = h->stats;
    s.bytes_resident = h->bytes;
    s.loads += h->set == h->early_set ? h->early_loads : 0;
    s.bytes_read += h->set == h->early_set ? h->early_bytes : 0;
    s.masks = atomic_load_explicit(&h->masks, memory_order_relaxed);
    pthread_mutex_unlock(&h->lock);
    return s;
}

void loader_reset_statistics(loader *l) {
    struct loader_private *h = l->hidden;
    pthread_mutex_lock(&h->lock);
    h->stats = (loader_stats){.bytes_read_ever = h->stats.bytes_read_ever, .early = h->stats.early};
    atomic_store_explicit(&h->masks, 0, memory_order_relaxed);
    pthread_mutex_unlock(&h->lock);
}
