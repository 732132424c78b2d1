#include "prep/import/vdb/vdb_memory.h"

#include "prep/import/import_limits.h"

static mem own; /* counts while no budget is joined */
static mem *budget = &own;
static atomic_size_t library; /* bytes from operator new, in either budget */

bool vdb_memory_take(size_t bytes) {
    mem *m = budget;
    const size_t used = atomic_fetch_add(&m->used, bytes) + bytes;
    if (m->limit && used > m->limit) {
        atomic_fetch_sub(&m->used, bytes);
        import_limits_refused(bytes);
        return false;
    }
    atomic_fetch_add(&library, bytes);
    size_t peak = atomic_load(&m->peak);
    while (used > peak && !atomic_compare_exchange_weak(&m->peak, &peak, used)) {}
    return true;
}

void vdb_memory_give(size_t bytes) {
    atomic_fetch_sub(&library, bytes);
    atomic_fetch_sub(&budget->used, bytes);
}

void vdb_memory_join(mem *m) {
    mem *to = m ? m : &own;
    const size_t bytes = atomic_load(&library);
    atomic_fetch_sub(&budget->used, bytes);
    atomic_fetch_add(&to->used, bytes);
    budget = to;
}
