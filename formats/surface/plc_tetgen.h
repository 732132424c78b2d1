/* plc_tetgen.h - TetGen's .node (points), .poly and .smesh (points and facets).
 *
 * Points as in mesh_tetgen.h; a .poly or .smesh without points takes the points of F.node beside
 * it. A facet of .poly: polygons and points in holes; of .smesh: one polygon. Then holes and
 * regions. Fields of the points: attr1, attr2, .. (also 1, 2, ..) and marker.
 */
#ifndef FORMATS_SURFACE_PLC_TETGEN_H
#define FORMATS_SURFACE_PLC_TETGEN_H

#include "formats/surface/plc.h"

CHECKED status plc_tetgen_read_node(plc_source *s);
CHECKED status plc_tetgen_read_poly(plc_source *s);
CHECKED status plc_tetgen_read_smesh(plc_source *s);

#endif
