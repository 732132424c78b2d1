/* bent_triangle.h - where a ray crosses a quadratic triangle, the face of a quadratic tet.
 *
 * As for bilinear patches (patch.h), the turns of the edges about the ray say how often it is
 * crossed, each way taken off the other. An edge's turn depends on that edge alone, so all cells
 * around it agree, and what crosses into a closed cell crosses out of it. Of a straight edge the
 * turn is exact and the same as of a patch's; of a bent one it is that of a parabola, in doubles.
 * Where the ray crosses follows from the face alone.
 */
#ifndef FORMATS_CURVED_BENT_TRIANGLE_H
#define FORMATS_CURVED_BENT_TRIANGLE_H

#include <stdbool.h>

enum { BENT_NODES = 6, BENT_CORNERS = 3, BENT_CROSSINGS = 8 };

typedef struct bent_triangle {
    /* In the ray's space (sheared_ray.h): three corners, then the Bernstein coefficients of the
     * edges 01, 12, 02. The third coordinate is not looked at. */
    double q[BENT_NODES][3];
    bool straight[BENT_CORNERS]; /* of these edges */
} bent_triangle;

typedef struct bent_crossing {
    double share[BENT_CORNERS]; /* of the corners, 0 or more; their sum is 1 */
    int sense; /* 1: the ray goes the way of (d/d share 1) x (d/d share 2), in its space; -1 */
} bent_crossing;

/* bent_triangle_cross() - returns the number of crossings. Everyone who shares the face must give
 * its corners in the same order, such as by position. */
int bent_triangle_cross(const bent_triangle *b, bent_crossing out[BENT_CROSSINGS]);

/* bent_triangle_at() - a quadratic form, by its coefficients in the order of q, at shares. */
double bent_triangle_at(const double form[BENT_NODES], const double share[BENT_CORNERS]);

#endif
