/* mesh_vtu.h - VTK XML files of unstructured grids (.vtu), as meshes.
 *
 * Arrays as text, in base64, or appended (raw or in base64), plain or in zlib blocks; one piece or
 * several. The XML is parsed once, up to the appended data, without holding any array.
 */
#ifndef FORMATS_MESH_MESH_VTU_H
#define FORMATS_MESH_MESH_VTU_H

#include "formats/mesh/mesh_reader.h"
#include "formats/mesh/vtk_unstructured.h"

extern const mesh_reader mesh_vtu_reader;

/* mesh_vtu_scan() - add the pieces of one more file to a grid. path must live as long as the grid.
 */
CHECKED status mesh_vtu_scan(vtk_unstructured *g, const char *path, byte_stream *data);

#endif
