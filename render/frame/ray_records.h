/* ray_records.h - storage of suspended rays: a fixed number of records, each found by its number.
 *
 * Each thread has a reserve. Before a thread begins a tile, it makes sure that its reserve is
 * promised a record for every ray of the tile. Promises that the tile does not use stay for the
 * next one. So a lock is taken only after rays have suspended. Memory comes in chunks, and only
 * when records are taken.
 *
 * Why a promise is kept without waiting: no reserve has more free records at hand than are promised
 * to it. So enough records remain that no ray and no other reserve has.
 */
#ifndef RENDER_FRAME_RAY_RECORDS_H
#define RENDER_FRAME_RAY_RECORDS_H

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>

#include "render/frame/integrator.h"

enum { RAY_RECORDS_CHUNK = 4096 }; /* records allocated at once */

static const uint32_t ray_records_none = UINT32_MAX; /* no record's number */

typedef struct ray_records {
    mem *m;
    size_t record_bytes;
    uint32_t most; /* most records */
    char **chunks;
    pthread_mutex_t lock;
    /* Guarded by lock: */
    uint32_t made, begun; /* made: records that have memory; begun: records that were ever used */
    uint32_t free_head;   /* records no longer in use, and in no reserve */
    _Atomic uint32_t unpromised;
} ray_records;

/* A thread's own; zeroed to begin with. */
typedef struct ray_reserve {
    uint32_t promised; /* records that the thread may take, */
    uint32_t count;    /* and how many of them are at hand, from head */
    uint32_t head;
} ray_reserve;

/* ray_records_init() - room for `most` records, at least 1. Call ray_records_release() also where
 * it fails. */
CHECKED status ray_records_init(ray_records *r, mem *m, size_t record_bytes, uint32_t most);
void ray_records_release(ray_records *r);

/* ray_records_bytes() - memory that `most` records need beside the records themselves. */
size_t ray_records_bytes(size_t record_bytes, uint32_t most);

static inline ray_record *ray_records_at(const ray_records *r, uint32_t i) {
    return (ray_record *)(r->chunks[i / RAY_RECORDS_CHUNK] +
                          i % RAY_RECORDS_CHUNK * r->record_bytes);
}

/* ray_records_unpromised() - returns about how many records may be promised now. */
static inline uint32_t ray_records_unpromised(const ray_records *r) {
    return atomic_load_explicit(&r->unpromised, memory_order_relaxed);
}

/* ray_records_promise() - raise the promises of the reserve to `count` records. Returns false if
 * there are not enough. Takes no lock if so many are promised already. */
bool ray_records_promise(ray_records *r, ray_reserve *own, uint32_t count);

/* ray_records_keep() - give back all promises of the reserve beyond `count`. Returns whether there
 * were any. */
bool ray_records_keep(ray_records *r, ray_reserve *own, uint32_t count);

/* ray_records_take() - take a record that was promised; ST_NOMEM. */
CHECKED status ray_records_take(ray_records *r, ray_reserve *own, uint32_t *i);

/* ray_records_give() - return a record to the reserve. */
void ray_records_give(ray_records *r, ray_reserve *own, uint32_t i);

#endif
