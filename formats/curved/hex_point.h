/* hex_point.h - points in a hexahedron: which cell has one, its parameters, the gradient there. */
#ifndef FORMATS_CURVED_HEX_POINT_H
#define FORMATS_CURVED_HEX_POINT_H

#include <stdbool.h>

#include "formats/curved/hex_path.h"

/* hex_point_find() - whether the cell holds a point; if so, its parameters. Of cells that share a
 * face, one holds a point of it: the parts along an axis tell (hex_path.h). Where that axis touches
 * a face at the point, several may: then the first counts.
 *
 * sense    hexahedron_sense(); 0: parameters are those of the folded cell's rule, linear along the
 *          axis
 * value    out: that at the point */
bool hex_point_find(const hexahedron *h, int sense, const double point[3], double at[3],
                    double *value);

/* hex_point_gradient() - the gradient of the value in the world, at parameters. False: the map has
 * no inverse there (a collapsed edge, say); then it is 0. */
bool hex_point_gradient(const hexahedron *h, const double at[3], double gradient[3]);

#endif
