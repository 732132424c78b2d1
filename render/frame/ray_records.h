/* ray_records.h - where suspended rays lie: so many records and no more, each found by its number.
 *
 * Each thread has a reserve. Before it begins a tile it makes sure that its reserve has a record
 * promised for every ray of the tile; what the tile does not need stays promised for the next one.
 * So a lock is taken only after rays have suspended. Memory comes in chunks, and only when records
 * are taken.
 *
 * A promise is kept without waiting for anybody: a reserve never has more free records at hand than
 * are promised to it. So what is neither a ray's nor at hand elsewhere suffices for it.
 */
#ifndef RENDER_FRAME_RAY_RECORDS_H
#define RENDER_FRAME_RAY_RECORDS_H

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>

#include "render/frame/integrator.h"

enum { RAY_RECORDS_CHUNK = 4096 }; /* records allocated at once */

static const uint32_t ray_records_none = UINT32_MAX; /* the number of no record */

typedef struct ray_records {
    mem *m;
    size_t record_bytes;
    uint32_t most; /* there may be */
    char **chunks;
    pthread_mutex_t lock;
    /* Guarded by lock: */
    uint32_t made, begun; /* have memory; of these, have been in use */
    uint32_t free_head;   /* no longer in use, and at no thread's hand */
    _Atomic uint32_t unpromised;
} ray_records;

/* A thread's own; zeroed to begin with. */
typedef struct ray_reserve {
    uint32_t promised; /* records that it may take, */
    uint32_t count;    /* of which so many are at hand: */
    uint32_t head;
} ray_reserve;

/* ray_records_init() - most: at least 1. Released also where it fails. */
CHECKED status ray_records_init(ray_records *r, mem *m, size_t record_bytes, uint32_t most);
void ray_records_release(ray_records *r);

/* ray_records_bytes() - memory beside the records, for at most so many. */
size_t ray_records_bytes(size_t record_bytes, uint32_t most);

static inline ray_record *ray_records_at(const ray_records *r, uint32_t i) {
    return (ray_record *)(r->chunks[i / RAY_RECORDS_CHUNK] +
                          i % RAY_RECORDS_CHUNK * r->record_bytes);
}

/* ray_records_unpromised() - how many may be promised now, about. */
static inline uint32_t ray_records_unpromised(const ray_records *r) {
    return atomic_load_explicit(&r->unpromised, memory_order_relaxed);
}

/* ray_records_promise() - whether so many are promised to the reserve now; no lock if they were. */
bool ray_records_promise(ray_records *r, ray_reserve *own, uint32_t count);

/* ray_records_keep() - the reserve keeps at most so many promised; the others may have the rest.
 * Whether there was any. */
bool ray_records_keep(ray_records *r, ray_reserve *own, uint32_t count);

/* ray_records_take() - one that was promised; ST_NOMEM. ray_records_give() - back to the reserve.
 */
CHECKED status ray_records_take(ray_records *r, ray_reserve *own, uint32_t *i);
void ray_records_give(ray_records *r, ray_reserve *own, uint32_t i);

#endif
