/* vtk_grid_legacy.h - legacy VTK files (.vtk) of structured points and rectilinear grids, versions
 * 1.0 to 5.1.
 *
 * Text or big-endian bytes; attributes (scalars, vectors, ..) and field arrays of points and cells.
 * Only regular files: a pass over the whole file finds where the samples lie.
 */
#ifndef FORMATS_GRID_VTK_GRID_LEGACY_H
#define FORMATS_GRID_VTK_GRID_LEGACY_H

#include "formats/grid/grid_reader.h"

extern const grid_reader vtk_grid_legacy_reader;

#endif
