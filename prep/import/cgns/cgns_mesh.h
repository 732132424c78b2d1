/* cgns_mesh.h - CGNS files as meshes: the zones of the first base of three dimensions, one behind
 * the other, structured ones as hexahedra.
 *
 * Zones are not joined: nodes that they share come twice, with the same place and, if the file has
 * it so, the same value. Rind planes, boundary conditions and connectivities are left out.
 * After the CGNS Standard Interface Data Structures (SIDS), version 3.4.
 */
#ifndef PREP_IMPORT_CGNS_CGNS_MESH_H
#define PREP_IMPORT_CGNS_CGNS_MESH_H

#include "prep/import/importer.h"

/* cgns_mesh_open() - ST_USAGE for a field or a step that there is not; ST_UNSUPPORTED for
 * polyhedra without NFACE_n, coordinates other than x, y and z, and for elements of higher order,
 * but for tets of ten nodes, unless q->by_corners. */
CHECKED status cgns_mesh_open(mem *m, const import_request *q, import_mesh *out);
CHECKED status cgns_mesh_list(mem *m, const import_request *q, const import_list *to);

#endif
