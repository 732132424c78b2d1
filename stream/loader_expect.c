#include "stream/loader_expect.h"

#include "stream/loader_reads.h"
#include "stream/loader_slots.h"
#include "stream/sweep.h"

bool loader_expect_any(const struct loader_private *h) {
    return h->expect_from < h->expect_to;
}

void loader_expect_end(struct loader_private *h) {
    h->expect_from = h->expect_to = 0;
}

bool loader_expect_meets(const loader *l, uint32_t set, uint32_t t) {
    const struct loader_private *h = l->hidden;
    const size_t i = (size_t)l->file->layout.treelets * set + t;
    uint8_t met;
    sweep_ranges((const float(*)[2])l->file->own + i, 1, &h->selected, &met);
    return met && (l->tree || !sweep_is_whole(l->file, i, &h->selected.whole));
}

bool loader_expect_serves(const struct loader_private *h, const treelet *tr, uint32_t set) {
    return tr && (tr->set == set || (tr->set != TREELET_NO_SET && h->kind->same &&
                                     h->kind->same(&h->store, tr, set)));
}

static bool serves(const struct loader_private *h, const treelet *tr) {
    return loader_expect_serves(h, tr, h->expected);
}

/* Whether treelet t must be read. One in the cache stays there longer. */
static bool is_absent(loader *l, uint32_t t) {
    struct loader_private *h = l->hidden;
    if (serves(h, loader_peek(l, t)))
        return false;
    for (treelet *tr = h->cache.of[t]; tr; tr = tr->next)
        if (serves(h, tr)) {
            treelet_cache_remove(&h->cache, tr);
            treelet_cache_put(&h->cache, tr);
            return false;
        }
    return true;
}

/* Free what nobody may want soon, until there is room for one treelet more. */
static bool make_room(loader *l) {
    struct loader_private *h = l->hidden;
    const size_t wanted = (size_t)(h->loading + h->early + 1) * h->slot_bytes;
    while (h->bytes > h->room || h->room - h->bytes < wanted) {
        treelet *tr = h->cache.oldest;
        if (!tr || serves(h, tr))
            return false;
        treelet_cache_remove(&h->cache, tr);
        loader_slots_discard(l, tr);
    }
    return true;
}

uint32_t loader_expect_next(loader *l) {
    struct loader_private *h = l->hidden;
    while (loader_expect_any(h)) {
        const uint32_t t = h->expect_from++;
        if (!h->held[t])
            continue;
        if (make_room(l))
            return t;
        loader_expect_end(h);
    }
    return LEAF_NO_TREELET;
}

void loader_expect_ahead(struct loader_private *h, loader_seat *seat) {
    uint32_t t = h->expect_from;
    seat->ahead_set = h->expected;
    seat->ahead_count = 0;
    if (h->expect_ahead > t)
        return;
    for (; t < h->expect_to && seat->ahead_count < LOADER_AHEAD; t++)
        if (h->held[t])
            seat->ahead[seat->ahead_count++] = t;
    h->expect_ahead = t;
}

void loader_expect(loader *l, uint32_t set) {
    struct loader_private *h = l->hidden;
    pthread_mutex_lock(&h->lock);
    if (set != h->expected)
        loader_expect_end(h);
    h->expected = set;
    if (l->file->versions && set != TREELET_NO_SET && set != h->set)
        loader_select_fresh(l, set);
    pthread_mutex_unlock(&h->lock);
}

bool loader_is_expecting(const loader *l) {
    struct loader_private *h = l->hidden;
    pthread_mutex_lock(&h->lock);
    const bool is = h->expected != TREELET_NO_SET;
    pthread_mutex_unlock(&h->lock);
    return is;
}

void loader_read_expected(loader *l, const atomic_uchar touched[]) {
    struct loader_private *h = l->hidden;
    const uint32_t treelets = l->file->layout.treelets;
    pthread_mutex_lock(&h->lock);
    /* Another step of a mesh that is refit takes the memory of this one. */
    if (h->expected != TREELET_NO_SET && h->expected != h->set && h->store.schema != MESH_REFIT) {
        for (uint32_t t = 0; t < treelets; t++)
            h->held[t] = atomic_load_explicit(&touched[t], memory_order_relaxed) &&
                         loader_expect_meets(l, h->expected, t) && is_absent(l, t);
        h->expect_from = h->expect_ahead = 0;
        h->expect_to = treelets;
        loader_reads_tell(h);
    }
    pthread_mutex_unlock(&h->lock);
}
