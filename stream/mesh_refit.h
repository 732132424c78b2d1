/* mesh_refit.h - a mesh's tree fitted to other vertices: W07 6.2.
 *
 * The tree of one step serves all: its nodes' boxes and ranges of values follow from the vertices,
 * bottom up. They come out as the bits that the file has for that step, so that a payload whose
 * vertices alone were read can be completed and then be judged by its checksum.
 */
#ifndef STREAM_MESH_REFIT_H
#define STREAM_MESH_REFIT_H

#include <stdbool.h>
#include <stddef.h>

#include "formats/mesh/mesh_leaf.h"

/* mesh_refit_scratch() - bytes that the others need for a treelet of this shape. */
size_t mesh_refit_scratch(const mesh_shape *s);

/* mesh_refit_values() - put the codes of every child's range, and the zeros behind them, before the
 * values of a payload. own: the treelet's range in this set; finite: all values are. */
void mesh_refit_values(const mesh_shape *s, const void *topology, const float own[2], bool finite,
                       void *values, void *scratch);

/* mesh_refit_boxes() - put the codes of every child's box, and the zeros behind them, before the
 * positions of a payload, which lie within bounds: the treelet's at this step. */
void mesh_refit_boxes(const mesh_shape *s, const void *topology, const float bounds[6],
                      void *positions, void *scratch);

#endif
