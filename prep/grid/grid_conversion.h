/* grid_conversion.h - the state of a volume's conversion: all that it holds, and what of it is
 * saved so that another run can go on (formats/base/work_folder.h).
 */
#ifndef PREP_GRID_GRID_CONVERSION_H
#define PREP_GRID_GRID_CONVERSION_H

#include "formats/base/pool.h"
#include "formats/base/progress.h"
#include "formats/leaf/histogram_draw.h"
#include "formats/leaf/leaf_writer.h"
#include "prep/grid/convert_plan.h"
#include "prep/grid/deviation_build.h"
#include "prep/grid/pyramid.h"
#include "prep/grid/read_ahead.h"
#include "prep/grid/slab.h"
#include "prep/grid/treelet_build.h"

/* Buffers of one thread. */
typedef struct grid_bench {
    grid_codes_scratch *scratch;
    void *payload; /* of a treelet, before it is compressed; NULL: it is not */
    void *shell;   /* what a family shares; NULL: the file has no shells */
    leaf_packer *packer;
    leaf_family *family;
} grid_bench;

/* State of one level. */
typedef struct grid_stage {
    slab *slab;
    pyramid *up;                /* makes the next level's slices; NULL at the last */
    char *coarse;               /* buffer for those slices */
    uint8_t *busy;              /* maps of those slices; NULL: there are none */
    deviation_build *deviation; /* of the next level; NULL: the file has none */
} grid_stage;

typedef struct grid_conversion {
    mem *m;
    const convert_options *o;
    const convert_plan *plan;
    const progress *p;
    leaf_writer *writer;
    const leaf_layout *layout;
    uint32_t set; /* the current one */
    bool resumes; /* the current set has been begun by an earlier run */
    /* Facts of the sets before the current one; of this one, as far as an earlier run knew them. */
    read_ahead_facts seen, past;
    absent_parts absent;
    pool *workers;
    grid_bench *benches; /* one per worker */
    grid_stage stages[LEAF_LEVELS_MAX];
    read_ahead *input;
    const void *quiet; /* value of tiles that maps call not busy; NULL: there are no maps */
    uint32_t slices_done;
    leaf_slabs slabs; /* at the one that is complete next */
    /* For the histogram; cells is NULL if the file has none. */
    histogram_draw draw;
    histogram_space space;
    histogram_cell *cells;
    histogram_marker marker;
} grid_conversion;

/* grid_conversion_share() - of the work on all sets that is done. */
double grid_conversion_share(const grid_conversion *c);

/* grid_conversion_keep_head(), grid_conversion_keep() - save or load (state_io.h), of a
 * grid_conversion: what must be known before anything is set up; that and all else. All slices up
 * to slices_done have gone through all levels; one that loads is set up for the same set, and has
 * done none.
 * grid_conversion_save() - save the state in the work folder, which there must be. */
CHECKED status grid_conversion_keep_head(void *ctx, state_io *io);
CHECKED status grid_conversion_keep(void *ctx, state_io *io);
CHECKED status grid_conversion_save(grid_conversion *c);

#endif
