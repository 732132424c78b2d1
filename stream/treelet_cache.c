#include "stream/treelet_cache.h"

void treelet_cache_init(treelet_cache *s, mem *m, uint32_t count) {
    *s = (treelet_cache){.of = mem_array(m, count, sizeof *s->of)};
}

void treelet_cache_release(treelet_cache *s, mem *m) {
    mem_free(m, s->of);
    *s = (treelet_cache){0};
}

void treelet_cache_put(treelet_cache *s, treelet *tr) {
    tr->newer = NULL;
    tr->older = s->newest;
    if (s->newest)
        s->newest->newer = tr;
    else
        s->oldest = tr;
    s->newest = tr;
    tr->next = s->of[tr->id];
    s->of[tr->id] = tr;
}

treelet *treelet_cache_find(const treelet_cache *s, uint32_t id, uint32_t set) {
    treelet *tr = s->of[id];
    while (tr && tr->set != set)
        tr = tr->next;
    return tr;
}

void treelet_cache_remove(treelet_cache *s, treelet *tr) {
    treelet **at = &s->of[tr->id];
    while (*at != tr)
        at = &(*at)->next;
    *at = tr->next;
    if (tr->newer)
        tr->newer->older = tr->older;
    else
        s->newest = tr->older;
    if (tr->older)
        tr->older->newer = tr->newer;
    else
        s->oldest = tr->newer;
}
