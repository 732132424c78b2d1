/* loader_private.h - the members of a loader, for the files loader*.c alone.
 *
 * loader_slots.h      what is resident, and its memory
 * loader_reads.h      the queue, and one read at a time from it
 * loader_expect.h     what is read of another set before that is selected
 * loader_requests.c   what rays ask for, and waiting for it
 * loader_select.c     another interest, set or capacity
 * loader_grow.c       further steps of the file
 * loader_steps.c      how much of other sets is in memory
 * loader.c            making and ending, masks, statistics
 */
#ifndef STREAM_LOADER_PRIVATE_H
#define STREAM_LOADER_PRIVATE_H

#include <pthread.h>

#include "stream/loader.h"
#include "stream/treelet_cache.h"

typedef enum residence { ABSENT, QUEUED, LOADING, READY, FAILED } residence;

/* Of how many requests behind the most urgent one the system is asked to read ahead. */
enum { LOADER_AHEAD = 16 };

/* Scratch for one read; there is one per read that may run at a time. */
typedef struct loader_seat {
    resident_scratch scratch;
    uint32_t ahead[LOADER_AHEAD]; /* treelets to read ahead, once the lock is released */
    uint32_t ahead_count;
    uint32_t ahead_set;       /* of this set */
    struct loader_seat *next; /* in the list of free seats */
} loader_seat;

/* A payload that treelets of several sets share. */
typedef struct loader_shared {
    const void *payload;
    uint32_t users;
} loader_shared;

struct loader_private {
    source *source;
    const resident_kind *kind;
    resident_store store;
    pthread_mutex_t lock;
    pthread_cond_t done;
    /* Guarded by lock: */
    atomic_uchar *state;   /* residence, per treelet; ABSENT or not: readable without the lock */
    loader_request *queue; /* binary heap, smallest priority first */
    size_t queued;
    uint32_t rows, row;    /* leaf_file_rows(); that of the treelet that was read last */
    uint8_t *ahead;        /* per QUEUED treelet: 1: it is being read ahead */
    treelet **slots;       /* READY treelets, oldest first */
    treelet_cache cache;   /* ABSENT treelets, while nothing else needs their memory */
    loader_shared *shared; /* per treelet; NULL: nothing is shared */
    uint32_t filled, loading, capacity;
    uint32_t early;                    /* reads under way for the expected set */
    uint32_t expected;                 /* loader_expect(); TREELET_NO_SET: none */
    uint32_t expect_from, expect_to;   /* treelets that loader_expect_next() still looks at */
    uint32_t expect_ahead;             /* those before this one are being read ahead */
    uint32_t early_set;                /* of what was read early last; TREELET_NO_SET: of none */
    uint64_t early_loads, early_bytes; /* which count once that set is selected */
    _Atomic uint32_t claimed;          /* filled, loading and queued; readable without the lock */
    size_t bytes, room;                /* memory of all treelets; the most that it may be */
    uint64_t published;                /* how often a treelet became READY */
    uint32_t sweep_end;                /* the sweep wants treelets before this one; 0: none */
    bool stepped;                      /* another set was selected since the last loader_follow() */
    status_note failure;
    bool tolerant;   /* loader_tolerate() */
    uint32_t lost;   /* treelets that are FAILED, and tolerated */
    status_note why; /* of the first of them */
    loader_stats stats;
    loader_seat *free_seats;
    atomic_bool reading; /* loader_is_reading() */
    sleepers *listeners; /* loader_listen() */
    interest selected;   /* read-only while anything is traced or loaded */
    atomic_size_t masks; /* how many were made */
    uint8_t *existing;   /* per treelet: octants that exist */
    uint8_t *held;       /* per treelet: its subtree meets the interest, scratch of sweep(); then 1:
                            it is to be read for the expected set */
    treelet_tree tree;   /* for a mesh, whose treelets overlap */
    uint32_t set;        /* the selected one, */
    uint64_t version;    /* as often as it had changed when it was selected */
    size_t slot_bytes;
    readers *readers, *own_readers; /* own_readers NULL: the caller's readers */
    reader_customer customer;
    bool joined;
    loader_seat *seats;
    int seats_made;
    leaf_shells *shells; /* of all seats; NULL: the file has none */
};

/* loader_select_fresh() - free a set's treelets whose samples have changed since they were read,
 * but for those that can be brought up to date. Needs the lock; only while nothing is traced. */
void loader_select_fresh(loader *l, uint32_t set);

#endif
