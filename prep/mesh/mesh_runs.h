/* mesh_runs.h - sorts tets within a fixed amount of memory.
 *
 * Tets that fit into one run are sorted in memory and never written. Otherwise sorted runs go to a
 * scratch file, and are merged while they are read. Merging is stable, so the order is the same.
 */
#ifndef PREP_MESH_MESH_RUNS_H
#define PREP_MESH_MESH_RUNS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/work_folder.h"
#include "prep/mesh/mesh_sort.h"

typedef struct mesh_runs mesh_runs;

/* Sizes of what is held. */
typedef struct mesh_runs_plan {
    uint64_t run;    /* records per run; two arrays of them while a run is sorted */
    uint64_t block;  /* records of each run in memory during the merge; 0: there is one run */
    uint64_t window; /* most visible records during the merge */
} mesh_runs_plan;

/* mesh_runs_plan_make() - plan for `records` records of which `in_sight` must be visible at a time.
 * It is the best plan of at most `making` bytes while runs are made, and `merging` bytes
 * afterwards; else the smallest one. */
mesh_runs_plan mesh_runs_plan_make(uint64_t records, uint64_t in_sight, uint64_t making,
                                   uint64_t merging);

/* Bytes that a plan takes, without mesh_sort_memory(). mesh_runs_filling() - until mesh_runs_end().
 * mesh_runs_sorting() - most bytes within mesh_runs_end(). mesh_runs_merging() - after it. */
uint64_t mesh_runs_filling(const mesh_runs_plan *plan);
uint64_t mesh_runs_sorting(const mesh_runs_plan *plan);
uint64_t mesh_runs_merging(const mesh_runs_plan *plan, uint64_t records);

/* mesh_runs_spill() - size of the scratch file; 0: none. */
uint64_t mesh_runs_spill(const mesh_runs_plan *plan, uint64_t records);

/* mesh_runs_create() - plan: for at least as many records as will come. p must outlive it. beside:
 * path beside which the scratch file may lie; kept by reference. */
CHECKED status mesh_runs_create(mem *m, pool *p, const char *beside, const mesh_runs_plan *plan,
                                mesh_runs **out);
void mesh_runs_destroy(mesh_runs *r); /* NULL is fine */

/* mesh_runs_stop_by() - ask p now and then whether to go on; kept by reference. */
void mesh_runs_stop_by(mesh_runs *r, const progress *p);

/* mesh_runs_room() - where to put the next records, and how many at most. mesh_runs_put() - `count`
 * of them have been put there. */
mesh_record *mesh_runs_room(mesh_runs *r, size_t *count);
CHECKED status mesh_runs_put(mesh_runs *r, size_t count);

/* mesh_runs_end() - call it when all records have been put. */
CHECKED status mesh_runs_end(mesh_runs *r);

/* mesh_runs_window() - move the window forward: drop its first `used` records, and append more.
 * *last: the window holds all that are left. Valid until the next call. */
CHECKED status mesh_runs_window(mesh_runs *r, size_t used, const mesh_record **records,
                                size_t *count, bool *last);

/* mesh_runs_rewind() - move the window back to the first record.
 * mesh_runs_left() - the records from the window's first on; before mesh_runs_end(), those that
 * were put. */
CHECKED status mesh_runs_rewind(mesh_runs *r);
uint64_t mesh_runs_left(const mesh_runs *r);

/* Another run can go on with records whose file is in a work folder: call mesh_runs_keep_in() when
 * no record has been put.
 * mesh_runs_written() - whether all records that were put are in the file, or mesh_runs_end() was
 * called: only then, a state can be saved.
 * mesh_runs_store() - write records that are in memory alone to the file, before a state is saved.
 * mesh_runs_unstore() - empty the file again, which no state needs, if all is in memory.
 * mesh_runs_file() - that file, for work_folder_save().
 * mesh_runs_keep() - save what was put, or load it instead of putting it, with the window at the
 * first record. mesh_runs_keep_place() - save or load the place of the window, without its first
 * `used` records. ST_CORRUPT: what loads is not of such a plan, or the file is too short. */
void mesh_runs_keep_in(mesh_runs *r, work_folder *work);
bool mesh_runs_written(const mesh_runs *r);
CHECKED status mesh_runs_store(mesh_runs *r);
void mesh_runs_unstore(mesh_runs *r);
out_file *mesh_runs_file(const mesh_runs *r);
CHECKED status mesh_runs_keep(mesh_runs *r, state_io *io);
CHECKED status mesh_runs_keep_place(mesh_runs *r, size_t used, state_io *io);

#endif
