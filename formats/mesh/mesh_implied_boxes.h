/* mesh_implied_boxes.h - makes the boxes of a treelet's nodes, as its tets and positions imply
 * them.
 */
#ifndef FORMATS_MESH_MESH_IMPLIED_BOXES_H
#define FORMATS_MESH_MESH_IMPLIED_BOXES_H

#include <stdbool.h>

#include "formats/mesh/mesh_leaf.h"

/* mesh_implied_boxes() - fill lo and hi of all nodes of a topology whose other parts are there.
 * Children are behind their parents, each vertex is in range, and leaf_first ascends
 * strictly to the number of tets. bounds: of the treelet, finite and ordered. Returns false if a
 * position is outside of them. */
bool mesh_implied_boxes(const mesh_shape *s, const float bounds[6], void *topology);

#endif
