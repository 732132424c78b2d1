/* mesh_split.h - hexes, wedges, pyramids and voxels as tets that fit together across shared faces.
 *
 * The diagonal of every quad goes through its smallest global vertex id, so both cells at a face
 * cut it alike, whatever their kinds. Any numbering then gives a valid set of tets: the cell's
 * smallest vertex joined to each triangle of the faces it does not lie on (J. Dompierre et al.,
 * "How to subdivide pyramids, prisms and hexahedra into tetrahedra", 1999). A repeated vertex (a
 * hex collapsed to a wedge) is fine: mesh_feed.h leaves out tets that have it twice.
 *
 * A face that is not plane is bent at its diagonal; a cell that is bent far enough gets inverted
 * tets, as it must. Polyhedra come in parts (mesh_polyhedron.h), cells
 * of higher order not at all, or by their corners (mesh_hints.by_corners).
 */
#ifndef FORMATS_MESH_MESH_SPLIT_H
#define FORMATS_MESH_MESH_SPLIT_H

#include "formats/mesh/mesh_sink.h"

enum { MESH_SPLIT_TETS = 6 };

/* mesh_split() - split a cell into tets of the cell's own orientation. Returns how many: 6 for
 * hexes and voxels, 3 for wedges, 2 for pyramids, 1 for tets. */
int mesh_split(cell_shape kind, const uint32_t *ids, uint32_t tets[MESH_SPLIT_TETS][4]);

#endif
