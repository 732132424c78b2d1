/* mesh_leaf_check.h - whether the payloads of a mesh's treelet are sound.
 *
 * Two depths: what makes a topology safe to traverse, cheap enough for every load, and everything
 * that can be recomputed, for `verify`. Against any bytes, not only against accidents.
 */
#ifndef FORMATS_MESH_LEAF_CHECK_H
#define FORMATS_MESH_LEAF_CHECK_H

#include <stddef.h>

#include "formats/base/status.h"
#include "formats/leaf_file.h"
#include "formats/mesh_leaf.h"

/* mesh_leaf_check_loaded() - treelet t's topology, as leaf_file_load() gave it: the tree is one
 * (each node met once, in order; leaves in order; at most MESH_DEPTH_MAX nodes on a path), leaves
 * tile the tets and hold up to leaf_tets each, vertex indices are in range and strictly ascending,
 * positions within the bounds. ST_CORRUPT names file, byte (in the payload of a compressed one) and
 * treelet. Thread-safe. Values need no check to be safe. */
CHECKED status mesh_leaf_check_loaded(const leaf_file *f, uint32_t t, const void *topology);

/* mesh_leaf_check_topology() - the rest, of one that passed: padding, bounds exactly its vertices',
 * each vertex used, the codes of every child's box. mesh_leaf_check_values() - of a set, with the
 * topology: padding, range and flags exactly its values', the codes of every child's range.
 * scratch: mesh_leaf_check_scratch() bytes for a treelet of this shape. */
size_t mesh_leaf_check_scratch(const mesh_shape *s);
CHECKED status mesh_leaf_check_topology(const leaf_file *f, uint32_t t, const void *topology,
                                        void *scratch);
CHECKED status mesh_leaf_check_values(const leaf_file *f, uint32_t set, uint32_t t,
                                      const void *topology, const void *values, void *scratch);

#endif
