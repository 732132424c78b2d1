/* surface_readers.h - any known surface as a stream of points, values and triangles: the formats
 * (PLY, STL, OBJ, OFF, VTP, legacy VTK, glTF), for mesh_input.h.
 *
 * All functions of mesh_input.h work on what is opened here; its sink must take triangles.
 */
#ifndef FORMATS_SURFACE_SURFACE_READERS_H
#define FORMATS_SURFACE_SURFACE_READERS_H

#include "formats/mesh/mesh_input.h"
#include "formats/mesh/mesh_reader.h"

extern const mesh_readers surface_readers;

/* surface_input_open() - mesh_input_open() of a surface. */
CHECKED status surface_input_open(mem *m, const char *path, const mesh_hints *hints,
                                  mesh_input **out);

#endif
