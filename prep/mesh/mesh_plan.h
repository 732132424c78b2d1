/* mesh_plan.h - plans the conversion of a mesh: what is held in memory, and what goes through
 * scratch files.
 *
 * It is made when all points and tets are in. A plan has no influence on the file.
 */
#ifndef PREP_MESH_MESH_PLAN_H
#define PREP_MESH_MESH_PLAN_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/leaf/leaf_writer.h"
#include "prep/convert_job.h"
#include "prep/mesh/cell_treelet.h"
#include "prep/mesh/mesh_gather.h"
#include "prep/mesh/mesh_gradients.h"
#include "prep/mesh/mesh_normals.h"
#include "prep/mesh/mesh_runs.h"
#include "prep/mesh/mesh_series.h"

enum {
    MESH_TREELET_TETS = 4096,
    MESH_LEAF_TETS = 12
}; /* reasons: tests/measurements/treelets.md */

/* Where the normals of a surface's vertices come from: the file, if it has any; the triangles
 * around them; or there are none. */
typedef enum surface_normals { NORMALS_FILE, NORMALS_SMOOTH, NORMALS_FLAT } surface_normals;

/* The user's choices. */
typedef struct mesh_options {
    leaf_parameters file; /* cells_log2 and halo are ignored */
    uint32_t treelet_tets, leaf_tets;
    uint64_t memory;            /* budget in bytes */
    int threads;                /* >= 1 */
    bool force;                 /* replace an existing output */
    const mesh_series *series;  /* steps and fields of a mesh; NULL: one of each */
    bool sah;                   /* build trees by the surface area heuristic: mesh_sah.h */
    bool coarse;                /* add a coarse grid for each set, */
    uint32_t coarse_dims;       /* with this many nodes along the longest edge; 0: chosen by the
                                   mesh */
    surface_normals normals;    /* of a surface's vertices: where they come from */
    bool gradients;             /* store the gradient at each vertex */
    const cell_treelets *cells; /* keep cells as they are, in treelets of this kind; NULL: tets.
                                   Without sah and gradients; treelet_tets up to its cells_max */
    bool refuse_empty;          /* ST_UNSUPPORTED if no value is a number */
    bool grows;                 /* steps may be added to the output later */
    leaf_grow *grow;            /* the output, to be added to; or NULL */
    work_folder *work;          /* the output's, to save what is done; NULL: it is not */
    convert_job *job;           /* what is to be done, if there is a work folder */
} mesh_options;

/* mesh_options_take_normals(), .._make_normals() - whether normals of a file are taken, or made. */
static inline bool mesh_options_take_normals(const mesh_options *o) {
    return o->cells && o->cells->corners == 3 && o->normals == NORMALS_FILE;
}
static inline bool mesh_options_make_normals(const mesh_options *o) {
    return o->cells && o->cells->corners == 3 && o->normals == NORMALS_SMOOTH;
}

typedef struct mesh_plan {
    bool spill_tets, spill_points; /* to be moved to scratch files before all else */
    mesh_runs_plan runs;
    uint64_t keys_window;                  /* bytes of each thread's window on spilled points */
    uint64_t points_window, values_window; /* the same, while treelets are built */
    uint64_t cells_window;                 /* likewise, on the cells of a mixed mesh */
    mesh_gradients_plan gradients;         /* while gradients are computed */
    mesh_normals_plan normals;             /* while normals are made */
    uint64_t gradients_window;             /* likewise, on the gradients, or normals */
    bool spill_gradients;                  /* gradients, or normals, go to a scratch file, too */
    uint64_t treelets;                     /* an estimate, rather too large */
    uint64_t memory;                       /* bytes of the conversion, with what is in use
                                              already */
    uint64_t build_memory;                 /* bytes while treelets are built */
    uint64_t memory_least;                 /* the smallest budget that would do */
    uint64_t spill_bytes;                  /* of all scratch files but the writer's */
    int threads;                           /* that it is for */
} mesh_plan;

/* mesh_plan_least() - the smallest budget with which any mesh could be converted, including what m
 * has in use. */
CHECKED status mesh_plan_least(mem *m, const mesh_options *o, uint64_t *least);

/* mesh_plan_make() - the fastest plan within o->memory for what g has gathered. The budget is taken
 * from m, which lends a little. ST_NOMEM: there is no plan; the text and plan->memory_least give
 * the smallest budget. */
CHECKED status mesh_plan_make(mem *m, const mesh_gather *g, const mesh_options *o, mesh_plan *plan);

/* mesh_plan_settle() - the treelets have been counted: set the number, and check that there is room
 * for so many. ST_NOMEM as above. */
CHECKED status mesh_plan_settle(const mesh_options *o, const mesh_gather *g, mesh_plan *plan,
                                uint64_t treelets);

/* mesh_plan_keep() - save it, or load another run's and check that it is within o->memory: ST_NOMEM
 * as above. It does with fewer threads, too. */
CHECKED status mesh_plan_keep(mesh_plan *plan, const mesh_options *o, state_io *io);

/* mesh_plan_refuse() - describe the ST_NOMEM of all these. */
status mesh_plan_refuse(const mesh_options *o, uint64_t least);

#endif
