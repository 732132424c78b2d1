/* convert_plan.h - plans a conversion: levels, sizes, and what is held in memory.
 *
 * All memory of a conversion is counted here beforehand, so that it fails at once or not at all. Of
 * a plan, only the file's parameters influence the file.
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
#include "prep/convert_job.h"
#include "prep/grid/grid_series.h"
#include "prep/grid/slab.h"

/* The user's choices. */
typedef struct convert_options {
    leaf_parameters file;
    uint64_t memory;           /* budget in bytes */
    int threads;               /* >= 1, without the reading thread */
    bool force;                /* replace an existing output */
    bool refuse_empty;         /* ST_UNSUPPORTED if no sample is a number */
    const grid_series *series; /* checked; NULL: a single volume */
    bool grows;                /* steps may be added to the output later */
    leaf_grow *grow;           /* the output, to be added to; or NULL */
    work_folder *work;         /* the output's, to save what is done; NULL: it is not */
    convert_job *job;          /* what is to be done, if there is a work folder */
} convert_options;

typedef struct convert_plan {
    leaf_layout layout;       /* levels only, no arrays: needs no release */
    uint32_t ahead;           /* level-0 slices read ahead */
    uint32_t batch;           /* level-0 slices that go through the levels at once */
    uint32_t spilled_levels;  /* number of finest levels whose slabs go through a scratch file */
    uint32_t column_families; /* families across a spilled column */
    uint64_t memory;          /* bytes of the conversion, with what is in use already */
    uint64_t memory_in_core;  /* smallest budget with which no slab is spilled */
    uint64_t memory_least;    /* smallest budget that would do with this many threads */
    uint64_t spill_bytes;     /* bytes of the slabs' scratch files */
    uint64_t payload_bytes;   /* before compression */
    uint64_t file_bytes;      /* at most; raw codec: exact unless payloads are implied */
} convert_plan;

/* convert_plan_make() - the fastest plan within o->memory. The budget is taken from m, which lends
 * a little. ST_NOMEM: there is no plan; the text and plan->memory_least give the smallest
 * budget. */
CHECKED status convert_plan_make(mem *m, const grid *g, const convert_options *o,
                                 convert_plan *plan);

/* convert_plan_slab() - how the slabs of a level are held. */
slab_plan convert_plan_slab(const convert_plan *plan, uint32_t level, int threads);

/* convert_plan_slices() - most slices of a level that are made at once. */
uint32_t convert_plan_slices(const convert_plan *plan, uint32_t level);

#endif
