/* surface_stl.h - STL as a stream of triangles, in text or binary: each with three points of its
 * own, which are not welded.
 *
 * There are no fields. A binary file is recognised by its suffix; text also by its first words.
 */
#ifndef FORMATS_SURFACE_SURFACE_STL_H
#define FORMATS_SURFACE_SURFACE_STL_H

#include "formats/mesh/mesh_reader.h"

extern const mesh_reader surface_stl_reader;

#endif
