/* vtk_average.h - the chosen data of a piece's cells, averaged to its points (mesh_average.h). */
#ifndef FORMATS_MESH_VTK_AVERAGE_H
#define FORMATS_MESH_VTK_AVERAGE_H

#include "formats/mesh/vtk_unstructured.h"

/* vtk_average_feed() - feed each taken field's value at each point of the piece. The cells are read
 * once for every 16 fields and every round that the sums take over the points. */
CHECKED status vtk_average_feed(const vtk_unstructured *g, const vtk_piece *p, mesh_feed *feed);

#endif
