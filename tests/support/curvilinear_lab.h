/* curvilinear_lab.h - lattices of some hundred hexahedra, as a treelet has them, each of a shape
 * that is hard somewhere. For the walk through a treelet; single cells are hex_lab.h's.
 */
#ifndef TESTS_SUPPORT_CURVILINEAR_LAB_H
#define TESTS_SUPPORT_CURVILINEAR_LAB_H

#include "render/ray/ray.h"
#include "stream/curvilinear_lattice.h"
#include "tests/support/fields.h"

enum { CURVILINEAR_LAB_NODES = 33 * 9 * 9 };

typedef struct curvilinear_lab {
    const char *name;
    curvilinear_lattice lattice;
    float p[3][CURVILINEAR_LAB_NODES + CURVILINEAR_READ], values[CURVILINEAR_LAB_NODES];
    uint8_t codes[CURVILINEAR_LAB_NODES / 4 + 1];
    float box[2][3];
    uint32_t count; /* cells */
} curvilinear_lab;

int curvilinear_lab_count(void);

/* curvilinear_lab_make() - shape number `index`, with the senses of its cells; some are blanked,
 * some values NaN, unless it is the first shape. Values are waves between -1 and 1. None is active.
 * curvilinear_lab_free() - frees the lattice. */
void curvilinear_lab_make(curvilinear_lab *s, mem *m, int index);
void curvilinear_lab_free(curvilinear_lab *s);

/* curvilinear_lab_ray() - through a point in its box, from outside or inside of it; all t, or a
 * part. Now and then through a node, along an axis. */
ray curvilinear_lab_ray(const curvilinear_lab *s, field_random *r);

#endif
