#include "stream/arrivals.h"

status arrivals_init(arrivals *a, mem *m, uint32_t treelets) {
    atomic_init(&a->first, arrivals_end);
    a->next = mem_array(m, treelets, sizeof *a->next);
    a->there = mem_array(m, treelets, sizeof *a->there);
    return a->next && a->there ? ST_OK : ST_NOMEM;
}

void arrivals_release(arrivals *a, mem *m) {
    mem_free(m, a->there);
    mem_free(m, a->next);
}

/* Both sides exchange `there`, so the second to do it sees all that the first did before. */
void arrivals_add(arrivals *a, uint32_t t) {
    if (atomic_exchange(&a->there[t], 1))
        return;
    uint32_t first = atomic_load(&a->first);
    do
        a->next[t] = first;
    while (!atomic_compare_exchange_weak(&a->first, &first, t));
}

uint32_t arrivals_take(arrivals *a) {
    return arrivals_any(a) ? atomic_exchange(&a->first, arrivals_end) : arrivals_end;
}

uint32_t arrivals_after(arrivals *a, uint32_t t) {
    const uint32_t next = a->next[t];
    atomic_exchange(&a->there[t], 0);
    return next;
}
