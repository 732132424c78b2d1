/* quadratic_path.h - the parts of a ray in a quadratic tet, as hex_path.h has them of a hexahedron:
 * faces are those of bent_triangle.h. And points in such a tet.
 */
#ifndef FORMATS_CURVED_QUADRATIC_PATH_H
#define FORMATS_CURVED_QUADRATIC_PATH_H

#include "formats/base/quadratic_tet.h"
#include "formats/curved/cell_form.h"
#include "formats/curved/path_part.h"
#include "formats/curved/sheared_ray.h"

typedef struct quadratic_path {
    curved_map map;    /* the cell in the ray's space */
    unsigned straight; /* quadratic_straight_edges() */
    int count;
    path_part part[PATH_PARTS]; /* in order of t */
} quadratic_path;

/* quadratic_path_of() - sense: quadratic_sense(); 0 counts as 1. Returns the number of parts. */
int quadratic_path_of(const quadratic_tet *c, int sense, const sheared_ray *r, quadratic_path *out);

/* The same in two steps. quadratic_path_place() - set the map, without parts; false: it lies beside
 * the ray, which then has no parts in it, and the map is not set. quadratic_path_cross() - the
 * parts. */
bool quadratic_path_place(const quadratic_tet *c, const sheared_ray *r, quadratic_path *out);
int quadratic_path_cross(const quadratic_tet *c, int sense, const sheared_ray *r,
                         quadratic_path *out);

/* quadratic_point_find() - as hex_point_find(). */
bool quadratic_point_find(const quadratic_tet *c, int sense, const double point[3], double at[3],
                          double *value);

/* quadratic_point_gradient() - the gradient of the value in the world, at parameters. False: the
 * map has no inverse there; then it is 0. */
bool quadratic_point_gradient(const quadratic_tet *c, const double at[3], double gradient[3]);

#endif
