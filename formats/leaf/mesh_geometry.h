/* mesh_geometry.h - the table of functions for meshes in a treelet file. */
#ifndef FORMATS_LEAF_MESH_GEOMETRY_H
#define FORMATS_LEAF_MESH_GEOMETRY_H

#include "formats/leaf/leaf_geometry.h"

extern const leaf_geometry mesh_geometry;

#endif
