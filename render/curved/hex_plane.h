/* hex_plane.h - what a hexahedron can hold of an isosurface along a ray, without crossing its
 * faces.
 *
 * A trilinear value is a linear function of space and a rest, which is trilinear in the parameters
 * as well. So the rest is between its corners' values, in the whole cell. Along a ray the linear
 * function is one of t. It remains to look where the ray is in the cell's box. That is right for
 * any linear function, in folded cells too; it is sharp for the one that has the gradient in the
 * middle.
 */
#ifndef RENDER_CURVED_HEX_PLANE_H
#define RENDER_CURVED_HEX_PLANE_H

#include "formats/base/hexahedron.h"
#include "render/ray/ray.h"

typedef struct hex_plane {
    double t[2];     /* the ray is in the cell's box there at most; t[0] > t[1]: nowhere */
    double value[2]; /* all values of the cell that may be on the ray are between these */
} hex_plane;

/* hex_plane_of() - both are widened by far more than rounding, and by all that the crossings of its
 * faces may be rounded by. */
hex_plane hex_plane_of(const hexahedron *h, const ray *r);

#endif
