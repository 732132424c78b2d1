/* resample_block.h - some rows of a regular grid's nodes, and which of them a cell has held.
 *
 * Row r of a grid holds the nodes (0 .. dims[0] - 1, r mod dims[1], r / dims[1]). Rows follow one
 * another as in a file.
 */
#ifndef PREP_RESAMPLE_RESAMPLE_BLOCK_H
#define PREP_RESAMPLE_RESAMPLE_BLOCK_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/grid/grid.h"

/* A regular grid. Node i lies at origin + i * spacing, rounded to double twice. */
typedef struct resample_grid {
    uint32_t dims[3];             /* 2 .. GRID_DIM_MAX */
    double origin[3], spacing[3]; /* spacing > 0 */
} resample_grid;

static inline double resample_grid_node(const resample_grid *g, int axis, uint32_t i) {
    const double steps = i * g->spacing[axis];
    return g->origin[axis] + steps;
}

/* resample_grid_nodes() - the nodes [*first, *end) of an axis that lie in [lo, hi]; both are equal
 * if there are none. */
void resample_grid_nodes(const resample_grid *g, int axis, double lo, double hi, uint32_t *first,
                         uint32_t *end);

typedef struct resample_block {
    const resample_grid *grid;
    uint64_t first_row, rows;
    float *samples; /* [rows][dims[0]] */
} resample_block;

/* resample_block_clear() - start anew, without any cell. */
void resample_block_clear(const resample_block *b);

/* resample_block_is_empty() - whether no cell has held a node. resample_block_give() - one does,
 * with this value. */
bool resample_block_is_empty(const float *sample);
void resample_block_give(float *sample, float value);

/* resample_block_finish() - set nodes that no cell held to NaN, and make every NaN the same.
 * Returns the number of nodes that a cell held. */
uint64_t resample_block_finish(const resample_block *b);

#endif
