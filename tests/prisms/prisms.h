/* prisms.h - a fourth kind of geometry, as a second proof: columns over triangles, a cell with two
 * kinds of faces, each of one value. Outside of all of them the value is 0. So the isosurface of v
 * is the surface of every prism of v or more.
 *
 * A prism is a record of leaf_cells.h. Prisms that share a face have the bits of its vertices in
 * common: then a ray leaves the one where it enters the other. A point on a shared face belongs to
 * one of both. From step to step values change, and places may.
 */
#ifndef TESTS_PRISMS_PRISMS_H
#define TESTS_PRISMS_PRISMS_H

#include "formats/leaf/leaf_cells.h"
#include "render/ray/kind.h"

enum { PRISMS_KIND = 7, PRISMS_TREELET_MAX = 512 };

typedef struct prism { /* offset size */
    float base[3][2];  /*  0 24  x y of a triangle that is not flat, in any order */
    float z[2];        /* 24  8  bottom below top */
    float value;       /* 32  4  above 0 */
    float reserved[7]; /* 36 28 */
} prism;

_Static_assert(sizeof(prism) == LEAF_ALIGN, "so that any number of them is aligned");

/* The rows. In memory it is cell_resident. */
extern const leaf_geometry prisms_geometry;
extern const kind prisms_kind;

#endif
