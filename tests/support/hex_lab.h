/* hex_lab.h - small structured grids of hexahedra, each of a shape that is hard somewhere: bent,
 * twisted, round with a collapsed axis or with poles, flat, jittered, folded.
 */
#ifndef TESTS_SUPPORT_HEX_LAB_H
#define TESTS_SUPPORT_HEX_LAB_H

#include "formats/base/hexahedron.h"
#include "render/ray/ray.h"
#include "tests/support/fields.h"

enum { HEX_LAB_CELLS = 5, HEX_LAB_NODES = HEX_LAB_CELLS + 1 };

typedef struct hex_lab {
    const char *name;
    bool closed; /* the first parameter goes round: cells 0 and HEX_LAB_CELLS - 1 share faces */
    bool may_be_folded, regular;
    double size; /* longest edge of the box about it */
    double iso;
    float p[HEX_LAB_NODES][HEX_LAB_NODES][HEX_LAB_NODES][3]; /* [k][j][i] */
    float value[HEX_LAB_NODES][HEX_LAB_NODES][HEX_LAB_NODES];
} hex_lab;

int hex_lab_count(void);

/* hex_lab_make() - shape number `index`; values are a wave with noise, so that cells have several
 * pieces of surface. */
void hex_lab_make(hex_lab *s, int index, uint64_t seed);

/* hex_lab_cell() - cell (at[0], at[1], at[2]). */
hexahedron hex_lab_cell(const hex_lab *s, const int at[3]);

/* hex_lab_ray() - a ray from outside, through a point inside; all t. Now and then exactly through a
 * node or along an edge, as far as the origin's rounding allows: then it is *special. */
ray hex_lab_ray(const hex_lab *s, field_random *r, bool *special);

#endif
