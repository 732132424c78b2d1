/* mesh_vtk.h - legacy VTK files (.vtk) of unstructured grids, versions 1.0 to 5.1, as meshes.
 *
 * Text or big-endian bytes; cells in the old form and the form of version 5; attributes and field
 * arrays of points and cells. One pass over the file finds where each array lies, without holding
 * it. Other data sets (grids, surfaces) are refused.
 */
#ifndef FORMATS_MESH_MESH_VTK_H
#define FORMATS_MESH_MESH_VTK_H

#include "formats/mesh/mesh_reader.h"

extern const mesh_reader mesh_vtk_reader;

#endif
