/* mesh_coder.h - the payloads of a mesh's treelet (mesh_leaf.h) as streams that compress well, and
 * back, to the bit. FORMAT.md 6 says the same byte for byte.
 *
 * Topology: a corner is coded by its place in a list of vertices used last, and a vertex's position
 * at its first use, as the difference from another vertex (mesh_corner_coder.h). Boxes of nodes are
 * left out where tets and positions imply them. Values, gradients, positions at a step: each float
 * is coded as the difference from the vertex before; codes as differences from the child before.
 *
 * Stored as they are: trees out of order, vertices without a tet. bounds are used for topologies
 * alone, and may be NULL for other blocks. What comes of foreign streams mesh_leaf_check_loaded()
 * or mesh_leaf_check_moved() must judge.
 */
#ifndef FORMATS_MESH_MESH_CODER_H
#define FORMATS_MESH_MESH_CODER_H

#include "formats/leaf/leaf_coder.h"

/* counts: as in section COUNTS, without a mesh_leaf_counts_fault() for LEAF_TREELET_TETS_MAX. */
extern const leaf_coder mesh_coder;

#endif
