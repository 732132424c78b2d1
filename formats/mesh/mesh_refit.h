/* mesh_refit.h - a mesh's tree fitted to other vertices: W07 6.2.
 *
 * One tree serves all steps: its nodes' boxes and ranges of values are computed from the vertices,
 * bottom up. The results equal the file's for that step, to the bit. So it is enough to read the
 * vertices of a payload: the rest is computed, and the whole is checked by its checksum.
 */
#ifndef FORMATS_MESH_MESH_REFIT_H
#define FORMATS_MESH_MESH_REFIT_H

#include <stdbool.h>
#include <stddef.h>

#include "formats/mesh/mesh_leaf.h"

/* mesh_refit_scratch() - returns the scratch bytes of both functions below for this shape. */
size_t mesh_refit_scratch(const mesh_shape *s);

/* mesh_refit_values() - write the codes of every child's range, and the zeros behind them, in front
 * of the values of a payload. own: the treelet's range in this set. finite: all are finite. */
void mesh_refit_values(const mesh_shape *s, const void *topology, const float own[2], bool finite,
                       void *values, void *scratch);

/* mesh_refit_boxes() - write the codes of every child's box, and the zeros behind them, in front of
 * the positions of a payload. bounds: the treelet's box at this step, which holds all positions. */
void mesh_refit_boxes(const mesh_shape *s, const void *topology, const float bounds[6],
                      void *positions, void *scratch);

#endif
