/* loader.h - treelets at run time: which are needed, which are resident, and the threads that bring
 * them in.
 *
 * The sweep (M08 4.4.1) over the directory says which treelets' ranges meet the interest; those
 * that are wanted are read, checked, given their masks of active cells and published by threads
 * (readers.h) that several loaders may share, most urgent first, into at most `capacity` slots. A
 * treelet goes ABSENT -> QUEUED -> LOADING -> READY, or to FAILED. READY treelets stay until
 * loader_admit(), loader_set_capacity() or another selection takes them away, which only happens
 * while no ray is being traced.
 *
 * Another selection costs no more than its sweep: whoever looks a READY treelet up first makes its
 * new masks, and treelets that do not meet the new interest go to a cache, where they keep what
 * they have read until their slot is needed or they are of interest again. So do those of a mesh's
 * other fields and time steps, with their masks (schema trees); or a step's vertices give way to
 * the next one's, and the tree is refit (mesh_resident.h).
 *
 * Render threads look treelets up with one acquire load of the treelet and one of its masks' state,
 * and may call loader_want(); everything else belongs to the thread that owns the loader.
 */
#ifndef STREAM_LOADER_H
#define STREAM_LOADER_H

#include <stdatomic.h>
#include <stdbool.h>

#include "formats/base/cpu.h"
#include "formats/base/sleepers.h"
#include "formats/leaf/leaf_file.h"
#include "stream/arrivals.h"
#include "stream/readers.h"
#include "stream/resident.h"
#include "stream/source.h"
#include "stream/treelet.h"
#include "stream/treelet_tree.h"

#define LOADER_MASKING SIZE_MAX /* some thread is making them */

typedef struct loader_stats {
    uint64_t loads, bytes_read;
    uint64_t bytes_read_ever; /* since the loader was made, whatever was reset */
    double load_s;            /* summed over workers */
    uint64_t masks;           /* made, of treelets just read and of resident ones */
    uint64_t bytes_resident;  /* now: of all treelets, drawn or not */
} loader_stats;

typedef struct loader {
    mem *m;
    leaf_file *file;
    /* Per treelet, for the selected interest; read-only while tracing. */
    uint8_t *own;      /* 1: the range of its own level meets it, and it must be looked at */
    uint8_t *whole;    /* 1: it meets it, but is taken whole (homogeneous.h): it is not read */
    uint8_t *children; /* octants whose subtree meets it, by the merged ranges */
    _Atomic(treelet *) *resident;
    arrivals arrivals;        /* that became READY or FAILED; the listeners' to take */
    const treelet_tree *tree; /* where treelets overlap; else NULL */
    size_t selection;         /* how many different ones there were */
    uint64_t bytes_active;
    uint32_t treelets_active;
    struct loader_private *hidden;
} loader;

/* How to read. */
typedef struct loader_options {
    source_kind source;
    mesh_schema schema;   /* of a mesh's steps */
    int workers;          /* threads that read for it at a time, at least 1 */
    cpu_isa isa;          /* for active_for() */
    mesh_derived derived; /* of a mesh's treelets, with their masks */
} loader_options;

/* loader_create() - nothing is selected yet; of a mesh, its first set is. given: threads that read
 * for other loaders, too, and outlive this one; at least `workers` of them from then on. NULL:
 * `workers` of its own. */
CHECKED status loader_create(mem *m, leaf_file *f, const loader_options *o, readers *given,
                             loader **out);
void loader_destroy(loader *l); /* waits for reads under way; NULL is fine */

/* loader_readers() - its threads, for another loader that lives shorter. */
readers *loader_readers(const loader *l);

/* loader_select() - what the coming frames need of the volume (copied). One pass over the
 * directory, and none when it is the same as before. */
void loader_select(loader *l, const interest *in);

/* loader_select_set() - the set of a mesh's values, and the step, that the coming frames show. A
 * pass over the directory, and none when it is the same as before. */
void loader_select_set(loader *l, uint32_t set);

/* loader_follow() - after another set was selected: bring in the active treelets among those that
 * rays touched last, and wait for them. What was seen of one step is mostly what will be of the
 * next, and rays need not wait for it one by one. As far as there are slots; trouble is
 * loader_failure()'s. Only while nothing is traced. */
void loader_follow(loader *l, const atomic_uchar touched[]);

/* loader_select_gradients() - whether the coming frames need the gradients of a mesh, which its
 * file must have then. What is resident gives its values back when that changes. */
void loader_select_gradients(loader *l, bool needed);

/* loader_slot_bytes() - memory that one resident treelet costs; with this the caller turns a
 * budget into slots. loader_stored_bytes() - what the file holds of a treelet in the selected set.
 */
size_t loader_slot_bytes(const loader *l);
uint64_t loader_stored_bytes(const loader *l, uint32_t t);

/* loader_set_capacity() - at most so many treelets that are drawn, at least 1, and the cache in
 * what they leave of their memory and `beside` bytes; evicts what is too many. */
void loader_set_capacity(loader *l, uint32_t slots, size_t beside);

/* loader_clear() - give all treelets back. Only while nothing is traced. */
void loader_clear(loader *l);

/* loader_mask() - what loader_lookup() calls for a treelet whose masks are of another selection:
 * makes them, or waits for the thread that does (2 to 5 us a treelet of 32^3 cells, no lock, no
 * reading). */
void loader_mask(const loader *l, treelet *tr);

/* loader_lookup() - the treelet if it is READY, with masks of the selected interest, else NULL.
 * Any thread. Never waits for a read. */
static inline const treelet *loader_lookup(const loader *l, uint32_t t) {
    treelet *tr = atomic_load_explicit(&l->resident[t], memory_order_acquire);
    if (tr && atomic_load_explicit(&tr->masked, memory_order_acquire) != l->selection)
        loader_mask(l, tr);
    return tr;
}

/* loader_prefetch() - loader_lookup() is to come: what it looks at may be on its way by then. */
static inline void loader_prefetch(const loader *l, uint32_t t) {
    const treelet *tr = atomic_load_explicit(&l->resident[t], memory_order_relaxed);
    if (tr) {
        __builtin_prefetch(&tr->payload);
        __builtin_prefetch(&tr->masked);
    }
}

/* loader_peek() - the treelet if it is READY, whatever its masks are of, else NULL. */
static inline const treelet *loader_peek(const loader *l, uint32_t t) {
    return atomic_load_explicit(&l->resident[t], memory_order_acquire);
}

/* loader_is_ready() - whether it can be looked up. Any thread. */
static inline bool loader_is_ready(const loader *l, uint32_t t) {
    return atomic_load_explicit(&l->resident[t], memory_order_acquire) != NULL;
}

/* loader_sweep() - want every treelet of interest, coarse levels first, behind everything
 * that rays want. loader_sweep_level() - but none of a level finer than this one. */
void loader_sweep_level(loader *l, uint32_t level);
static inline void loader_sweep(loader *l) {
    loader_sweep_level(l, 0);
}

/* loader_rest() - nothing is wanted any more; returns when what was being read is there. */
void loader_rest(loader *l);

typedef struct loader_request {
    uint32_t t;
    uint64_t priority;
} loader_request;

/* loader_want() - bring them in when slots are free; smaller priority first. A load for each, and
 * no lock, when all were asked for before. Any thread. */
void loader_want(loader *l, const loader_request *requests, size_t count);

/* loader_admit() - rays wait for these treelets alone, none of which is resident: forget what else
 * rays had queued, make room among the resident ones if need be, and wait until at least one of
 * them is READY. Only while nothing is traced. Sorts the requests. Returns the error of a treelet
 * that failed. */
CHECKED status loader_admit(loader *l, loader_request *requests, size_t count);

/* loader_has_room() - whether there would be a slot for one more treelet when all that is wanted
 * has come. Any thread, no lock. */
bool loader_has_room(const loader *l);

/* loader_listen() - after each read that ended, well or not, one of these sleepers is woken from
 * now on. Before, the treelet is among the arrivals and loader_is_reading() says what is so without
 * this read. The loader's lock is not held meanwhile. NULL: no longer; only while nobody sleeps. */
void loader_listen(loader *l, sleepers *listeners);

/* loader_is_reading() - whether something is being read, or will be without anything being evicted
 * before: what is said to be listened for. Any thread, no lock. */
bool loader_is_reading(const loader *l);

/* loader_settle() - wait until nothing that has a slot is still being read. */
CHECKED status loader_settle(loader *l);

/* loader_failure() - ST_OK, or the error of a treelet whose load failed. Stays until
 * loader_forget_failures(). */
CHECKED status loader_failure(loader *l);

/* loader_forget_failures() - what failed may be tried again: before each picture, so that one's
 * trouble (memory that ran out, a treelet that the next one need not have) is not the next one's.
 * Forgets what was queued, too. Only while nothing is traced. */
void loader_forget_failures(loader *l);

loader_stats loader_statistics(loader *l);
void loader_reset_statistics(loader *l);

#endif
