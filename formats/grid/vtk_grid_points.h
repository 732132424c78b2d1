/* vtk_grid_points.h - where a structured grid of VTK lies: by its points, which must be those of a
 * regular or rectilinear grid, in any place and direction.
 *
 * The points are read twice, a row at a time. The first time those along three edges make the axes;
 * the second time every point is held against these. It may be off by what rounding makes of
 * numbers of its type, and never by more than an eighth of the smallest step.
 */
#ifndef FORMATS_GRID_VTK_GRID_POINTS_H
#define FORMATS_GRID_VTK_GRID_POINTS_H

#include "formats/grid/vtk_grid.h"

/* vtk_grid_place_points() - to_world and the axes of `to`, which has its sizes. ST_UNSUPPORTED,
 * naming the first node that lies elsewhere and what to do, for a curvilinear grid; ST_CORRUPT
 * where a piece has no points. */
CHECKED status vtk_grid_place_points(const vtk_grid *g, grid *to);

#endif
