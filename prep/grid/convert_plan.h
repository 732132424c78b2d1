/* convert_plan.h - how a conversion will go about it: levels, sizes, and what is held in memory.
 *
 * Everything a conversion allocates is counted here beforehand, so that it fails at once or not at
 * all. Nothing in a plan but the file's parameters has an influence on the file.
 */
#ifndef PREP_GRID_CONVERT_PLAN_H
#define PREP_GRID_CONVERT_PLAN_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/grid/grid.h"
#include "formats/leaf/leaf_layout.h"
#include "formats/leaf/leaf_writer.h"
#include "prep/grid/grid_series.h"
#include "prep/grid/slab.h"

/* What the user asks for. */
typedef struct convert_options {
    leaf_parameters file;
    uint64_t memory;           /* budget in bytes */
    int threads;               /* >= 1, beside the one that reads */
    bool force;                /* replace an existing output */
    bool refuse_empty;         /* without any sample that is a number: ST_UNSUPPORTED */
    const grid_series *series; /* checked; NULL: the volume alone */
} convert_options;

typedef struct convert_plan {
    leaf_layout layout;       /* levels alone, no arrays: nothing to release */
    uint32_t batch;           /* level-0 slices read at once */
    uint32_t spilled_levels;  /* the finest ones, whose slabs go through a scratch file */
    uint32_t column_families; /* width of a spilled column */
    uint64_t memory;          /* bytes it will take, what is used already included */
    uint64_t memory_in_core;  /* the smallest budget under which no slab is spilled */
    uint64_t memory_least;    /* the smallest budget that would do, with these threads */
    uint64_t spill_bytes;     /* size of the scratch files of slabs */
    uint64_t payload_bytes;   /* before compression */
    uint64_t file_bytes;      /* at most; raw codec: exactly, but for payloads that are implied */
} convert_plan;

/* convert_plan_make() - the fastest plan within o->memory; m is where the budget is taken from, and
 * lends a little. ST_NOMEM, naming the smallest budget that would do (then also in
 * plan->memory_least), when there is none. */
CHECKED status convert_plan_make(mem *m, const grid *g, const convert_options *o,
                                 convert_plan *plan);

/* convert_plan_slab() - how level's slabs are held. */
slab_plan convert_plan_slab(const convert_plan *plan, uint32_t level, int threads);

/* convert_plan_slices() - most slices of a level that come at once. */
uint32_t convert_plan_slices(const convert_plan *plan, uint32_t level);

#endif
