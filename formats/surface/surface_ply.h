/* surface_ply.h - PLY as a stream of triangles, in text or binary of either byte order: vertices,
 * faces, and strips of triangles.
 *
 * Fields: the scalar properties of the vertices but x, y, z, and of the faces; red, green and blue
 * together are the colour "rgb". Unknown elements and properties are skipped.
 */
#ifndef FORMATS_SURFACE_SURFACE_PLY_H
#define FORMATS_SURFACE_SURFACE_PLY_H

#include "formats/mesh/mesh_reader.h"

extern const mesh_reader surface_ply_reader;

#endif
