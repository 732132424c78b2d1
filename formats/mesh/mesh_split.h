/* mesh_split.h - hexes, wedges, pyramids and voxels as tets that fit together across shared faces.
 *
 * The diagonal of every quad goes through its smallest global vertex id, so both cells at a face
 * cut it alike, whatever their kinds. For any numbering that leaves a valid set of tets inside the
 * cell: those that its smallest vertex makes with the triangles of the faces it does not lie on (J.
 * Dompierre et al., "How to subdivide pyramids, prisms and hexahedra into tetrahedra", 1999). A
 * vertex that is there twice (a hex collapsed to a wedge) is fine: tets that have it twice are left
 * out by mesh_feed.h.
 *
 * A face that is not plane is bent at its diagonal; a cell that is bent far enough gets inverted
 * tets, as it must. There are no other cells: quadratic ones and polyhedra are refused by the
 * readers.
 */
#ifndef FORMATS_MESH_MESH_SPLIT_H
#define FORMATS_MESH_MESH_SPLIT_H

#include "formats/mesh/mesh_sink.h"

enum { MESH_SPLIT_TETS = 6 };

/* mesh_split_vertices() - of a cell of this kind, tets too. */
int mesh_split_vertices(mesh_cell kind);

/* mesh_split() - the tets of a cell, all with the cell's own orientation: hexes 6, wedges 3,
 * pyramids 2, tets themselves. Returns how many. */
int mesh_split(mesh_cell kind, const uint32_t *ids, uint32_t tets[MESH_SPLIT_TETS][4]);

#endif
