/* vtk_grid_parts.h - grids of VTK in files that name files: collections (.pvd), whose files are the
 * time steps, and blocks (.vtm, .vtmb) where there is but one.
 *
 * The file of a step is read as if it had been given itself. Several of one time are refused:
 * pieces of a grid are those of a .pvti, which may be such a file.
 */
#ifndef FORMATS_GRID_VTK_GRID_PARTS_H
#define FORMATS_GRID_VTK_GRID_PARTS_H

#include "formats/grid/grid_reader.h"

extern const grid_reader vtk_grid_parts_reader;

#endif
