/* mesh_fetch.h - positions and values of a treelet's vertices, and what the directory says of them.
 */
#ifndef PREP_MESH_MESH_FETCH_H
#define PREP_MESH_MESH_FETCH_H

#include "formats/leaf/leaf_writer.h"
#include "prep/mesh/mesh_pages.h"
#include "prep/mesh/mesh_vertices.h"

/* mesh_fetch() - copy `size` bytes of each vertex, in the order of their numbers. Fails only if
 * reading does. */
CHECKED status mesh_fetch(const mesh_vertices *v, mesh_pages *from, void *to, size_t size);

/* mesh_fetch_bounds() - lo x y z, hi x y z of 1 or more positions.
 * mesh_fetch_range() - the directory's entry of values. */
void mesh_fetch_bounds(const float (*position)[3], uint32_t count, float bounds[6]);
leaf_entry mesh_fetch_range(const float *value, uint32_t count);

#endif
