/* vtk_grid_parts.h - grids of VTK in files that name files: collections (.pvd), whose files are the
 * time steps, and blocks (.vtm, .vtmb) that have just one.
 *
 * The file of a step is read as if it had been given itself. Several files of one time are refused;
 * for the pieces of a grid, a .pvti may be the file of the step.
 */
#ifndef FORMATS_GRID_VTK_GRID_PARTS_H
#define FORMATS_GRID_VTK_GRID_PARTS_H

#include "formats/grid/grid_reader.h"

extern const grid_reader vtk_grid_parts_reader;

#endif
