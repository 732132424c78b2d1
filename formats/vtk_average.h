/* vtk_average.h - data of the cells, averaged to the points.
 *
 * A point gets the mean over the volume cells that it is a vertex of, added up in the order of the
 * cells; 0 where there are none. Cells with an id that is no point take no part.
 */
#ifndef FORMATS_VTK_AVERAGE_H
#define FORMATS_VTK_AVERAGE_H

#include "formats/vtk_grid.h"

/* vtk_average_feed() - a value for each point of the piece from its chosen field. The cells are
 * read as often as the sums, a quarter of the budget at most, take rounds over the points; that
 * changes no value. */
CHECKED status vtk_average_feed(mem *m, const vtk_piece *p, int component, mesh_feed *feed);

#endif
