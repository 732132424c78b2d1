/* naive_points.h - what a treelet file says of a point of world space, by the second readers
 * (naive_leaf.h, naive_mesh.h): cell by cell, in long double, none of the renderer's code.
 */
#ifndef TESTS_SUPPORT_NAIVE_POINTS_H
#define TESTS_SUPPORT_NAIVE_POINTS_H

#include "tests/support/naive_leaf.h"
#include "tests/support/naive_mesh.h"

/* A point and what is there. */
typedef struct naive_point {
    bool inside;
    bool doubtful;               /* about as near to a border of the volume as doubles can tell */
    long treelet;                /* in the file's order */
    long double linear, nearest; /* NaN: no data */
    long double second;          /* of the nearest: what it would be within rounding */
    long double magnitude;       /* of the values that it is made of */
} naive_point;

/* naive_points_grid() - at a level of detail. */
naive_point naive_points_grid(const naive_leaf *leaf, int level, const double point[3]);

/* naive_points_mesh() - in the values of a set, at its step: by the first tet that holds the point.
 */
naive_point naive_points_mesh(const naive_mesh *mesh, long set, const double point[3]);

#endif
