/* mesh_conversion.h - the state of a mesh's conversion: all that it holds, made in the order of its
 * stages, and saved so that another run can go on with it (formats/base/work_folder.h).
 *
 * What is saved: the numbers of this state, points, values and tets, sorted runs, gradients, and
 * the payloads that were put. It is saved after a step was read, after a run was sorted, after all
 * were, after a band of gradients, and after a batch of treelets. A mesh that fits into memory, of
 * one step, is not saved: its conversion begins again.
 */
#ifndef PREP_MESH_MESH_CONVERSION_H
#define PREP_MESH_MESH_CONVERSION_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/pool.h"
#include "formats/base/progress.h"
#include "prep/mesh/mesh_batches.h"
#include "prep/mesh/mesh_build.h"
#include "prep/mesh/mesh_gather.h"
#include "prep/mesh/mesh_keys.h"
#include "prep/mesh/mesh_plan.h"

/* What is being done. Work can be saved within each. */
typedef enum mesh_stage { MESH_READING, MESH_SORTING, MESH_SORTED, MESH_BUILDING } mesh_stage;

typedef struct mesh_conversion {
    mem *m;
    const char *name;   /* of the data set */
    const char *output; /* beside which scratch files may lie */
    mesh_options o;     /* threads: those of the plan, if that is another run's */
    const progress *p;
    mesh_report *report; /* from the reader */
    mesh_gather *g;
    uint32_t stage; /* a mesh_stage */
    double share;   /* of the job that is done */
    mesh_plan plan;
    pool *workers;
    mesh_runs *runs;
    mesh_keys *keys; /* only while sorting */
    mesh_keys_report sorted;
    uint32_t counted; /* the plan's treelets are exact */
    mesh_spool gradients;
    uint64_t bands; /* of gradients that are done, of all sets */
    leaf_writer *writer;
    mesh_batches batches;
    mesh_build *build;
    uint32_t first_step, end_step; /* range of steps being built */
    bool resumed;                  /* an earlier run began it, */
    bool goes_on;                  /* and was in the middle of this pass over the tets */
    bool dropped;                  /* the file of tets is removed, as runs hold them */
    bool unsaved;                  /* nothing is saved any more: the disk had no room */
} mesh_conversion;

/* mesh_conversion_of() - a new one. o is copied, all else kept by reference.
 * mesh_conversion_release() - free all but the writer, and the gathered data. */
mesh_conversion mesh_conversion_of(mem *m, mesh_gather *g, const char *name, const char *output,
                                   const mesh_options *o, const progress *p, mesh_report *report);
void mesh_conversion_release(mesh_conversion *c);

/* mesh_conversion_begin_runs(), .._keys() - make what sorts, when the plan is made.
 * mesh_conversion_begin_batches() - when all is sorted. mesh_conversion_begin_writer() - make the
 * writer and what builds, when treelets are counted and gradients are there. */
CHECKED status mesh_conversion_begin_runs(mesh_conversion *c);
CHECKED status mesh_conversion_begin_keys(mesh_conversion *c);
CHECKED status mesh_conversion_begin_batches(mesh_conversion *c);
CHECKED status mesh_conversion_begin_writer(mesh_conversion *c);

/* mesh_conversion_share() - a guess at its share of the whole job; coarse grids take the rest.
 * mesh_conversion_tell() - report progress: `part` of the way between two shares of that. */
double mesh_conversion_share(const mesh_options *o);
CHECKED status mesh_conversion_tell(mesh_conversion *c, const char *stage, double from, double to,
                                    double part);

/* mesh_conversion_save() - save all if that is due and worth it.
 * mesh_conversion_resume() - go on where an earlier run ended, if one did: sets the stage, and
 * makes all that belongs to it. ST_NOMEM: that run's plan needs more memory than there is. */
CHECKED status mesh_conversion_save(mesh_conversion *c);
CHECKED status mesh_conversion_resume(mesh_conversion *c);

#endif
