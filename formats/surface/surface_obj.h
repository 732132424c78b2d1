/* surface_obj.h - Wavefront OBJ as a stream of triangles: vertices, and faces of three or more
 * corners.
 *
 * Vertices of six numbers have a colour, "rgb": red, green and blue in 0 .. 1. Whether there is one
 * is what the first vertex says; others without it are NaN. Texture coordinates, normals, groups
 * and materials are ignored; points and lines are skipped and counted. A face may name vertices
 * that come later.
 */
#ifndef FORMATS_SURFACE_SURFACE_OBJ_H
#define FORMATS_SURFACE_SURFACE_OBJ_H

#include "formats/mesh/mesh_reader.h"

extern const mesh_reader surface_obj_reader;

#endif
