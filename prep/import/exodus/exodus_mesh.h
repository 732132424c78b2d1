/* exodus_mesh.h - Exodus II files, which are netCDF, as meshes: nodes, blocks of elements,
 * variables of both at each time step.
 *
 * Blocks of hexahedra, wedges, pyramids and tets make the mesh, shape by shape; blocks of shells,
 * bars and points are left out, and counted. Variables of the elements are averaged to the nodes.
 * Elements of higher order have their corners first (SAND92-2137, 4.8). Tets of ten nodes stay
 * quadratic: their nodes are ordered as quadratic_tet.h has them.
 */
#ifndef PREP_IMPORT_EXODUS_EXODUS_MESH_H
#define PREP_IMPORT_EXODUS_EXODUS_MESH_H

#include "prep/import/importer.h"

/* exodus_mesh_open() - ST_USAGE for a field or a step that there is not; ST_UNSUPPORTED for meshes
 * of fewer dimensions, for polyhedra, and for elements of other higher orders unless
 * q->by_corners. */
CHECKED status exodus_mesh_open(mem *m, const import_request *q, import_mesh *out);
CHECKED status exodus_mesh_list(mem *m, const import_request *q, const import_list *to);

#endif
