/* path_roots.h - where the value along a ray in a curved cell passes an isovalue.
 *
 * Between the ends of a part (path_part.h) the ray is cut into stretches until on each the value is
 * proven to rise or to fall throughout, or to stay off the isovalue (path_stretch.h). Where the
 * sides of a stretch's ends differ there is one root, else none. So roots are as many as the sides
 * at the faces ask for, even where rounding takes one across a face.
 *
 * In a folded cell the value goes linearly between the ends of each part (M08 6.4.3).
 */
#ifndef RENDER_CURVED_PATH_ROOTS_H
#define RENDER_CURVED_PATH_ROOTS_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/curved/cell_form.h"
#include "formats/curved/path_part.h"

enum { PATH_ROOTS = 16 };

typedef struct path_root {
    double t, at[3];
    bool entering; /* from value < isovalue to value >= isovalue */
} path_root;

typedef struct path_counts {
    uint64_t paths, stretches; /* parts of rays, and stretches that were looked at */
    uint64_t doubtful;         /* stretches as short as they get, without a proof */
} path_counts;

/* path_roots() - returns the number of roots, in order of t within each part, part by part.
 *
 * counts   added to; may be NULL */
int path_roots(const curved_map *m, const path_part *parts, int part_count, bool folded,
               double isovalue, path_root out[PATH_ROOTS], path_counts *counts);

#endif
