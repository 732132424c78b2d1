/* hex_block_sides.h - from the sides of a block's nodes to its cells: for hex_block.c and its
 * versions with vectors.
 */
#ifndef RENDER_CURVED_HEX_BLOCK_SIDES_H
#define RENDER_CURVED_HEX_BLOCK_SIDES_H

#include "render/curved/hex_block.h"

/* Of a slab of nodes: the bit of node (i, j) is i + 8 j. */
typedef struct hex_block_sides {
    uint64_t above; /* second coordinate at or above 0 */
    uint64_t right; /* first one above 0 */
    uint64_t left;  /* first one below 0 */
} hex_block_sides;

/* Of the four corners of a cell in one slab, at the place of the first: */
static inline uint64_t hex_block_all(uint64_t nodes) {
    const uint64_t pairs = nodes & nodes >> 1;
    return pairs & pairs >> 8;
}
static inline uint64_t hex_block_any(uint64_t nodes) {
    const uint64_t pairs = nodes | nodes >> 1;
    return pairs | pairs >> 8;
}

/* hex_block_between() - the cells between two slabs that are not beside the ray: of cell (i, j),
 * bit i + 4 j. */
static inline uint64_t hex_block_between(const hex_block_sides *a, const hex_block_sides *b,
                                         const uint32_t cells[3]) {
    const uint64_t on_both = (hex_block_any(a->above) | hex_block_any(b->above)) &
                             ~(hex_block_all(a->above) & hex_block_all(b->above));
    const uint64_t beside = (hex_block_all(a->right) & hex_block_all(b->right)) |
                            (hex_block_all(a->left) & hex_block_all(b->left));
    const uint64_t meet = on_both & ~beside, row = (UINT64_C(1) << cells[0]) - 1;
    uint64_t out = 0;
    for (uint32_t j = 0; j < cells[1]; j++)
        out |= (meet >> 8 * j & row) << HEX_BLOCK * j;
    return out;
}

#endif
