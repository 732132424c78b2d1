/* curvilinear_vtk_parts.h - structured grids of VTK in several files: the pieces of one grid
 * (.pvts), and collections whose files are the time steps (.pvd).
 *
 * Pieces are joined to one zone by their extents, so the grid is what it was before it was cut up;
 * where several have a node or a cell, the last one's counts. All files of a step are open, and a
 * plane of the largest piece is in memory. A collection names .vts and .pvts files, one a step.
 */
#ifndef FORMATS_CURVILINEAR_CURVILINEAR_VTK_PARTS_H
#define FORMATS_CURVILINEAR_CURVILINEAR_VTK_PARTS_H

#include "formats/curvilinear/curvilinear_reader.h"

extern const curvilinear_reader curvilinear_vtk_pieces_reader, curvilinear_vtk_collection_reader;

#endif
