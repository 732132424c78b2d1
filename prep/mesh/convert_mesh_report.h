/* convert_mesh_report.h - what convert tells on standard output of a mesh. */
#ifndef PREP_MESH_CONVERT_MESH_REPORT_H
#define PREP_MESH_CONVERT_MESH_REPORT_H

#include "prep/convert_request.h"
#include "prep/mesh/mesh_convert.h"

/* convert_mesh_report() - cells: what was kept as it is; NULL: tets. seconds: since the verb began.
 */
CHECKED status convert_mesh_report(const convert_request *a, const cell_treelets *cells,
                                   const mesh_result *r, double seconds);

#endif
