/* octant_order.h - the children of an octree's node, and the cells of a block, front to back.
 *
 * `first` is the nearest octant, given by a ray's direction or the eye's place. Octants come in the
 * order first ^ 0, first ^ 1, ... first ^ 7.
 */
#ifndef RENDER_GRID_OCTANT_ORDER_H
#define RENDER_GRID_OCTANT_ORDER_H

#include <stdint.h>

/* octants_in_order() - sorts a mask of octants: octant o becomes bit o ^ first. */
static inline unsigned octants_in_order(unsigned octants, unsigned first) {
    unsigned m = octants;
    m = first & 1u ? (m & 0x55u) << 1 | (m & 0xaau) >> 1 : m;
    m = first & 2u ? (m & 0x33u) << 2 | (m & 0xccu) >> 2 : m;
    return first & 4u ? (m & 0x0fu) << 4 | (m & 0xf0u) >> 4 : m;
}

/* octants_last() - returns the last bit of a sorted mask, which is not 0. */
static inline unsigned octants_last(unsigned order) {
    return 31u - (unsigned)__builtin_clz(order);
}

/* block_flip() - returns the bits of a Morton number, of two octal digits, that differ between a
 * cell of a block and its place in the order. */
static inline unsigned block_flip(unsigned first) {
    return first | first << 3;
}

/* block_in_order() - sorts the mask of a block's 64 cells, numbered in Morton order: cell n becomes
 * bit n ^ block_flip(first). */
static inline uint64_t block_in_order(uint64_t cells, unsigned first) {
    static const uint64_t low[6] = {0x5555555555555555, 0x3333333333333333, 0x0f0f0f0f0f0f0f0f,
                                    0x00ff00ff00ff00ff, 0x0000ffff0000ffff, 0x00000000ffffffff};
    for (unsigned bit = 0; bit < 6; bit++)
        if (block_flip(first) >> bit & 1u)
            cells = (cells & low[bit]) << (1u << bit) | (cells >> (1u << bit) & low[bit]);
    return cells;
}

#endif
