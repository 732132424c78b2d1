/* mesh_vtk_parts.h - unstructured grids of VTK in several files, as one mesh: parallel ones
 * (.pvtu), blocks (.vtm, .vtmb), and collections (.pvd), of which one time step is taken.
 *
 * The files of a step are joined as the pieces of a .vtu are: a point that several files have is
 * not merged. Ghost cells, which belong to another piece, are left out. A collection names .vtu,
 * .pvtu and .vtm files; a .vtm names .vtu and .pvtu alone.
 */
#ifndef FORMATS_MESH_MESH_VTK_PARTS_H
#define FORMATS_MESH_MESH_VTK_PARTS_H

#include "formats/mesh/mesh_reader.h"

extern const mesh_reader mesh_vtk_parts_reader;

#endif
