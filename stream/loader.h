/* loader.h - treelets at run time: which are needed, which are resident, and the threads that bring
 * them in.
 *
 * The sweep (M08 4.4.1) over the directory finds the treelets whose ranges meet the interest.
 * Threads (readers.h), which several loaders may share, read wanted treelets, most urgent first.
 * They check a treelet, make its masks of active cells, and publish it in one of at most `capacity`
 * slots. A treelet goes ABSENT -> QUEUED -> LOADING -> READY, or to FAILED. READY treelets stay
 * until loader_admit(), loader_set_capacity(), loader_clear() or another selection removes them,
 * which only happens while no ray is being traced.
 *
 * Another selection costs no more than its sweep. The first thread that looks a READY treelet up
 * makes its new masks. Treelets that do not meet the new interest go to a cache. They keep their
 * data until their slot is needed or they are of interest again. Treelets of a mesh's other fields
 * and time steps go there, too, with their masks (schema trees). In schema refit, a step's vertices
 * are replaced by the next step's, and the tree is refit (mesh_resident.h).
 *
 * Render threads look treelets up with one acquire load of the treelet and one of its masks' state,
 * and may call loader_want(). Functions not marked "any thread" are for the thread that owns the
 * loader.
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

/* How much a preview of isosurfaces reads at most, beside what is there: it shall come soon, and
 * the exact picture that follows it needs other treelets. The next preview goes on. */
enum { LOADER_PREVIEW_BYTES = 8 << 20 };

#define LOADER_MASKING SIZE_MAX /* treelet.masked: a thread is making the masks */

typedef struct loader_stats {
    uint64_t loads, bytes_read;
    uint64_t bytes_read_ever; /* since loader_create(), never reset */
    double load_s;            /* summed over workers */
    uint64_t early;           /* read of expected sets since loader_create(), never reset */
    uint64_t masks;           /* made, for treelets just read and for resident ones */
    uint64_t bytes_resident;  /* now: all treelets, drawn or in the cache */
} loader_stats;

/* Of the treelets of a set that a picture like the last one would need: how many there are, and how
 * many are in memory, drawn or in the cache. */
typedef struct loader_holding {
    uint32_t wanted, resident;
} loader_holding;

typedef struct loader {
    mem *m;
    leaf_file *file;
    /* Per treelet, for the selected interest; read-only while tracing. */
    uint8_t *own;      /* 1: its own samples' range meets it, and it must be read */
    uint8_t *whole;    /* 1: likewise, but it is taken whole (homogeneous.h), not read */
    uint8_t *children; /* bits: octants whose subtree meets it, by the merged ranges */
    _Atomic(treelet *) *resident;
    arrivals arrivals;        /* treelets now READY or FAILED, for listeners to take */
    const treelet_tree *tree; /* of a mesh, whose treelets overlap; else NULL */
    size_t selection;         /* number of the current selection */
    uint64_t bytes_active;
    uint32_t treelets_active;
    struct loader_private *hidden;
} loader;

/* How to read. */
typedef struct loader_options {
    source_kind source;
    mesh_schema schema;   /* for a mesh's steps */
    int workers;          /* reads at a time, at least 1 */
    cpu_isa isa;          /* for active_for() */
    mesh_derived derived; /* made of a mesh's treelets, with their masks */
} loader_options;

/* loader_create() - make a loader with an empty interest and set 0. given: reader threads shared
 * with other loaders, which must outlive this one; from then on there are at least `workers`. NULL:
 * `workers` threads of its own. */
CHECKED status loader_create(mem *m, leaf_file *f, const loader_options *o, readers *given,
                             loader **out);
void loader_destroy(loader *l); /* waits for reads under way; NULL is fine */

/* loader_readers() - returns its reader threads, for another loader that is destroyed earlier. */
readers *loader_readers(const loader *l);

/* loader_select() - select the interest (copied) of the coming frames. Takes one pass over the
 * directory, or none if the interest is the same as before. */
void loader_select(loader *l, const interest *in);

/* loader_select_set() - select the set (field and step) of the coming frames. Takes one pass over
 * the directory, or none if the set is the same as before, and unchanged. */
void loader_select_set(loader *l, uint32_t set);

/* loader_grow() - call it when steps have been added to the file (leaf_file_exchange()), which had
 * so many before. What is resident, selected and expected stays; sets have other numbers. Only
 * while nothing is traced. On failure nothing has changed. */
CHECKED status loader_grow(loader *l, uint32_t steps);

/* loader_restart() - the same of a file between the steps of one that has grown. Nothing may be
 * resident any more (loader_clear()). On failure nothing has changed. */
CHECKED status loader_restart(loader *l);

/* loader_is_behind() - whether the selected set has changed since it was selected
 * (leaf_file.versions): then select it again. */
bool loader_is_behind(const loader *l);

/* loader_follow() - call it after another set was selected. Loads the active treelets that rays
 * touched last, as many as there are slots, and waits for them. Rays mostly see the same treelets
 * in the next step; so they need not wait for each one. Errors are reported by loader_failure().
 * Only while nothing is traced. */
void loader_follow(loader *l, const atomic_uchar touched[]);

/* loader_expect() - say which set is selected next, until it is; TREELET_NO_SET: none is known.
 * Where sets change (leaf_file.versions): only while nothing is traced.
 * loader_is_expecting() - whether one is known.
 * loader_read_expected() - call it when a frame is complete. Reads the treelets of that set that
 * rays touched last, makes their masks, and puts them into the cache, where their selection finds
 * them: in the background, after all that is wanted of the selected set, as far as the cache has
 * room or older treelets that the set does not need. Whatever comes next ends it, but for the reads
 * under way. What fails is not told: it is read again when it is wanted. Counts
 * in the statistics of its set, once that is selected, but for .load_s. */
void loader_expect(loader *l, uint32_t set);
bool loader_is_expecting(const loader *l);
void loader_read_expected(loader *l, const atomic_uchar touched[]);

/* loader_count_sets() - count, of `count` sets from `first` on, the treelets that rays touched last
 * and that meet the interest there, and which of them are in memory, or the same as one that is.
 * Bounded work: of many treelets it takes evenly chosen ones, LOADER_COUNTED_MAX in all sets
 * together; those whose sameness would take longer to find out than as many comparisons count as
 * not in memory. Only while nothing is traced. */
enum { LOADER_COUNTED_MAX = 1 << 20 };
void loader_count_sets(loader *l, uint32_t first, uint32_t count, const atomic_uchar touched[],
                       loader_holding *out);

/* loader_select_gradients() - select whether the coming frames need a mesh's gradients; if so, its
 * file must have them. On a change, resident treelets give their values back. */
void loader_select_gradients(loader *l, bool needed);

/* loader_slot_bytes() - returns the most memory of a resident treelet; the caller turns a budget
 * into slots with it. */
size_t loader_slot_bytes(const loader *l);

/* loader_more_bytes() - returns by how much more than now the loader would take, besides treelets,
 * from a budget of `limit` bytes: its room for shells grows with the budget. */
size_t loader_more_bytes(const loader *l, size_t limit);

/* loader_stored_bytes() - returns the bytes of treelet t in the file, in the selected set. *family:
 * at first LEAF_NO_TREELET; what siblings share counts once if they are asked for one after the
 * other.
 */
uint64_t loader_stored_bytes(const loader *l, uint32_t t, uint32_t *family);

/* loader_set_capacity() - allow `slots` READY treelets (0 counts as 1). The cache may use the
 * slots' memory that READY treelets leave free, and `beside` bytes more. Evicts treelets beyond
 * that. */
void loader_set_capacity(loader *l, uint32_t slots, size_t beside);

/* loader_clear() - evict all treelets, and empty the cache. Only while nothing is traced. */
void loader_clear(loader *l);

/* loader_mask() - make a treelet's masks for the current selection, or wait for the thread that
 * does (2 to 5 us per treelet of 32^3 cells; no lock, no reading). loader_lookup() calls it. */
void loader_mask(const loader *l, treelet *tr);

/* loader_lookup() - returns the treelet, with masks of the selected interest, if it is READY; else
 * NULL. Any thread. Never waits for a read. */
static inline const treelet *loader_lookup(const loader *l, uint32_t t) {
    treelet *tr = atomic_load_explicit(&l->resident[t], memory_order_acquire);
    if (tr && atomic_load_explicit(&tr->masked, memory_order_acquire) != l->selection)
        loader_mask(l, tr);
    return tr;
}

/* loader_prefetch() - prefetch into the CPU's cache what a later loader_lookup() reads. */
static inline void loader_prefetch(const loader *l, uint32_t t) {
    const treelet *tr = atomic_load_explicit(&l->resident[t], memory_order_relaxed);
    if (tr) {
        __builtin_prefetch(&tr->payload);
        __builtin_prefetch(&tr->masked);
    }
}

/* loader_peek() - returns the treelet if it is READY, with masks of any selection; else NULL. */
static inline const treelet *loader_peek(const loader *l, uint32_t t) {
    return atomic_load_explicit(&l->resident[t], memory_order_acquire);
}

/* loader_is_ready() - returns whether treelet t is READY. Any thread. */
static inline bool loader_is_ready(const loader *l, uint32_t t) {
    return atomic_load_explicit(&l->resident[t], memory_order_acquire) != NULL;
}

/* loader_sweep() - want every active treelet, coarse levels first, after all that rays want.
 * loader_sweep_level() - likewise, but only treelets of this level and coarser ones, and only until
 * those that are absent have `bytes` in the file: the next call goes on from there. At least one.
 */
void loader_sweep_level(loader *l, uint32_t level, uint64_t bytes);

/* loader_level_within() - returns the finest level from this one on for which loader_sweep_level()
 * wants all, with so many bytes; the coarsest if there is none. Only while nothing is traced. */
uint32_t loader_level_within(loader *l, uint32_t level, uint64_t bytes);
static inline void loader_sweep(loader *l) {
    loader_sweep_level(l, 0, UINT64_MAX);
}

/* loader_rest() - forget all that is wanted, and wait for the reads under way. */
void loader_rest(loader *l);

typedef struct loader_request {
    uint32_t t;
    uint64_t priority;
} loader_request;

/* loader_want() - queue treelets, to be read when slots are free, smaller priority first. If none
 * is ABSENT, this takes one atomic load per request and no lock. Any thread. */
void loader_want(loader *l, const loader_request *requests, size_t count);

/* loader_admit() - call it when no ray can go on without one of these treelets, none of which is
 * resident. Forgets all other requests, evicts resident treelets if need be, and waits until at
 * least one requested treelet is READY or lost. Only while nothing is traced. Sorts the requests.
 * Returns the error of a treelet that failed. */
CHECKED status loader_admit(loader *l, loader_request *requests, size_t count);

/* loader_has_room() - returns whether a slot stays free once all wanted treelets are READY. Any
 * thread, no lock. */
bool loader_has_room(const loader *l);

/* loader_listen() - from now on, wake one of these sleepers after each read, failed or not. By then
 * the treelet is among the arrivals, and loader_is_reading() does not count this read. The sleeper
 * is woken without the loader's lock. NULL: wake nobody from now on; only while nobody sleeps. */
void loader_listen(loader *l, sleepers *listeners);

/* loader_is_reading() - returns whether a read is under way, or is queued and needs no eviction. If
 * so, loader_listen()'s sleepers will be woken. Any thread, no lock. */
bool loader_is_reading(const loader *l);

/* loader_settle() - wait until all queued treelets that find a free slot have been read. Returns
 * the error of a failed treelet. */
CHECKED status loader_settle(loader *l);

/* loader_failure() - returns ST_OK, or the error of the first treelet that failed since
 * loader_forget_failures(). */
CHECKED status loader_failure(loader *l);

/* loader_forget_failures() - let failed treelets be tried again. Call it before each picture: an
 * error of one picture (no memory, a treelet that the next picture does not need) must not fail the
 * next. Also empties the queue. Only while nothing is traced. */
void loader_forget_failures(loader *l);

/* loader_tolerate() - from now until loader_forget_failures(), treelets that cannot be read, as
 * they are damaged or the disk fails, are *lost* instead of a failure: what asks for one goes on
 * without it, or with the coarser one above. Only while nothing is traced.
 * loader_is_lost() - whether treelet t is. Any thread, no lock.
 * loader_stand_in() - the next treelet above t, and not lost, that meets the interest;
 * LEAF_NO_TREELET: there is none.
 * loader_has_come() - whether a ray that waits for treelet t can go on: it is READY, or lost. */
void loader_tolerate(loader *l);
bool loader_is_lost(const loader *l, uint32_t t);
uint32_t loader_stand_in(const loader *l, uint32_t t);
static inline bool loader_has_come(const loader *l, uint32_t t) {
    return loader_is_ready(l, t) || loader_is_lost(l, t);
}

/* loader_lost() - how many treelets are lost, and why the first one is, until
 * loader_forget_failures(). Only while nothing is traced. */
uint32_t loader_lost(loader *l, const char **why);

loader_stats loader_statistics(loader *l);
void loader_reset_statistics(loader *l);

#endif
