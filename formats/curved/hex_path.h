/* hex_path.h - the parts of a ray in a hexahedron, from where it crosses in to where it crosses
 * out.
 *
 * Crossings are those of patch.h: where a part ends at a face, another begins in the cell beyond,
 * at the same t and with the same value, to the bit. In a cell that is no fold
 * (hexahedron_sense()), parts are what the trilinear map makes of the ray. In a folded cell they
 * are the crossings in order of t, an entry with an exit each.
 */
#ifndef FORMATS_CURVED_HEX_PATH_H
#define FORMATS_CURVED_HEX_PATH_H

#include "formats/base/hexahedron.h"
#include "formats/curved/path_part.h"
#include "formats/curved/sheared_ray.h"

typedef struct hex_path {
    double q[3][HEX_CORNERS]; /* the corners in the ray's space, by coordinate */
    int count;
    path_part part[PATH_PARTS]; /* in order of t */
} hex_path;

/* hex_path_of() - sense: hexahedron_sense(); 0 counts as 1. Returns the number of parts. */
int hex_path_of(const hexahedron *h, int sense, const sheared_ray *r, hex_path *out);

#endif
