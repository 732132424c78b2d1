/* export_cells.h - how the verb export writes meshes of tets, cells that are hexahedra, and
 * surfaces of triangles: rows of export_main.c.
 */
#ifndef PREP_EXPORT_EXPORT_CELLS_H
#define PREP_EXPORT_EXPORT_CELLS_H

#include "prep/export/export_kind.h"

extern const export_kind export_tets, export_hexes, export_triangles;

#endif
