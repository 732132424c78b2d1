#include "stream/shelf.h"

void shelf_init(shelf *s, mem *m, uint32_t count) {
    *s = (shelf){.of = mem_array(m, count, sizeof *s->of)};
}

void shelf_release(shelf *s, mem *m) {
    mem_free(m, s->of);
    *s = (shelf){0};
}

void shelf_put(shelf *s, treelet *tr) {
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

treelet *shelf_find(const shelf *s, uint32_t id, uint32_t set) {
    treelet *tr = s->of[id];
    while (tr && tr->set != set)
        tr = tr->next;
    return tr;
}

void shelf_remove(shelf *s, treelet *tr) {
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
