/* mesh_runs.h - tets in, sorted tets out, within a fixed amount of memory.
 *
 * What fits into one run is sorted in memory and never written. Otherwise sorted runs go to a
 * scratch file, and are merged as they are asked for: the same order, for runs are merged stably.
 */
#ifndef PREP_MESH_MESH_RUNS_H
#define PREP_MESH_MESH_RUNS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "prep/mesh/mesh_sort.h"

typedef struct mesh_runs mesh_runs;

/* How much of everything is held. */
typedef struct mesh_runs_plan {
    uint64_t run;    /* records of a run; two such arrays while one is sorted */
    uint64_t block;  /* records of each run in memory during the merge; 0: one run */
    uint64_t window; /* records in sight during the merge, at most */
} mesh_runs_plan;

/* mesh_runs_plan_make() - for `records` records of which `in_sight` must be: the best plan that
 * takes at most `making` bytes while runs are made and `merging` from then on; else the one that
 * needs least. */
mesh_runs_plan mesh_runs_plan_make(uint64_t records, uint64_t in_sight, uint64_t making,
                                   uint64_t merging);

/* Bytes that a plan takes, but for mesh_sort_memory(): mesh_runs_filling() - until mesh_runs_end();
 * mesh_runs_sorting() - in there, at most; mesh_runs_merging() - behind it. */
uint64_t mesh_runs_filling(const mesh_runs_plan *plan);
uint64_t mesh_runs_sorting(const mesh_runs_plan *plan);
uint64_t mesh_runs_merging(const mesh_runs_plan *plan, uint64_t records);

/* mesh_runs_spill() - size of the scratch file; 0: none. */
uint64_t mesh_runs_spill(const mesh_runs_plan *plan, uint64_t records);

/* mesh_runs_create() - plan: of at least as many records as will come. p must outlive it; beside:
 * the path beside which the scratch file may be, kept by reference. */
CHECKED status mesh_runs_create(mem *m, pool *p, const char *beside, const mesh_runs_plan *plan,
                                mesh_runs **out);
void mesh_runs_destroy(mesh_runs *r); /* NULL is fine */

/* mesh_runs_room(), mesh_runs_put() - where the next records go, and how many may be put there;
 * then, that `count` of them are there. */
mesh_record *mesh_runs_room(mesh_runs *r, size_t *count);
CHECKED status mesh_runs_put(mesh_runs *r, size_t count);

/* mesh_runs_end() - all are there. */
CHECKED status mesh_runs_end(mesh_runs *r);

/* mesh_runs_window() - the records that are next: those in sight before, without the first `used`
 * of them, and more. *last: these are all that are left. Valid until the next call. */
CHECKED status mesh_runs_window(mesh_runs *r, size_t used, const mesh_record **records,
                                size_t *count, bool *last);

/* mesh_runs_rewind() - the window begins with the first record again. */
CHECKED status mesh_runs_rewind(mesh_runs *r);

#endif
