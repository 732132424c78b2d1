/* grid_geometry.h - the table of functions for grids in a treelet file. */
#ifndef FORMATS_LEAF_GRID_GEOMETRY_H
#define FORMATS_LEAF_GRID_GEOMETRY_H

#include "formats/leaf/leaf_geometry.h"

extern const leaf_geometry grid_geometry;
extern const struct leaf_blending grid_blending; /* of files between the steps of one */

#endif
