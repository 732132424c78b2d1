/* coarse_grids.h - makes the coarse grids in a treelet file (leaf.h, COARSE), of a kind that has
 * resample_cells: its values resampled, with their pyramid. They are drawn before its cells have
 * been read.
 */
#ifndef PREP_RESAMPLE_COARSE_GRIDS_H
#define PREP_RESAMPLE_COARSE_GRIDS_H

#include <stdbool.h>
#include <stdint.h>

#include "prep/resample/coarse_parts.h"

typedef struct coarse_grids {
    uint32_t dims; /* nodes along the longest edge; 0: resample_cells.coarse() in all, about */
    leaf_parameters file; /* of the file they are put into */
    uint64_t memory;
    int threads;
    const char *output; /* named in messages */
    bool inside; /* one inside another coarse grid, of hexahedra: with about 8 nodes for each, but
                    at most 2^20; left out if it shows less than 7/8 of them (grid_cover.h) */
} coarse_grids;

/* coarse_grids_maker() - make grids so; by reference. They depend on the cells, dims and file
 * alone. ST_UNSUPPORTED if one is far larger than what it stands for. */
coarse_maker coarse_grids_maker(const coarse_grids *o);

#endif
