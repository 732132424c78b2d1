/* float_planes.h - floats as differences from predictions, cut into planes of bytes; lossless for
 * any bits, NaN and -0 too.
 *
 * A float's bits become an unsigned number that ascends with the float. The difference of two such
 * numbers is small if the floats are close, and is one more for each float between them. It is
 * folded (0, -1, 1, -2, .. become 0, 1, 2, 3, ..), so that the upper bytes of small ones are 0.
 * Plane b holds byte b of all differences, the lowest byte first.
 */
#ifndef FORMATS_LEAF_FLOAT_PLANES_H
#define FORMATS_LEAF_FLOAT_PLANES_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

enum { FLOAT_PLANES = 4 };

/* float_planes_rank() - returns the number of a float's bits that ascends with the float.
 * float_planes_unrank() - returns the bits of a number. */
static inline uint32_t float_planes_rank(uint32_t bits) {
    return bits ^ (UINT32_C(0x80000000) | (0 - (bits >> 31)));
}
static inline uint32_t float_planes_unrank(uint32_t rank) {
    return rank ^ (UINT32_C(0x80000000) | ((rank >> 31) - 1));
}

/* float_planes_fold() - returns a difference (modulo 2^32) with its sign in bit 0.
 * float_planes_unfold() - returns the difference. */
static inline uint32_t float_planes_fold(uint32_t difference) {
    return (difference << 1) ^ (0 - (difference >> 31));
}
static inline uint32_t float_planes_unfold(uint32_t folded) {
    return (folded >> 1) ^ (0 - (folded & 1));
}

/* float_planes_predicted() - returns the bits of a prediction; of a NaN, which differ from CPU to
 * CPU, those of +0. */
static inline uint32_t float_planes_predicted(float p) {
    uint32_t bits = 0;
    if (p == p)
        memcpy(&bits, &p, sizeof bits);
    return bits;
}

/* float_planes_put() - put a float into each of the planes, which are `stride` bytes apart.
 * predicted: bits of what the float may be close to.
 * float_planes_get() - returns the bits again. */
static inline void float_planes_put(uint8_t *plane, size_t stride, uint32_t bits,
                                    uint32_t predicted) {
    const uint32_t folded =
        float_planes_fold(float_planes_rank(bits) - float_planes_rank(predicted));
    for (int b = 0; b < FLOAT_PLANES; b++)
        plane[(size_t)b * stride] = (uint8_t)(folded >> 8 * b);
}
static inline uint32_t float_planes_get(const uint8_t *plane, size_t stride, uint32_t predicted) {
    uint32_t folded = 0;
    for (int b = 0; b < FLOAT_PLANES; b++)
        folded |= (uint32_t)plane[(size_t)b * stride] << 8 * b;
    return float_planes_unrank(float_planes_rank(predicted) + float_planes_unfold(folded));
}

/* float_planes_encode() - encode `count` tuples of `axes` floats, each predicted by the one before
 * on its axis, the first one by +0. planes: out, FLOAT_PLANES planes of axes * count bytes, each
 * axis after axis.
 * float_planes_decode() - the same floats again. floats: of any alignment. */
void float_planes_encode(const void *floats, size_t count, size_t axes, uint8_t *planes);
void float_planes_decode(const uint8_t *planes, size_t count, size_t axes, void *floats);

#endif
