/* loader_steps.c - how much of each of several sets is in memory. */
#include <string.h>

#include "stream/loader_expect.h"

/* What is counted of sets [first, first + count). */
typedef struct counting {
    const loader *l;
    uint32_t first, count;
    loader_holding *out;
    uint32_t comparisons; /* that may still be made */
} counting;

#define HELD (UINT32_C(1) << 31) /* in a set's `wanted`: the cache holds its treelet, meanwhile */

/* Whether the treelet that is drawn, or one in the cache, is this set's, or the same. */
static bool has_same(counting *c, uint32_t set, uint32_t t) {
    const struct loader_private *h = c->l->hidden;
    if (loader_expect_serves(h, loader_peek(c->l, t), set))
        return true;
    for (const treelet *tr = h->cache.of[t]; tr && c->comparisons > 0; tr = tr->next) {
        c->comparisons--;
        if (loader_expect_serves(h, tr, set))
            return true;
    }
    return false;
}

static void count_treelet(counting *c, uint32_t t) {
    const struct loader_private *h = c->l->hidden;
    for (const treelet *tr = h->cache.of[t]; tr; tr = tr->next)
        if (tr->set >= c->first && tr->set < c->first + c->count)
            c->out[tr->set - c->first].wanted |= HELD;
    for (uint32_t i = 0; i < c->count; i++) {
        loader_holding *out = &c->out[i];
        const bool held = out->wanted & HELD;
        out->wanted &= ~HELD;
        if (!loader_expect_meets(c->l, c->first + i, t))
            continue;
        out->wanted++;
        out->resident += held || has_same(c, c->first + i, t);
    }
}

void loader_count_sets(loader *l, uint32_t first, uint32_t count, const atomic_uchar touched[],
                       loader_holding *out) {
    struct loader_private *h = l->hidden;
    const uint32_t treelets = l->file->layout.treelets;
    counting c = {l, first, count, out, LOADER_COUNTED_MAX};
    memset(out, 0, count * sizeof *out);
    uint64_t seen = 0, taken = 0;
    for (uint32_t t = 0; t < treelets; t++)
        seen += atomic_load_explicit(&touched[t], memory_order_relaxed) != 0;
    const uint64_t each = seen * count / LOADER_COUNTED_MAX + 1;
    pthread_mutex_lock(&h->lock);
    for (uint32_t t = 0; t < treelets; t++)
        if (atomic_load_explicit(&touched[t], memory_order_relaxed) && taken++ % each == 0)
            count_treelet(&c, t);
    pthread_mutex_unlock(&h->lock);
}
