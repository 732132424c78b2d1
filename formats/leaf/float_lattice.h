/* float_lattice.h - floats at the nodes of a lattice, each predicted by its seven neighbours
 * before, as planes of bytes (float_planes.h); lossless for any bits.
 *
 * The prediction is the Lorenzo predictor (Ibarria, Lindstrom, Rossignac, Szymczak 2003): the value
 * that makes the cell's trilinear interpolant one without its product of three. With the node's
 * neighbours before on some axes, i, j, .., ijk, it is
 *
 *   i + ((j - ij) + ((k - ik) - (jk - ijk)))
 *
 * in floats, rounded to nearest at each step. A neighbour outside is +0. A NaN predicts +0.
 */
#ifndef FORMATS_LEAF_FLOAT_LATTICE_H
#define FORMATS_LEAF_FLOAT_LATTICE_H

#include <stddef.h>
#include <stdint.h>

enum { FLOAT_LATTICE_ROW = 64 }; /* most nodes on the first axis */

/* float_lattice_encode() - nodes: along i, j, k; i fastest. planes: out, FLOAT_PLANES planes,
 * `stride` bytes from one to the next. float_lattice_decode() - the same floats again. */
void float_lattice_encode(const float *floats, const uint32_t nodes[3], size_t stride,
                          uint8_t *planes);
void float_lattice_decode(const uint8_t *planes, const uint32_t nodes[3], size_t stride,
                          float *floats);

/* float_lattice_predict() - what three, or seven, neighbours predict. */
static inline float float_lattice_predict2(float i, float j, float ij) {
    return i + (j - ij);
}
static inline float float_lattice_predict3(float i, float j, float k, float ij, float ik, float jk,
                                           float ijk) {
    return i + ((j - ij) + ((k - ik) - (jk - ijk)));
}

#endif
