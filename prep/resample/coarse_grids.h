/* coarse_grids.h - makes the coarse grids in a treelet file (leaf.h, COARSE), of a kind that has
 * resample_cells: its values resampled, with their pyramid. They are drawn before its cells have
 * been read.
 */
#ifndef PREP_RESAMPLE_COARSE_GRIDS_H
#define PREP_RESAMPLE_COARSE_GRIDS_H

#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/progress.h"
#include "formats/base/status.h"
#include "formats/leaf/leaf_writer.h"

typedef struct coarse_grids {
    uint32_t dims; /* nodes along the longest edge; 0: resample_cells.coarse() in all, about */
    leaf_parameters file; /* of the file they are put into */
    uint64_t memory;
    int threads;
} coarse_grids;

/* coarse_grids_embed() - put a grid for each set into w, which must be settled. output: path beside
 * which scratch files may lie. The grids depend on the cells, dims and file alone. */
CHECKED status coarse_grids_embed(mem *m, leaf_writer *w, const char *output, const coarse_grids *o,
                                  const progress *p);

#endif
