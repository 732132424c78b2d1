/* mixed_walk.h - a ray, or a point, in one treelet of a mixed mesh (stream/mixed_blocks.h).
 *
 * Blocks come from the tree over them, in the order of tree_passage.h. In a block, active cells
 * that lie beside the ray are passed over by the signs that their faces decide by, so no crossing
 * is lost; of the others, the exact cell decides (render/curved/).
 */
#ifndef RENDER_MIXED_MIXED_WALK_H
#define RENDER_MIXED_MIXED_WALK_H

#include "render/curved/hex_walk.h"
#include "render/walk/tree_passage.h"
#include "stream/mixed_blocks.h"

/* A ray's cells in a treelet: the first member is what hex_walk.h takes. */
typedef struct mixed_way {
    hex_way way;
    const mixed_blocks *blocks;
    tree_passages passages;
    tree_passage at;
    uint32_t ahead; /* cells of the block that are yet to come: bits */
} mixed_way;

/* mixed_way_begin() - the way of a ray; blocks that it leaves before `after` are left out. b, r and
 * counters are kept by reference. */
void mixed_way_begin(mixed_way *w, const mixed_blocks *b, const ray *r, const hit *after,
                     ray_counters *counters);

/* mixed_walk_point() - kind.cell_in: find the cell that holds a point. Set *out to it; if none
 * does, *out stays unchanged. Returns whether one does. Of active cells and others. */
bool mixed_walk_point(const mixed_blocks *b, const double point[3], leafcast_sample *out);

/* mixed_walk_cell() - a cell of the treelet, by its number there. */
curved_cell mixed_walk_cell(const mixed_blocks *b, uint32_t index);

#endif
