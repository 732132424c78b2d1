/* grid_box.h - a box of samples of a treelet file's grid, assembled from treelets' payloads.
 *
 * Each node belongs to one treelet. The last node of a treelet is the first node of the next one,
 * if there is one.
 */
#ifndef PREP_EXPORT_GRID_BOX_H
#define PREP_EXPORT_GRID_BOX_H

#include "prep/export/grid_part.h"

typedef struct grid_box {
    uint32_t level;
    uint32_t lo[3], end[3]; /* first node along each axis, and the node behind the last */
    char *samples;          /* of the file's stored type, x fastest */
} grid_box;

/* grid_box_of() - the box of a whole part; samples is NULL. */
grid_box grid_box_of(const grid_part *part);

/* grid_box_treelet() - the treelet along an axis that a node belongs to. grid_box_end() - the node
 * behind the last one that belongs to a treelet. */
uint32_t grid_box_treelet(const leaf_layout *l, uint32_t level, int axis, uint32_t node);
uint32_t grid_box_end(const leaf_layout *l, uint32_t level, int axis, uint32_t treelet);

/* grid_box_treelets() - the treelets that the box's nodes belong to: the first, and how many per
 * axis. */
void grid_box_treelets(const grid_box *b, const leaf_layout *l, uint32_t first[3],
                       uint32_t count[3]);

/* grid_box_copy() - copy a treelet's own nodes from its payload, as far as they are in the box.
 * place: of the treelet in its level. Threads may copy different treelets at once. */
void grid_box_copy(const grid_box *b, const leaf_layout *l, const uint32_t place[3],
                   const char *payload);

#endif
