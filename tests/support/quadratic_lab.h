/* quadratic_lab.h - small meshes of quadratic tets, each of a shape that is hard somewhere:
 * straight, bent, with a few bent edges, flat, far from the origin, left-handed, nearly folded,
 * folded.
 */
#ifndef TESTS_SUPPORT_QUADRATIC_LAB_H
#define TESTS_SUPPORT_QUADRATIC_LAB_H

#include "formats/base/quadratic_tet.h"
#include "render/ray/ray.h"
#include "tests/support/fields.h"

/* Cubes of six tets each, about a diagonal. Nodes, of corners and of edges alike, are the points of
 * a lattice twice as fine. */
enum {
    QUADRATIC_LAB_CUBES = 3,
    QUADRATIC_LAB_NODES = 2 * QUADRATIC_LAB_CUBES + 1,
    QUADRATIC_LAB_CELLS = 6 * QUADRATIC_LAB_CUBES * QUADRATIC_LAB_CUBES * QUADRATIC_LAB_CUBES
};

typedef struct quadratic_lab {
    const char *name;
    bool may_be_folded, straight, left;
    double size; /* longest edge of the box about it */
    double iso;
    float p[QUADRATIC_LAB_NODES][QUADRATIC_LAB_NODES][QUADRATIC_LAB_NODES][3]; /* [k][j][i] */
    float value[QUADRATIC_LAB_NODES][QUADRATIC_LAB_NODES][QUADRATIC_LAB_NODES];
} quadratic_lab;

int quadratic_lab_count(void);

/* quadratic_lab_make() - shape number `index`; values are a wave with noise. */
void quadratic_lab_make(quadratic_lab *s, int index, uint64_t seed);

/* quadratic_lab_cell() - tet 0 to QUADRATIC_LAB_CELLS - 1. nodes: places of its nodes in the
 * lattice, out; may be NULL. */
quadratic_tet quadratic_lab_cell(const quadratic_lab *s, int cell, int nodes[QUADRATIC_NODES][3]);

/* quadratic_lab_at() - a point of a cell, and a value there, by its parameters. */
void quadratic_lab_at(const quadratic_tet *c, const double at[3], double p[3], double *value);

/* quadratic_lab_ray() - a ray from outside, through a point inside; all t. Now and then exactly
 * through a node or along a lattice's line, as far as the origin's rounding allows: *special. */
ray quadratic_lab_ray(const quadratic_lab *s, field_random *r, bool *special);

#endif
