/* loader_select.c - another interest, set or capacity: what stays resident, what goes. */
#include <string.h>

#include "stream/loader_reads.h"
#include "stream/loader_slots.h"
#include "stream/sweep.h"

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
    uint32_t active = 0, family = LEAF_NO_TREELET;
    for (uint32_t t = 0; t < treelets; t++) {
        bytes += l->own[t] ? loader_stored_bytes(l, t, &family) : 0;
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

/* Move inactive treelets, and other sets' that are not the same in this one, to the cache; and
 * active ones back to free slots. */
static void sort_resident(loader *l) {
    struct loader_private *h = l->hidden;
    const uint32_t filled = h->filled;
    h->filled = 0;
    for (uint32_t i = 0; i < filled; i++) {
        treelet *tr = h->slots[i];
        if (l->own[tr->id] && loader_slots_fits(l, tr)) {
            h->slots[h->filled++] = tr;
            continue;
        }
        loader_slots_withdraw(l, tr);
        treelet_cache_put(&h->cache, tr);
    }
    for (treelet *tr = h->cache.newest, *older; tr && h->filled < h->capacity; tr = older) {
        older = tr->older;
        if (!l->own[tr->id] || loader_is_ready(l, tr->id) || !loader_slots_fits(l, tr))
            continue;
        treelet_cache_remove(&h->cache, tr);
        loader_slots_publish(l, tr);
    }
}

/* Apply another selection. Needs the lock. */
static void select_anew(loader *l) {
    sweep(l);
    sort_resident(l);
}

void loader_select(loader *l, const interest *in) {
    struct loader_private *h = l->hidden;
    pthread_mutex_lock(&h->lock);
    loader_reads_rest(h);
    if (!interest_same(in, &h->selected)) {
        h->selected = *in;
        h->early_set = h->early_set == h->set ? TREELET_NO_SET : h->early_set;
        l->selection++;
        select_anew(l);
    }
    pthread_mutex_unlock(&h->lock);
}

/* Free the data of treelets in the cache that belongs to their set (resident_kind.strip). */
static void strip_cache(loader *l) {
    struct loader_private *h = l->hidden;
    for (treelet *tr = h->cache.oldest; tr; tr = tr->newer) {
        h->bytes -= tr->bytes;
        h->kind->strip(&h->store, tr);
        h->bytes += tr->bytes;
    }
}

static uint64_t version_of(const loader *l, uint32_t set) {
    return l->file->versions ? l->file->versions[set] : 0;
}

bool loader_is_behind(const loader *l) {
    return l->hidden->version != version_of(l, l->hidden->set);
}

void loader_select_fresh(loader *l, uint32_t set) {
    struct loader_private *h = l->hidden;
    const uint32_t filled = h->filled;
    h->filled = 0;
    for (uint32_t i = 0; i < filled; i++) {
        treelet *tr = h->slots[i];
        if (tr->set != set || h->kind->keep(&h->store, tr)) {
            h->slots[h->filled++] = tr;
            continue;
        }
        loader_slots_withdraw(l, tr);
        loader_slots_discard(l, tr);
    }
    for (treelet *tr = h->cache.oldest, *newer; tr; tr = newer) {
        newer = tr->newer;
        if (tr->set != set || h->kind->keep(&h->store, tr))
            continue;
        treelet_cache_remove(&h->cache, tr);
        loader_slots_discard(l, tr);
    }
}

void loader_select_set(loader *l, uint32_t set) {
    struct loader_private *h = l->hidden;
    pthread_mutex_lock(&h->lock);
    loader_reads_rest(h);
    if (set == h->expected)
        h->expected = TREELET_NO_SET;
    if (set != h->set || h->version != version_of(l, set)) {
        h->stepped = true;
        h->early_set = h->early_set == h->set ? TREELET_NO_SET : h->early_set;
        h->set = set;
        h->version = version_of(l, set);
        if (l->file->versions)
            loader_select_fresh(l, set);
        if (leaf_layout_moves(&l->file->layout))
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
    loader_reads_rest(h);
    if (needed != h->store.gradients) {
        for (uint32_t i = 0; i < h->filled; i++) {
            loader_slots_withdraw(l, h->slots[i]);
            treelet_cache_put(&h->cache, h->slots[i]);
        }
        h->filled = 0;
        strip_cache(l);
        h->store.gradients = needed;
        h->slot_bytes = loader_slots_most_bytes(l);
        sweep(l);
    }
    pthread_mutex_unlock(&h->lock);
}

void loader_set_capacity(loader *l, uint32_t slots, size_t beside) {
    struct loader_private *h = l->hidden;
    pthread_mutex_lock(&h->lock);
    loader_reads_rest(h);
    h->capacity = slots > 0 ? slots : 1;
    h->room = h->capacity * h->slot_bytes;
    h->room = beside < SIZE_MAX - h->room ? h->room + beside : SIZE_MAX;
    loader_slots_evict(l, h->filled > h->capacity ? h->filled - h->capacity : 0);
    loader_slots_make_room(l, 0);
    pthread_mutex_unlock(&h->lock);
}

void loader_clear(loader *l) {
    struct loader_private *h = l->hidden;
    pthread_mutex_lock(&h->lock);
    loader_reads_rest(h);
    loader_slots_evict(l, h->filled);
    h->room = 0;
    loader_slots_make_room(l, 0);
    h->room = h->capacity * h->slot_bytes;
    pthread_mutex_unlock(&h->lock);
}
