/* mesh_leaf_check.h - checks of the payloads of a mesh's treelet.
 *
 * Two depths: whether a topology is safe to traverse, cheap enough for every load; and everything
 * that can be recomputed, for `verify`. Both hold against any bytes, not only against accidents.
 */
#ifndef FORMATS_MESH_MESH_LEAF_CHECK_H
#define FORMATS_MESH_MESH_LEAF_CHECK_H

#include <stddef.h>

#include "formats/base/status.h"
#include "formats/leaf/leaf_file.h"
#include "formats/mesh/mesh_leaf.h"

/* mesh_leaf_check_loaded() - check treelet t's topology, as leaf_file_load() gave it: the tree is
 * one (each node met once, in order; leaves in order; at most MESH_DEPTH_MAX nodes on a path);
 * leaves tile the tets and hold up to leaf_tets each; vertex indices are in range and strictly
 * ascending; positions are within the bounds. ST_CORRUPT names file, byte (in the unpacked payload
 * if it is compressed) and treelet. Thread-safe. Values and gradients are safe unchecked (but a
 * gradient may be any float).
 * mesh_leaf_check_moved() - check the positions at a step likewise: within the step's bounds. */
CHECKED status mesh_leaf_check_loaded(const leaf_file *f, uint32_t t, const void *topology);
CHECKED status mesh_leaf_check_moved(const leaf_file *f, uint32_t step, uint32_t t,
                                     const void *positions);

/* mesh_leaf_check_topology() - check the rest of a topology that passed mesh_leaf_check_loaded():
 * padding, bounds exactly its vertices', each vertex used, the codes of every child's box.
 * mesh_leaf_check_values() - check a set's values, given the topology: padding, range and flags
 * exactly the values', the codes of every child's range.
 * mesh_leaf_check_positions() - check a step that passed mesh_leaf_check_moved(), given the
 * topology: padding, bounds exactly its vertices', the codes of every child's box.
 * mesh_leaf_check_gradients() - check a set's gradients: padding, finite numbers.
 * scratch: mesh_leaf_check_scratch() bytes for a treelet of this shape. */
size_t mesh_leaf_check_scratch(const mesh_shape *s);
CHECKED status mesh_leaf_check_topology(const leaf_file *f, uint32_t t, const void *topology,
                                        void *scratch);
CHECKED status mesh_leaf_check_values(const leaf_file *f, uint32_t set, uint32_t t,
                                      const void *topology, const void *values, void *scratch);
CHECKED status mesh_leaf_check_positions(const leaf_file *f, uint32_t step, uint32_t t,
                                         const void *topology, const void *positions,
                                         void *scratch);
CHECKED status mesh_leaf_check_gradients(const leaf_file *f, uint32_t set, uint32_t t,
                                         const void *gradients);

#endif
