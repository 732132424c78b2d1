/* convert_meshes.h - meshes, and surfaces of triangles, as inputs of convert: rows of
 * convert_main.c. */
#ifndef PREP_MESH_CONVERT_MESHES_H
#define PREP_MESH_CONVERT_MESHES_H

#include "prep/convert_kind.h"

extern const convert_kind convert_meshes, convert_surfaces;

#endif
