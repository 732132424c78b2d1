/* vtk_grid_points.h - find where a structured grid of VTK lies. Its points must be those of a
 * regular or rectilinear grid, in any place and direction.
 *
 * The points are read twice, a row at a time. First the points along three edges make the axes;
 * then every point is compared with these. It may be off by the rounding error of its type, but
 * never by more than an eighth of the smallest step.
 */
#ifndef FORMATS_GRID_VTK_GRID_POINTS_H
#define FORMATS_GRID_VTK_GRID_POINTS_H

#include "formats/grid/vtk_grid.h"

/* vtk_grid_place_points() - set to_world and the axes of `to`, which has its sizes. ST_UNSUPPORTED
 * for a curvilinear grid, naming the first node that lies elsewhere and what to do; ST_CORRUPT
 * where a piece has no points. */
CHECKED status vtk_grid_place_points(const vtk_grid *g, grid *to);

#endif
