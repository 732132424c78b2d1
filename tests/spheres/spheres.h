/* spheres.h - a third kind of geometry, as a proof that one is a folder and a row: balls in which
 * the value falls from the centre to the rim, f = peak (1 - |x - centre|^2 / radius^2), and nothing
 * outside of them. So isosurfaces are spheres, and rays meet them where a quadratic has its roots.
 *
 * A ball is a cell. Balls that overlap do not know of each other: each has its surfaces, and at a
 * point the first one in the file's order counts. A treelet is some balls; treelets' boxes may
 * overlap. In a treelet file of kind SPHERES_KIND:
 *
 *   BOUNDS   float[6] a treelet: holds its balls
 *   COUNTS   uint32_t[4] a treelet: balls; 0, 0, 0
 *   payload  sphere[balls]
 *
 * Of the header it uses what all kinds do, and bounds. Rows: spheres_geometry.h (the file),
 * spheres_resident.h (in memory), spheres_kind.h (rays).
 */
#ifndef TESTS_SPHERES_SPHERES_H
#define TESTS_SPHERES_SPHERES_H

#include <stdint.h>

#include "formats/leaf/leaf_file.h"

enum { SPHERES_KIND = 3, SPHERES_TREELET_MAX = 1024 };

typedef struct sphere { /* offset size */
    double centre[3];   /*  0 24 */
    double radius;      /* 24  8  above 0 */
    double peak;        /* 32  8  above 0: the value at the centre */
    double reserved[3]; /* 40 24 */
} sphere;

_Static_assert(sizeof(sphere) == LEAF_ALIGN, "so that any number of them is aligned");

/* What the directory has besides: leaf_file.besides. */
typedef struct spheres_directory {
    float (*bounds)[6];
    uint32_t (*counts)[4];
    uint64_t *first; /* treelets + 1: number of a treelet's first ball in the whole file */
} spheres_directory;

static inline const spheres_directory *spheres_directory_of(const leaf_file *f) {
    return f->besides;
}

#endif
