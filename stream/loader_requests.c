/* loader_requests.c - what rays ask a loader for, and waiting for it. */
#include <stdlib.h>

#include "stream/loader_reads.h"
#include "stream/loader_slots.h"

void loader_rest(loader *l) {
    struct loader_private *h = l->hidden;
    pthread_mutex_lock(&h->lock);
    loader_reads_rest(h);
    pthread_mutex_unlock(&h->lock);
}

static void want_locked(loader *l, uint32_t t, uint64_t priority) {
    struct loader_private *h = l->hidden;
    if (loader_slots_state(h, t) != ABSENT)
        return;
    loader_slots_set_state(h, t, QUEUED);
    loader_reads_push(h, (loader_request){t, priority});
}

void loader_want(loader *l, const loader_request *requests, size_t count) {
    struct loader_private *h = l->hidden;
    size_t i = 0;
    while (i < count && loader_slots_state(h, requests[i].t) != ABSENT)
        i++;
    if (i == count)
        return;
    pthread_mutex_lock(&h->lock);
    for (; i < count; i++)
        want_locked(l, requests[i].t, requests[i].priority);
    loader_reads_tell(h);
    pthread_mutex_unlock(&h->lock);
}

static void sweep_locked(loader *l) {
    for (uint32_t t = 0; t < l->hidden->sweep_end; t++)
        if (l->own[t])
            want_locked(l, t, UINT64_MAX);
}

/* The end of the treelets before `end`, from the first one on, whose absent ones have up to `bytes`
 * in the file. Needs the lock. */
static uint32_t end_of_part(const loader *l, uint32_t end, uint64_t bytes) {
    uint64_t absent = 0;
    uint32_t family = LEAF_NO_TREELET, t = 0;
    for (bool any = false; t < end; t++) {
        if (!l->own[t] || loader_slots_state(l->hidden, t) != ABSENT)
            continue;
        absent += loader_stored_bytes(l, t, &family);
        if (any && absent > bytes)
            break;
        any = true;
    }
    return t;
}

/* The end of the treelets of this level and of coarser ones, which come first. */
static uint32_t end_of_level(const leaf_layout *layout, uint32_t level) {
    return level > 0 ? layout->level[level - 1].first : layout->treelets;
}

uint32_t loader_level_within(loader *l, uint32_t level, uint64_t bytes) {
    const leaf_layout *layout = &l->file->layout;
    pthread_mutex_lock(&l->hidden->lock);
    const uint32_t end = end_of_part(l, end_of_level(layout, level), bytes);
    pthread_mutex_unlock(&l->hidden->lock);
    while (level + 1U < layout->levels && end_of_level(layout, level) > end)
        level++;
    return level;
}

void loader_sweep_level(loader *l, uint32_t level, uint64_t bytes) {
    struct loader_private *h = l->hidden;
    const uint32_t end = end_of_level(&l->file->layout, level);
    pthread_mutex_lock(&h->lock);
    h->sweep_end = bytes < UINT64_MAX ? end_of_part(l, end, bytes) : end;
    sweep_locked(l);
    loader_reads_tell(h);
    pthread_mutex_unlock(&h->lock);
}

static void wait_idle(struct loader_private *h) {
    while (h->failure.st == ST_OK && loader_reads_pending(h))
        pthread_cond_wait(&h->done, &h->lock);
}

void loader_follow(loader *l, const atomic_uchar touched[]) {
    struct loader_private *h = l->hidden;
    pthread_mutex_lock(&h->lock);
    for (uint32_t t = 0; h->stepped && t < l->file->layout.treelets; t++)
        if (l->own[t] && atomic_load_explicit(&touched[t], memory_order_relaxed))
            want_locked(l, t, 0);
    if (h->stepped) {
        loader_reads_tell(h);
        wait_idle(h);
    }
    h->stepped = false;
    pthread_mutex_unlock(&h->lock);
}

static int by_priority(const void *a, const void *b) {
    return loader_reads_before(a, b) ? -1 : 1;
}

/* Returns the first failure, with its description, or ST_OK. */
static status failure_of(const struct loader_private *h) {
    return h->failure.st == ST_OK ? ST_OK : status_note_raise(&h->failure);
}

status loader_admit(loader *l, loader_request *requests, size_t count) {
    struct loader_private *h = l->hidden;
    qsort(requests, count, sizeof *requests, by_priority);
    pthread_mutex_lock(&h->lock);
    loader_reads_quiesce(h);
    bool ready = false;
    for (size_t i = 0; i < count; i++) {
        if (loader_slots_state(h, requests[i].t) == ABSENT && h->filled < h->capacity)
            (void)loader_slots_take_back(l, requests[i].t);
        ready = ready || loader_has_come(l, requests[i].t);
    }
    if (!ready) {
        /* Evict the oldest: rays go front to back, and have left those behind. */
        const uint32_t room = count < h->capacity ? (uint32_t)count : h->capacity;
        const uint32_t fit = h->capacity - h->filled;
        loader_slots_evict(l, room > fit ? room - fit : 0);
    }
    for (size_t i = 0; i < count; i++)
        want_locked(l, requests[i].t, requests[i].priority);
    /* Sweep into the slots that rays leave free. */
    if (h->sweep_end > 0 && h->filled + h->queued < h->capacity)
        sweep_locked(l);
    loader_reads_tell(h);
    const uint64_t before = h->published + h->lost;
    while (!ready && h->published + h->lost == before && h->failure.st == ST_OK)
        pthread_cond_wait(&h->done, &h->lock);
    status st = failure_of(h);
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
    status st = failure_of(h);
    pthread_mutex_unlock(&h->lock);
    return st;
}

status loader_failure(loader *l) {
    struct loader_private *h = l->hidden;
    pthread_mutex_lock(&h->lock);
    status st = failure_of(h);
    pthread_mutex_unlock(&h->lock);
    return st;
}

void loader_forget_failures(loader *l) {
    struct loader_private *h = l->hidden;
    pthread_mutex_lock(&h->lock);
    loader_reads_rest(h);
    if (h->failure.st != ST_OK || h->lost > 0)
        for (uint32_t t = 0; t < l->file->layout.treelets; t++)
            if (loader_slots_state(h, t) == FAILED)
                loader_slots_set_state(h, t, ABSENT);
    h->failure.st = ST_OK;
    h->tolerant = false;
    h->lost = 0;
    pthread_mutex_unlock(&h->lock);
}

/* ---- what cannot be read ---- */

void loader_tolerate(loader *l) {
    pthread_mutex_lock(&l->hidden->lock);
    l->hidden->tolerant = true;
    pthread_mutex_unlock(&l->hidden->lock);
}

bool loader_is_lost(const loader *l, uint32_t t) {
    return l->hidden->tolerant && loader_slots_state(l->hidden, t) == FAILED;
}

uint32_t loader_stand_in(const loader *l, uint32_t t) {
    const leaf_layout *layout = &l->file->layout;
    while (layout->level_of[t] + 1U < layout->levels) {
        t = leaf_layout_parent(layout, t);
        if (!loader_is_lost(l, t))
            return l->own[t] ? t : LEAF_NO_TREELET;
    }
    return LEAF_NO_TREELET;
}

uint32_t loader_lost(loader *l, const char **why) {
    struct loader_private *h = l->hidden;
    pthread_mutex_lock(&h->lock);
    const uint32_t count = h->lost;
    *why = h->why.text;
    pthread_mutex_unlock(&h->lock);
    return count;
}
