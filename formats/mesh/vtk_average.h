/* vtk_average.h - the chosen data of a piece's cells, averaged to its points (mesh_average.h). */
#ifndef FORMATS_MESH_VTK_AVERAGE_H
#define FORMATS_MESH_VTK_AVERAGE_H

#include "formats/mesh/vtk_unstructured.h"

/* vtk_average_feed() - a value of each field taken for each point of the piece. The cells are read
 * as often as the sums take rounds over the points, once for every 16 fields. */
CHECKED status vtk_average_feed(const vtk_unstructured *g, const vtk_piece *p, mesh_feed *feed);

#endif
