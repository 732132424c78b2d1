/* spheres_geometry.h - the row of spheres in a treelet file. */
#ifndef TESTS_SPHERES_SPHERES_GEOMETRY_H
#define TESTS_SPHERES_SPHERES_GEOMETRY_H

#include "formats/leaf/leaf_geometry.h"

extern const leaf_geometry spheres_geometry;

#endif
