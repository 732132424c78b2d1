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

#include <stdbool.h>

#include "formats/base/hexahedron.h"
#include "formats/curved/sheared_ray.h"

enum { HEX_PARTS = 6 };

/* An end of a part: on a face. */
typedef struct hex_end {
    double t, at[3], value;
} hex_end;

typedef struct hex_part {
    hex_end end[2];
} hex_part;

typedef struct hex_path {
    double q[3][HEX_CORNERS]; /* the corners in the ray's space, by coordinate */
    int count;
    hex_part part[HEX_PARTS]; /* in order of t */
} hex_path;

/* hex_path_of() - sense: hexahedron_sense(); 0 counts as 1. Returns the number of parts. */
int hex_path_of(const hexahedron *h, int sense, const sheared_ray *r, hex_path *out);

/* Looks at one stretch of a part, cut from it `depth` times. Returns true, and a point in its
 * middle, if it is to be cut there. */
typedef bool hex_look(void *ctx, const hex_end *from, const hex_end *to, int depth,
                      hex_end *middle);
enum { HEX_DEPTH = 52 }; /* a stretch of this depth is not cut, whatever is returned */

/* hex_part_walk() - look at the whole of a part, then at what it is cut into, in order of t. */
void hex_part_walk(const hex_part *part, hex_look *look, void *ctx);

#endif
