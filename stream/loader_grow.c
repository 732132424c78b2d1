/* loader_grow.c - further steps of a file that grows: what is resident gets other numbers. */
#include "stream/loader_reads.h"

/* The number of a set, now that there are more steps than there were. */
static uint32_t renumbered(const loader *l, uint32_t steps, uint32_t set) {
    return set == TREELET_NO_SET ? set
                                 : leaf_layout_set(&l->file->layout, set / steps, set % steps);
}

static void renumber(const loader *l, uint32_t steps, const source_move *move, treelet *tr) {
    const struct loader_private *h = l->hidden;
    h->kind->renumber(&h->store, tr, renumbered(l, steps, tr->set),
                      source_moved(move, tr->payload));
}

status loader_grow(loader *l, uint32_t steps) {
    struct loader_private *h = l->hidden;
    source_move move;
    if (!h->kind->renumber)
        return status_describe(ST_UNSUPPORTED, "%s has further steps: open it again to see them",
                               file_path(l->file->source));
    pthread_mutex_lock(&h->lock);
    loader_reads_rest(h);
    status st = loader_reads_renew(l);
    if (st == ST_OK)
        st = source_extend(h->source, &move);
    if (st == ST_OK) {
        for (uint32_t i = 0; i < h->filled; i++)
            renumber(l, steps, &move, h->slots[i]);
        for (treelet *tr = h->cache.oldest; tr; tr = tr->newer)
            renumber(l, steps, &move, tr);
        h->set = renumbered(l, steps, h->set);
        h->expected = renumbered(l, steps, h->expected);
        h->early_set = renumbered(l, steps, h->early_set);
    }
    pthread_mutex_unlock(&h->lock);
    return st;
}

status loader_restart(loader *l) {
    struct loader_private *h = l->hidden;
    pthread_mutex_lock(&h->lock);
    const status renewed = loader_reads_renew(l);
    pthread_mutex_unlock(&h->lock);
    return renewed;
}
