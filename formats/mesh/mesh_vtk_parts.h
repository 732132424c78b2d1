/* mesh_vtk_parts.h - unstructured grids of VTK in several files, as one mesh: parallel ones
 * (.pvtu), blocks (.vtm, .vtmb), and collections (.pvd), of which one time step is taken.
 *
 * Files of one step follow one another as the pieces of a .vtu do: points that several have stay
 * several. Cells that are another piece's are left out. A collection names .vtu, .pvtu and .vtm; a
 * .vtm none but .vtu and .pvtu.
 */
#ifndef FORMATS_MESH_MESH_VTK_PARTS_H
#define FORMATS_MESH_MESH_VTK_PARTS_H

#include "formats/mesh/mesh_reader.h"

extern const mesh_reader mesh_vtk_parts_reader;

#endif
