/* hex_roots.h - where the value along a ray in a hexahedron passes an isovalue.
 *
 * Between the ends of a part (hex_path.h) the ray is cut into stretches until on each the value is
 * proven to rise or to fall throughout, or to stay off the isovalue (hex_stretch.h). Where the
 * sides of a stretch's ends differ there is one root, else none. So roots are as many as the sides
 * at the faces ask for, even where rounding takes one across a face.
 *
 * In a folded cell the value goes linearly between the ends of each part (M08 6.4.3).
 */
#ifndef RENDER_CURVED_HEX_ROOTS_H
#define RENDER_CURVED_HEX_ROOTS_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/curved/hex_path.h"

enum { HEX_ROOTS = 16 };

typedef struct hex_root {
    double t, at[3];
    bool entering; /* from value < isovalue to value >= isovalue */
} hex_root;

typedef struct hex_counts {
    uint64_t paths, stretches; /* parts of rays, and stretches that were looked at */
    uint64_t doubtful;         /* stretches as short as they get, without a proof */
} hex_counts;

/* hex_roots() - returns the number of roots, in order of t within each part, part by part.
 *
 * sense    hexahedron_sense(); 0: the cell is folded
 * counts   added to; may be NULL */
int hex_roots(const hexahedron *h, int sense, const hex_path *path, double isovalue,
              hex_root out[HEX_ROOTS], hex_counts *counts);

#endif
