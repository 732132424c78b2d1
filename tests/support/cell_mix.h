/* cell_mix.h - small meshes of hexahedra, wedges, pyramids and tets that share bent faces: the
 * grids of hex_lab.h, some of whose cells are cut.
 */
#ifndef TESTS_SUPPORT_CELL_MIX_H
#define TESTS_SUPPORT_CELL_MIX_H

#include "formats/base/cell_shape.h"
#include "tests/support/hex_lab.h"

enum { CELL_MIX_CELLS = HEX_LAB_CELLS * HEX_LAB_CELLS * HEX_LAB_CELLS * 10 };

typedef struct cell_mix_cell {
    cell_shape shape;
    double p[HEX_CORNERS][3], value[HEX_CORNERS]; /* of its vertices */
    unsigned sides[HEX_CORNERS];                  /* of the whole mesh on which a vertex is: bits */
} cell_mix_cell;

typedef struct cell_mix {
    hex_lab lab;
    int count;
    cell_mix_cell cell[CELL_MIX_CELLS];
} cell_mix;

/* cell_mix_make() - of hex_lab number `index`. In every other column along the third axis cells are
 * cut in two wedges, and some wedges in three pyramids and two tets; of the other cells, some are
 * cut in six pyramids. */
void cell_mix_make(cell_mix *m, int index, uint64_t seed);

/* cell_mix_whole() - all of a grid's hexahedra, none of them cut. */
void cell_mix_whole(cell_mix *m, const hex_lab *s);

/* cell_mix_hexahedron() - a cell as a hexahedron, its corners turned about the `turn`-th way that
 * leaves its shape: so cells may collapse anywhere. turn: 0 to 47. */
hexahedron cell_mix_hexahedron(const cell_mix_cell *c, int turn);

/* cell_mix_outside() - whether parameters of such a hexahedron are on the mesh's boundary. */
bool cell_mix_outside(const cell_mix_cell *c, int turn, const double at[3]);

#endif
