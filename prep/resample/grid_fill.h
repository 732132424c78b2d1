/* grid_fill.h - counts how much of what was resampled a regular grid shows: a cell of it has data
 * where all eight corners have. About as many nodes have a value as nodes' volumes fit into what
 * is resampled. So of cells all over the grid nearly as many have data; of thin ones, few or none.
 */
#ifndef PREP_RESAMPLE_GRID_FILL_H
#define PREP_RESAMPLE_GRID_FILL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"

typedef struct grid_fill {
    uint64_t nodes, cells; /* that have data, so far */
    /* Inside: */
    mem *m;
    uint32_t row;     /* nodes */
    size_t plane;     /* nodes */
    size_t at;        /* in the plane, of the node that is next */
    bool before;      /* whether the node before has a value */
    uint8_t *edges;   /* of the last `row` nodes: whether they and the node before have */
    uint8_t *squares; /* of the last `plane` nodes: and those before them in y */
} grid_fill;

/* grid_fill_init() - release it in any case. */
CHECKED status grid_fill_init(grid_fill *f, mem *m, const uint32_t dims[3]);
void grid_fill_release(grid_fill *f);

/* grid_fill_count() - count the next samples, x fastest; NaN: a node has none. */
void grid_fill_count(grid_fill *f, const float *samples, size_t count);

#endif
