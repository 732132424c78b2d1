/* mesh_coder.h - the payloads of a mesh's treelet (mesh_leaf.h) as streams that compress well, and
 * back, to the bit. FORMAT.md 6 says the same byte for byte.
 *
 * Topology: a corner is coded by its place in a list of vertices used last, and a vertex's position
 * at its first use, as the difference from another vertex (mesh_corner_coder.h). Boxes of nodes are
 * left out where tets and positions imply them. Values, gradients, positions at a step: each float
 * is coded as the difference from the vertex before; codes as differences from the child before.
 *
 * Any payload can be encoded. One that cannot be made again from its streams (a tree out of order,
 * padding that is not zero, a vertex without a tet) is stored as it is.
 *
 * Stateless: any thread may call these at any time, with buffers of its own. Nothing is allocated.
 * counts: of the treelet, as in section COUNTS, without a mesh_leaf_counts_fault() for
 * LEAF_TREELET_TETS_MAX. bounds: of the treelet at the first step, finite and ordered; used for
 * topologies alone, may be NULL for other blocks.
 */
#ifndef FORMATS_MESH_MESH_CODER_H
#define FORMATS_MESH_MESH_CODER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/leaf/coded_streams.h"

/* The blocks of payloads, in the order of the file. */
typedef enum mesh_block {
    MESH_BLOCK_TOPOLOGY,
    MESH_BLOCK_VALUES,
    MESH_BLOCK_GRADIENTS,
    MESH_BLOCK_POSITIONS
} mesh_block;

/* mesh_coder_bytes() - returns the bytes of a payload, as in mesh_leaf_shape().
 * mesh_coder_room() - returns the most bytes that its streams take together.
 * mesh_coder_scratch() - returns the bytes of scratch that mesh_coder_encode() needs. */
size_t mesh_coder_bytes(mesh_block block, const uint32_t counts[4]);
size_t mesh_coder_room(mesh_block block, const uint32_t counts[4]);
size_t mesh_coder_scratch(mesh_block block, const uint32_t counts[4]);

/* mesh_coder_encode() - encode a payload. It cannot fail.
 *
 * payload  mesh_coder_bytes() bytes, 64-byte aligned; any
 * scratch  mesh_coder_scratch() bytes, 64-byte aligned; overwritten
 * out      bytes, and room for at least mesh_coder_room(), are the caller's; the rest is filled
 *
 * The streams depend on nothing but the other arguments. */
void mesh_coder_encode(mesh_block block, const uint32_t counts[4], const float bounds[6],
                       const void *payload, void *scratch, coded_streams *out);

/* mesh_coder_decode() - decode streams, one behind the other.
 *
 * in       `bytes` bytes, of any alignment and content; nothing is read outside them
 * payload  out: mesh_coder_bytes() bytes, 64-byte aligned, undefined if the result is false;
 *          nothing is written outside them
 *
 * Returns false if the bytes are no payload's streams. If true, the payload is what was encoded,
 * with the same counts and bounds. From bytes that mesh_coder_encode() has not made, it may be any:
 * mesh_leaf_check_loaded() or mesh_leaf_check_moved() must judge it. Takes time in proportion to
 * the payload's bytes, whatever the input. */
bool mesh_coder_decode(mesh_block block, const uint32_t counts[4], const float bounds[6],
                       const uint8_t *in, size_t bytes, void *payload);

#endif
