/* marching_table.h - triangles of an isosurface in a cell of eight samples, between the edges that
 * it crosses.
 *
 * On each face, crossings are joined as in the bilinear interpolant of the face's four samples. If
 * all four edges are crossed, the sign at the saddle decides (the asymptotic decider). This depends
 * on the face alone, so two cells that share it agree. The segments of all faces make closed loops
 * of edges. Each loop becomes triangles whose inner sides join no two edges of one face. So a side
 * in a face belongs to one triangle in each of the two cells, and any other side to two triangles
 * of this cell. There are no gaps, and no side of more than two triangles. A few loops (116 of 1026
 * in all cases) have no such triangles. They get a corner inside the cell, a centre, joined to all
 * their edges.
 *
 * Corner i of a cell is at (i & 1, i >> 1 & 1, i >> 2 & 1). Edges are numbered by axis: 4 a + n
 * runs along axis a from the n-th corner that is 0 on that axis. Face 2 a + s is at s on axis a.
 */
#ifndef PREP_EXPORT_MARCHING_TABLE_H
#define PREP_EXPORT_MARCHING_TABLE_H

#include <stdint.h>

enum { MARCHING_EDGES = 12, MARCHING_CENTRES = 4, MARCHING_TRIANGLES = 12, MARCHING_CASES = 656 };

typedef struct marching_case {
    uint8_t triangles, centres;
    /* Edges, or MARCHING_EDGES + a centre's number; counterclockwise as seen from outside, in a
     * right-handed cell. */
    uint8_t corner[MARCHING_TRIANGLES][3];
} marching_case;

typedef struct marching_table {
    uint8_t edge[MARCHING_EDGES][2]; /* corners; the second is one further along the axis */
    uint8_t face[6][4];              /* corners around it */
    uint8_t undecided[256]; /* by mask of corners inside: a bit for each face with four crossings */
    uint16_t first[256]; /* first case of a mask: add one bit per undecided face, in order; 1: the
                            corners inside are joined */
    marching_case cases[MARCHING_CASES];
} marching_table;

/* marching_table_init() - takes well under a millisecond. */
void marching_table_init(marching_table *t);

#endif
