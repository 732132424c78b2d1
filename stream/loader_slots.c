#include "stream/loader_slots.h"

#include <string.h>

const void *loader_slots_share(struct loader_private *h, uint32_t t) {
    if (!h->shared)
        return NULL;
    h->shared[t].users++;
    return h->shared[t].payload;
}

void loader_slots_release(struct loader_private *h, uint32_t t) {
    if (!h->shared || --h->shared[t].users > 0 || !h->shared[t].payload)
        return;
    source_evict(h->source, t, h->shared[t].payload);
    h->bytes -= h->kind->shared_bytes(&h->store, t);
    h->shared[t].payload = NULL;
}

void loader_slots_offer(struct loader_private *h, treelet *tr) {
    if (!h->shared || !tr->payload || tr->alone || h->shared[tr->id].payload == tr->payload)
        return;
    tr->alone = h->shared[tr->id].payload != NULL;
    if (!tr->alone)
        h->shared[tr->id].payload = tr->payload;
    h->bytes += h->kind->shared_bytes(&h->store, tr->id);
}

/* Free the payload that only one treelet has. */
static void free_alone(struct loader_private *h, uint32_t t, const void *payload) {
    source_evict(h->source, t, payload);
    h->bytes -= h->kind->shared_bytes(&h->store, t);
}

residence loader_slots_state(const struct loader_private *h, uint32_t t) {
    return (residence)atomic_load_explicit(&h->state[t], memory_order_relaxed);
}

static bool claims_slot(residence r) {
    return r == QUEUED || r == LOADING || r == READY;
}

void loader_slots_set_state(struct loader_private *h, uint32_t t, residence to) {
    const uint32_t claimed = atomic_load_explicit(&h->claimed, memory_order_relaxed);
    const int more = claims_slot(to) - claims_slot(loader_slots_state(h, t));
    atomic_store_explicit(&h->state[t], (unsigned char)to, memory_order_relaxed);
    atomic_store_explicit(&h->claimed, claimed + (uint32_t)more, memory_order_relaxed);
}

void loader_slots_publish(loader *l, treelet *tr) {
    struct loader_private *h = l->hidden;
    loader_slots_set_state(h, tr->id, READY);
    h->slots[h->filled++] = tr;
    h->published++;
    atomic_store_explicit(&l->resident[tr->id], tr, memory_order_release);
    arrivals_add(&l->arrivals, tr->id);
}

void loader_slots_discard(loader *l, treelet *tr) {
    struct loader_private *h = l->hidden;
    const uint32_t t = tr->id;
    const void *alone = tr->alone ? tr->payload : NULL;
    h->bytes -= tr->bytes;
    h->kind->destroy(&h->store, tr);
    if (alone)
        free_alone(h, t, alone);
    loader_slots_release(h, t);
}

void loader_slots_withdraw(loader *l, treelet *tr) {
    atomic_store_explicit(&l->resident[tr->id], NULL, memory_order_relaxed);
    loader_slots_set_state(l->hidden, tr->id, ABSENT);
}

bool loader_slots_make_room(loader *l, uint32_t more) {
    struct loader_private *h = l->hidden;
    const size_t wanted = (size_t)(h->loading + h->early + more) * h->slot_bytes;
    while (h->cache.oldest && (h->bytes > h->room || h->room - h->bytes < wanted)) {
        treelet *tr = h->cache.oldest;
        treelet_cache_remove(&h->cache, tr);
        loader_slots_discard(l, tr);
    }
    return h->bytes <= h->room && h->room - h->bytes >= wanted;
}

void loader_slots_evict(loader *l, uint32_t count) {
    struct loader_private *h = l->hidden;
    for (uint32_t i = 0; i < count; i++) {
        loader_slots_withdraw(l, h->slots[i]);
        loader_slots_discard(l, h->slots[i]);
    }
    h->filled -= count;
    memmove(h->slots, h->slots + count, h->filled * sizeof *h->slots);
}

bool loader_slots_fits(loader *l, treelet *tr) {
    struct loader_private *h = l->hidden;
    if (tr->set == h->set)
        return true;
    if (tr->set == TREELET_NO_SET || !h->kind->same ||
        treelet_cache_find(&h->cache, tr->id, h->set) || !h->kind->same(&h->store, tr, h->set))
        return false;
    h->kind->adopt(&h->store, tr, h->set);
    return true;
}

bool loader_slots_take_back(loader *l, uint32_t t) {
    struct loader_private *h = l->hidden;
    treelet *tr = treelet_cache_find(&h->cache, t, h->set);
    for (treelet *other = h->cache.of[t]; other && !tr; other = other->next)
        tr = loader_slots_fits(l, other) ? other : NULL;
    if (!tr)
        return false;
    treelet_cache_remove(&h->cache, tr);
    loader_slots_publish(l, tr);
    return true;
}

size_t loader_slots_most_bytes(const loader *l) {
    const struct loader_private *h = l->hidden;
    size_t most = 0;
    for (uint32_t t = 0; t < l->file->layout.treelets; t++) {
        const size_t bytes = h->kind->bytes(&h->store, t);
        most = bytes > most ? bytes : most;
    }
    return most;
}
