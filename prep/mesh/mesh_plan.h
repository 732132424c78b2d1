/* mesh_plan.h - how the conversion of a mesh will go about it: what is held in memory, what goes
 * through scratch files.
 *
 * Made when all points and tets are in. Nothing in a plan has an influence on the file.
 */
#ifndef PREP_MESH_MESH_PLAN_H
#define PREP_MESH_MESH_PLAN_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/leaf/leaf_writer.h"
#include "prep/mesh/mesh_gather.h"
#include "prep/mesh/mesh_gradients.h"
#include "prep/mesh/mesh_runs.h"
#include "prep/mesh/mesh_series.h"

enum {
    MESH_TREELET_TETS = 4096,
    MESH_LEAF_TETS = 12
}; /* tests/measurements/treelets.md says why */

/* What the user asks for. */
typedef struct mesh_options {
    leaf_parameters file; /* cells_log2 and halo do not matter */
    uint32_t treelet_tets, leaf_tets;
    uint64_t memory;           /* budget in bytes */
    int threads;               /* >= 1 */
    bool force;                /* replace an existing output */
    const mesh_series *series; /* a mesh of several steps or fields; NULL: of one */
    bool sah;                  /* trees by the surface area heuristic: mesh_sah.h */
    bool coarse;               /* with a coarse grid of each set, */
    uint32_t coarse_dims;      /* of so many nodes along the longest edge; 0: as suits the mesh */
    bool gradients;            /* the file has one at each vertex */
    bool refuse_empty;         /* without any value that is a number: ST_UNSUPPORTED */
} mesh_options;

typedef struct mesh_plan {
    bool spill_tets, spill_points; /* what must go to scratch files before all else */
    mesh_runs_plan runs;
    uint64_t keys_window;                  /* bytes of each thread's window on spilled points */
    uint64_t points_window, values_window; /* the same, while treelets are built */
    mesh_gradients_plan gradients;         /* while they are summed up */
    uint64_t gradients_window;             /* as the others, on what came of it */
    bool spill_gradients;                  /* that goes to a scratch file, too */
    uint64_t treelets;                     /* a guess, rather too large */
    uint64_t memory;                       /* bytes it will take, what is used already included */
    uint64_t build_memory;                 /* of that, while treelets are built */
    uint64_t memory_least;                 /* the smallest budget that would do */
    uint64_t spill_bytes;                  /* of all scratch files but the writer's */
} mesh_plan;

/* mesh_plan_least() - the smallest budget with which any mesh could be converted; what m has in use
 * is included. */
CHECKED status mesh_plan_least(mem *m, const mesh_options *o, uint64_t *least);

/* mesh_plan_make() - the fastest plan within o->memory, for what g has gathered; m is where the
 * budget is taken from, and lends a little. ST_NOMEM, naming the smallest budget that would do
 * (then also in plan->memory_least), when there is none. */
CHECKED status mesh_plan_make(mem *m, const mesh_gather *g, const mesh_options *o, mesh_plan *plan);

/* mesh_plan_check() - that the plan has room for so many treelets, too; ST_NOMEM as above. */
CHECKED status mesh_plan_check(const mesh_options *o, const mesh_gather *g, const mesh_plan *plan,
                               uint64_t treelets);

/* mesh_plan_refuse() - the ST_NOMEM of all these. */
status mesh_plan_refuse(const mesh_options *o, uint64_t least);

#endif
