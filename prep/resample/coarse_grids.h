/* coarse_grids.h - makes the coarse grids in a treelet file (leaf.h, COARSE), of a kind that has
 * resample_cells: its values resampled, with their pyramid. They are drawn before its cells have
 * been read.
 */
#ifndef PREP_RESAMPLE_COARSE_GRIDS_H
#define PREP_RESAMPLE_COARSE_GRIDS_H

#include <stdint.h>

#include "prep/resample/coarse_parts.h"

typedef struct coarse_grids {
    uint32_t dims; /* nodes along the longest edge; 0: resample_cells.coarse() in all, about */
    leaf_parameters file; /* of the file they are put into */
    uint64_t memory;
    int threads;
} coarse_grids;

/* How much a grid shows (grid_fill.h). */
typedef struct coarse_grids_fill {
    uint64_t nodes, cells; /* that have data */
} coarse_grids_fill;

/* coarse_grids_make() - write the grid of a set of f to `path`, and nothing else that stays. It
 * depends on the cells, dims and file alone. ST_UNSUPPORTED if it is far larger than what it stands
 * for. */
CHECKED status coarse_grids_make(const coarse_grids *o, mem *m, leaf_file *f, uint32_t set,
                                 const char *path, const progress *p, coarse_grids_fill *fill);

/* coarse_grids_maker() - one that makes grids so; o: by reference. */
coarse_maker coarse_grids_maker(coarse_grids *o);

#endif
