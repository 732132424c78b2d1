/* octant_order.h - the children of an octree's node front to back: those of a ray's directions, or
 * of the eye's place, come in the order first ^ 0, first ^ 1, ... first ^ 7.
 */
#ifndef RENDER_GRID_OCTANT_ORDER_H
#define RENDER_GRID_OCTANT_ORDER_H

/* octants_in_order() - a mask of octants o in order: o is bit o ^ first. */
static inline unsigned octants_in_order(unsigned octants, unsigned first) {
    unsigned m = octants;
    m = first & 1u ? (m & 0x55u) << 1 | (m & 0xaau) >> 1 : m;
    m = first & 2u ? (m & 0x33u) << 2 | (m & 0xccu) >> 2 : m;
    return first & 4u ? (m & 0x0fu) << 4 | (m & 0xf0u) >> 4 : m;
}

/* octants_last() - the last one of such a mask, which is not 0. */
static inline unsigned octants_last(unsigned order) {
    return 31u - (unsigned)__builtin_clz(order);
}

#endif
