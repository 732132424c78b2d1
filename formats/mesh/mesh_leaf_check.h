/* mesh_leaf_check.h - whether the payloads of a mesh's treelet are sound.
 *
 * Two depths: what makes a topology safe to traverse, cheap enough for every load, and everything
 * that can be recomputed, for `verify`. Against any bytes, not only against accidents.
 */
#ifndef FORMATS_MESH_MESH_LEAF_CHECK_H
#define FORMATS_MESH_MESH_LEAF_CHECK_H

#include <stddef.h>

#include "formats/base/status.h"
#include "formats/leaf/leaf_file.h"
#include "formats/mesh/mesh_leaf.h"

/* mesh_leaf_check_loaded() - treelet t's topology, as leaf_file_load() gave it: the tree is one
 * (each node met once, in order; leaves in order; at most MESH_DEPTH_MAX nodes on a path), leaves
 * tile the tets and hold up to leaf_tets each, vertex indices are in range and strictly ascending,
 * positions within the bounds. ST_CORRUPT names file, byte (in the payload of a compressed one) and
 * treelet. Thread-safe. Values and gradients need no check to be safe (but a gradient may be any
 * float). mesh_leaf_check_moved() - likewise its positions at a step: within the step's bounds. */
CHECKED status mesh_leaf_check_loaded(const leaf_file *f, uint32_t t, const void *topology);
CHECKED status mesh_leaf_check_moved(const leaf_file *f, uint32_t step, uint32_t t,
                                     const void *positions);

/* mesh_leaf_check_topology() - the rest, of one that passed: padding, bounds exactly its vertices',
 * each vertex used, the codes of every child's box. mesh_leaf_check_values() - of a set, with the
 * topology: padding, range and flags exactly its values', the codes of every child's range.
 * mesh_leaf_check_positions() - of a step that passed mesh_leaf_check_moved(), with the topology:
 * padding, bounds exactly its vertices', the codes of every child's box.
 * mesh_leaf_check_gradients() - of a set: padding, finite numbers.
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
