/* frame_work.h - what the threads of a frame do next, and what waits for which treelet.
 *
 * There are tiles to begin, tiles to go on with, and batches of suspended rays. A treelet's bucket
 * holds the rays that wait for it and the tiles that wait for it among others; when it comes, they
 * go on. A thread takes whatever can be done, waits for the next treelet only when there is
 * nothing, and begins no tile for whose rays it has no records. A round ends, for all threads, only
 * when nothing can be done and nothing more comes: the picture is done, or it is stuck until
 * treelets give way to others, which they cannot while rays are traced; or when the time is over.
 * No thread waits for another, so threads may also come into a round one after the other.
 *
 * Why a frame ends, with any number of slots and records from frame_records_min() on:
 *
 *   - A round ends. A thread gives its reserve of records back, and hangs up the tiles in its hand,
 *     before it sleeps or leaves. The last one awake of those inside sees every record that is no
 *     ray's and finds nothing to do. If something waits for a treelet, it lies down and then asks
 *     the loaders whether they are reading. If so, the end of that read finds it lying, and wakes
 *     it (sleepers.h says why). If not, all that has come is among the arrivals, at which it looks
 *     last: a loader adds a treelet there before it says that it reads no more.
 *   - Nothing that has come is overlooked. Who hangs something up for a treelet looks whether it is
 *     there while holding the lock; who takes arrivals holds it, too, and looks through the bucket
 *     then. A treelet is READY before it is an arrival: if the first did not see it, the second
 *     comes later and finds what hangs there.
 *   - A tile waits only where its treelets had slots at that time. If others were quicker and
 *     slots ran out, the tile is taken up again at the end of the round; as the queue of the
 *     loader is not empty then, and slots are not free, it does not wait again but suspends its
 *     rays one by one.
 *   - If tiles are left at the end of a round for want of records, then rays have these, and wait:
 *     one tile needs no more than there are in all. loader_admit() makes at least one of the
 *     treelets come that rays wait for, and no treelet goes before the next round's end. So at
 *     least one ray gets behind one treelet in each round, and its way is finite.
 *
 * A loader's threads never take the lock. They leave treelets in a list without a lock
 * (arrivals.h), from which the frame's threads take them, and wake one that sleeps, if any does.
 * Nobody who holds the lock calls a loader but for what is lock-free there, so that nobody waits
 * long for it; the records' lock may be taken within.
 */
#ifndef RENDER_FRAME_FRAME_WORK_H
#define RENDER_FRAME_FRAME_WORK_H

#include <stdatomic.h>

#include "formats/base/sleepers.h"
#include "render/frame/ray_records.h"

enum { WORK_BATCH = 256 }; /* rays an item, at most */

/* Treelets that a tile waits for at a time, at most. */
enum { WORK_ABSENT_MAX = 8 };

enum { WORK_HAND = 16 }; /* tiles that a thread has in hand, at most */

/* What waits for one treelet. */
typedef struct work_bucket {
    uint32_t rays;  /* records, linked by ray_record.next */
    uint32_t tiles; /* linked by work_tile.next */
    uint32_t next;  /* among those whose treelets have come */
} work_bucket;

typedef struct work_tile {
    uint32_t next;
    uint32_t absent[WORK_ABSENT_MAX]; /* the treelets that it waits for, of the first volume */
    uint32_t absent_count;
} work_tile;

/* What a thread has in its hand; zeroed to begin with. Tiles that wait are hung up when it takes
 * the lock next, several for one lock. */
typedef struct work_hand {
    ray_reserve reserve;
    uint32_t tiles[WORK_HAND], tile_count;
} work_hand;

typedef struct frame_work {
    const frame *f;
    ray_records *records;
    uint32_t tile_rays; /* what a tile must be promised */
    double until; /* no item is begun later, once there was progress; INFINITY: none is late */
    atomic_bool progress; /* since frame_work_begin(): a tile or a ray got further */
    /* Treelets of all volumes, numbered through. */
    uint32_t first[FRAME_VOLUMES_MAX + 1];
    work_bucket *buckets;
    work_tile *tiles;
    uint32_t *order; /* of tiles: as they are begun; the caller's to fill */
    uint32_t tile_count;
    _Atomic uint32_t tiles_begun; /* in order; threads that find no more count on */
    _Atomic uint32_t inside;      /* threads in the round */
    atomic_bool over;             /* the round is; set with the lock held */
    atomic_bool look;             /* there is more to look at than tiles to begin */
    sleepers sleepers;            /* threads of the round that find nothing to do */
    pthread_mutex_t lock;
    /* Guarded by lock: */
    uint32_t come_first, come_last; /* buckets whose treelets have come */
    uint32_t resumable;             /* tiles to go on with */
    size_t hung_up;                 /* rays and tiles in buckets */
    uint32_t *waiting; /* treelets whose buckets were not empty at some time in this round */
    uint32_t waiting_count;
    loader_request *requests;
} frame_work;

typedef struct work_item {
    bool is_tile;
    uint32_t tile;
    uint32_t count, rays[WORK_BATCH]; /* records */
} work_item;

/* frame_work_init() - for this many tiles. Released also where it fails. */
CHECKED status frame_work_init(frame_work *w, const frame *f, ray_records *records, uint32_t tiles);
void frame_work_release(frame_work *w);

/* frame_work_begin() - from here to frame_work_end() loaders are listened to, and nobody else may
 * use them but frame_work_admit(). What waited before is asked for again. until: clock_seconds().
 */
void frame_work_begin(frame_work *w, double until);
void frame_work_end(frame_work *w);

/* frame_work_bytes() - memory that it takes. */
size_t frame_work_bytes(uint32_t treelets, size_t tiles);

/* frame_work_enter(), frame_work_leave() - around a thread's part in a round. */
void frame_work_enter(frame_work *w);
void frame_work_leave(frame_work *w, work_hand *own);

/* frame_work_take() - what to do next; false when the round is over. Records for a tile's rays are
 * promised to the thread's reserve. No lock for a tile that is begun while nothing else can be
 * done. */
bool frame_work_take(frame_work *w, work_hand *own, work_item *item);

/* frame_work_suspend() - these rays wait for the treelets that their records name; at most
 * WORK_BATCH. What the reserve has more than a tile needs is given back. */
void frame_work_suspend(frame_work *w, work_hand *own, const uint32_t rays[], uint32_t count);

/* frame_work_wait() - a tile goes on when these treelets of the first volume have come, and asks
 * for them; at most TILE_ABSENT_MAX. False: it had better not wait, since there may be no slots
 * for them. */
bool frame_work_wait(frame_work *w, work_hand *own, uint32_t tile, const tile_treelet absent[],
                     int count);

/* frame_work_progress() - a tile or a ray got further than it was. */
static inline void frame_work_progress(frame_work *w) {
    atomic_store_explicit(&w->progress, true, memory_order_relaxed);
}

/* frame_work_late() - the time is over. */
bool frame_work_late(const frame_work *w);

/* frame_work_stop() - end the round early. */
void frame_work_stop(frame_work *w);

/* frame_work_done() - between rounds: nothing is left to do. frame_work_admit() - something can be
 * done again, unless nothing is left. Returns the error of a treelet that failed. */
bool frame_work_done(frame_work *w);
CHECKED status frame_work_admit(frame_work *w);

#endif
