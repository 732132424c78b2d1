/* mesh_geometry.h - the table of functions for meshes in a treelet file. */
#ifndef FORMATS_LEAF_MESH_GEOMETRY_H
#define FORMATS_LEAF_MESH_GEOMETRY_H

#include "formats/leaf/leaf_geometry.h"

extern const leaf_geometry mesh_geometry;
extern const struct leaf_blending mesh_blending; /* of files between the steps of one */

#endif
