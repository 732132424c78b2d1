/* spheres.h - a third kind of geometry, as a proof that one is a folder and a row: balls in which
 * the value falls from the centre to the rim, f = peak (1 - |x - centre|^2 / radius^2), and nothing
 * outside of them. So isosurfaces are spheres, and rays meet them where a quadratic has its roots.
 *
 * A ball is a cell, and a record of leaf_cells.h. Balls that overlap do not know of each other:
 * each has its surfaces, and at a point the first one in the file's order counts. From step to step
 * balls may move and change.
 */
#ifndef TESTS_SPHERES_SPHERES_H
#define TESTS_SPHERES_SPHERES_H

#include "formats/leaf/leaf_cells.h"
#include "render/ray/kind.h"

enum { SPHERES_KIND = 7, SPHERES_TREELET_MAX = 1024 };

/* The least radius: errors are bounded for it. */
#define SPHERES_RADIUS_MIN 0x1p-4

typedef struct sphere { /* offset size */
    double centre[3];   /*  0 24 */
    double radius;      /* 24  8  SPHERES_RADIUS_MIN or more */
    double peak;        /* 32  8  above 0: the value at the centre */
    double reserved[3]; /* 40 24 */
} sphere;

_Static_assert(sizeof(sphere) == LEAF_ALIGN, "so that any number of them is aligned");

/* The rows. In memory it is cell_resident. */
extern const leaf_geometry spheres_geometry;
extern const kind spheres_kind;

#endif
