/* grid_cover.h - how many hexahedra a regular grid shows that they were resampled on. Of thin ones,
 * at walls and in shells, few nodes have a value, and still fewer cells of it have eight.
 */
#ifndef PREP_RESAMPLE_GRID_COVER_H
#define PREP_RESAMPLE_GRID_COVER_H

#include <stddef.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/leaf/leaf_file.h"
#include "prep/resample/resample_block.h"

typedef struct grid_cover {
    const resample_grid *grid;
    /* Inside: */
    mem *m;
    uint8_t *node; /* whether it has a value */
    size_t taken;
} grid_cover;

/* grid_cover_init() - g: by reference. Release it in any case. */
CHECKED status grid_cover_init(grid_cover *c, mem *m, const resample_grid *g);
void grid_cover_release(grid_cover *c);

/* grid_cover_take() - the next samples, x fastest; NaN: the node has none. */
void grid_cover_take(grid_cover *c, const float *samples, size_t count);

/* grid_cover_count() - of the hexahedra of a set of f that have a value at each corner (*cells),
 * those whose middle lies in a cell of the grid that has, too (*covered). All samples have been
 * taken. */
CHECKED status grid_cover_count(const grid_cover *c, leaf_file *f, uint32_t set, uint64_t *cells,
                                uint64_t *covered);

#endif
