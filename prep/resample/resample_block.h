/* resample_block.h - some rows of a regular grid's nodes, and drawing tets into them.
 *
 * Row r of a grid holds the nodes (0 .. dims[0] - 1, r mod dims[1], r / dims[1]). Rows follow one
 * another as in a file.
 */
#ifndef PREP_RESAMPLE_RESAMPLE_BLOCK_H
#define PREP_RESAMPLE_RESAMPLE_BLOCK_H

#include <stdint.h>

#include "formats/grid/grid.h"
#include "formats/mesh/mesh_leaf.h"

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

/* resample_block_clear() - start anew, without any tet. */
void resample_block_clear(const resample_block *b);

/* resample_block_draw() - draw a treelet's tets: its checked payloads, and its vertices' positions.
 * A tet gives its value to nodes that it holds and no earlier tet held. Only rows [first_row,
 * first_row + rows) are touched, which must be in the block. So threads may share a block. */
void resample_block_draw(const resample_block *b, uint64_t first_row, uint64_t rows,
                         const mesh_shape *s, const void *topology, const float (*positions)[3],
                         const void *values);

/* resample_block_finish() - set nodes that no tet held to NaN, and make every NaN the same. Returns
 * the number of nodes that a tet held. */
uint64_t resample_block_finish(const resample_block *b);

#endif
