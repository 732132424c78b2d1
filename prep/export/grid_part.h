/* grid_part.h - a box of the nodes of one level of a treelet file's grid.
 */
#ifndef PREP_EXPORT_GRID_PART_H
#define PREP_EXPORT_GRID_PART_H

#include <stdint.h>

#include "formats/grid/grid.h"
#include "formats/leaf/leaf_file.h"

typedef struct grid_part {
    uint32_t set; /* set of values; the caller chooses */
    uint32_t level;
    uint32_t lo[3], end[3]; /* first node along each axis, and the node behind the last */
} grid_part;

/* grid_part_of() - all nodes of a level, or the nodes box[0..2] to box[3..5], both included; box
 * may be NULL. Its set is the first. ST_USAGE: there is no such level, or no such nodes. */
CHECKED status grid_part_of(const leaf_file *f, uint32_t level, const uint32_t box[6],
                            grid_part *part);

/* grid_part_at() - returns the position of a level's node along an axis of grid space. Nodes of a
 * coarse level may lie beyond the last node of level 0. The spacing of its last two nodes goes on
 * there. */
double grid_part_at(const leaf_file *f, uint32_t level, int axis, uint32_t node);

/* grid_part_describe() - describe the part as a grid of its own: sizes (1 is possible), stored
 * type, name, axes, map to the world. Release g in any case. */
CHECKED status grid_part_describe(mem *m, const leaf_file *f, const grid_part *part, grid *g);

#endif
