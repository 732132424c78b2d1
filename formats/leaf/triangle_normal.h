/* triangle_normal.h - the normal at a vertex of a surface as 32 bits, and back.
 *
 * The unit sphere is laid on an octahedron, |x| + |y| + |z| = 1, whose lower half is folded out
 * (Meyer et al. 2010). u and v, the x and y of that, times 32767 and rounded, are the low and the
 * high 16 bits. Decoding is exact but for the length: the same bits on any CPU.
 */
#ifndef FORMATS_LEAF_TRIANGLE_NORMAL_H
#define FORMATS_LEAF_TRIANGLE_NORMAL_H

#include <stdbool.h>
#include <stdint.h>

#define TRIANGLE_NO_NORMAL 0x80008000u

/* triangle_normal_encode() - of any length; TRIANGLE_NO_NORMAL if it has no direction: it is 0 or
 * not finite.
 * triangle_normal_decode() - set the unit vector. Returns false, and leaves it alone, if there is
 * none.
 * triangle_normal_is_code() - whether leafcast writes such a code. */
uint32_t triangle_normal_encode(const double normal[3]);
bool triangle_normal_decode(uint32_t code, double unit[3]);
bool triangle_normal_is_code(uint32_t code);

#endif
