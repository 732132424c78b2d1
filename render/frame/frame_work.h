/* frame_work.h - what the threads of a frame do next, and what waits for which treelet.
 *
 * There is work of three kinds: tiles to begin, tiles to go on with, and batches of suspended rays.
 * A treelet's bucket holds the rays that wait for it, and the tiles that wait for it and perhaps
 * for others. When the treelet comes, they go on. A thread takes whatever can be done, and sleeps
 * only when there is nothing. It begins a tile only with records for all the tile's rays.
 *
 * A round ends for all threads when nothing can be done and no treelet is coming, or when the time
 * is over. In the first case the picture is done, or treelets have to be evicted to make room for
 * others, which is impossible while rays are traced. No thread waits for another, so threads may
 * also enter a round one after the other.
 *
 * Why a frame ends, with any number of slots and records from frame_records_min() on:
 *
 *   - A round ends. Before a thread sleeps or leaves, it gives its reserve of records back, and
 *     puts the tiles in its hand into buckets. So the last thread awake sees all records that no
 * ray has, and knows that there is nothing to do. If something waits for a treelet, this thread
 * lies down, and then asks the loaders whether they are reading. If so, the end of the read wakes
 * it (sleepers.h says why). If not, all treelets that have come are among the arrivals, which it
 *     checks last: a loader adds a treelet there before it says that it reads no more.
 *   - No arrival is overlooked. A thread that puts something into a bucket checks, holding the
 *     lock, whether the treelet is there. A thread that takes arrivals holds the lock, too, and
 *     empties the bucket then. A treelet is READY before it is an arrival. So if the first did not
 *     see it, the second comes later and finds what is in the bucket.
 *   - A tile waits only if there were free slots for its treelets. If other treelets took the slots
 *     first, the tile is taken up again after the round. Then the loader's queue is not empty and
 *     no slot is free, so the tile does not wait again, but suspends its rays one by one.
 *   - If tiles are left at the end of a round for lack of records, rays that wait have the records,
 *     since one tile needs no more than there are in all. loader_admit() loads at least one of the
 *     treelets that rays wait for, and no treelet is evicted before the end of the next round. So
 *     in each round at least one ray passes one treelet, and each ray passes finitely many.
 *
 * A loader's threads never take the lock. They leave treelets in a lock-free list (arrivals.h),
 * from which the frame's threads take them, and wake a sleeping thread, if there is one. While
 * holding the lock, a thread calls only lock-free functions of a loader, so that no thread waits
 * long for it. The records' lock may be taken within.
 */
#ifndef RENDER_FRAME_FRAME_WORK_H
#define RENDER_FRAME_FRAME_WORK_H

#include <stdatomic.h>

#include "formats/base/sleepers.h"
#include "render/frame/ray_records.h"

enum { WORK_BATCH = 256 }; /* most rays of an item */

/* The most treelets that a tile waits for at a time. */
enum { WORK_ABSENT_MAX = 8 };

enum { WORK_HAND = 16 }; /* most tiles in a thread's hand */

/* All that waits for one treelet. */
typedef struct work_bucket {
    uint32_t rays;  /* records, linked by ray_record.next */
    uint32_t tiles; /* linked by work_tile.next */
    uint32_t next;  /* in the list of buckets whose treelets have come */
} work_bucket;

typedef struct work_tile {
    uint32_t next;
    uint32_t absent[WORK_ABSENT_MAX]; /* treelets of the first volume that it waits for */
    uint32_t absent_count;
} work_tile;

/* A thread's reserve and the waiting tiles in its hand; zeroed to begin with. Waiting tiles go into
 * buckets when the thread takes the lock next, several for one lock. */
typedef struct work_hand {
    ray_reserve reserve;
    uint32_t tiles[WORK_HAND], tile_count;
} work_hand;

/* Element i is about loader i, and about object i, lookups included: there are no more loaders than
 * objects. */
typedef struct frame_numbers {
    loader *from;
    uint32_t first_of; /* of loader i: the number of its first treelet; */
    uint32_t first;    /* of the loader of object i */
} frame_numbers;

typedef struct frame_work {
    const frame *f;
    ray_records *records;
    uint32_t tile_rays; /* records that a tile must be promised */
    double until; /* once there was progress, begin no item after this time; INFINITY: no limit */
    atomic_bool progress; /* a tile or a ray got further since frame_work_begin() */
    /* The loaders of all volumes, each once, with the first number of its treelets: those of all
     * are numbered through. Objects of one volume share its loader, and so its buckets. */
    frame_numbers *numbers, only; /* where there is one object, this is it */
    int loader_count;
    uint32_t treelets; /* of all loaders */
    work_bucket *buckets;
    work_tile *tiles;
    uint32_t *order; /* of tiles to begin; the caller fills it */
    uint32_t tile_count;
    _Atomic uint32_t tiles_begun; /* index into order; may exceed tile_count: threads that find no
                                     tile left have incremented it, too */
    _Atomic uint32_t inside;      /* threads in the round */
    atomic_bool over;             /* the round is over; set with the lock held */
    atomic_bool look;             /* there is more to do than tiles to begin */
    sleepers sleepers;            /* threads of the round that find nothing to do */
    pthread_mutex_t lock;
    /* Guarded by lock: */
    uint32_t ready_first, ready_last; /* buckets whose treelets are READY */
    uint32_t resumable;               /* tiles to go on with */
    size_t hung_up;                   /* rays and tiles in buckets */
    uint32_t *waiting; /* treelets whose buckets were not empty at some time in this round */
    uint32_t waiting_count;
    loader_request *requests;
} frame_work;

typedef struct work_item {
    bool is_tile;
    uint32_t tile;
    uint32_t count, rays[WORK_BATCH]; /* records */
} work_item;

/* frame_work_init() - prepare for this many tiles. Call frame_work_release() also where it
 * fails. */
CHECKED status frame_work_init(frame_work *w, const frame *f, ray_records *records, uint32_t tiles);
void frame_work_release(frame_work *w);

/* frame_work_begin() - register with the loaders, and request again the treelets that rays wait
 * for. Until frame_work_end() only frame_work_admit() may use the loaders. until: a
 * clock_seconds().
 */
void frame_work_begin(frame_work *w, double until);
void frame_work_end(frame_work *w);

/* frame_work_bytes() - memory of a frame_work. */
size_t frame_work_bytes(const frame *f, size_t tiles);

/* frame_work_enter(), frame_work_leave() - call around a thread's part in a round. */
void frame_work_enter(frame_work *w);
void frame_work_leave(frame_work *w, work_hand *own);

/* frame_work_take() - set *item to what this thread is to do next. Returns false when the round is
 * over. May sleep. For a tile, records for all its rays are promised to the thread's reserve. As
 * long as there are only tiles to begin, it takes no lock. */
bool frame_work_take(frame_work *w, work_hand *own, work_item *item);

/* frame_work_suspend() - let at most WORK_BATCH rays wait for the treelets that their records name.
 * Gives back the promises of the reserve beyond what a tile needs. */
void frame_work_suspend(frame_work *w, work_hand *own, const uint32_t rays[], uint32_t count);

/* frame_work_wait() - request these treelets of the first volume, at most TILE_ABSENT_MAX, and let
 * a tile wait for them. Returns false if it should not wait, since there may be no slots for
 * them. */
bool frame_work_wait(frame_work *w, work_hand *own, uint32_t tile, const tile_treelet absent[],
                     int count);

/* frame_work_progress() - note that a tile or a ray got further. */
static inline void frame_work_progress(frame_work *w) {
    atomic_store_explicit(&w->progress, true, memory_order_relaxed);
}

/* frame_work_late() - whether the time is over. */
bool frame_work_late(const frame_work *w);

/* frame_work_stop() - end the round early. */
void frame_work_stop(frame_work *w);

/* Both are for the time between rounds. frame_work_done() - returns whether the picture is done. */
bool frame_work_done(frame_work *w);

/* frame_work_admit() - evict treelets and load others that rays wait for. Returns the error of a
 * treelet that failed. */
CHECKED status frame_work_admit(frame_work *w);

#endif
