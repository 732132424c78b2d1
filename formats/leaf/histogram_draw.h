/* histogram_draw.h - which nodes or tets a histogram samples, and what it measures there.
 *
 * Grid: the nodes are cut into blocks of step^3, with the smallest step that gives at most
 * HISTOGRAM_DRAWS blocks. One node is drawn from each block, at a place given by a hash of the
 * block's index (so that periodic data causes no bias). Mesh: likewise, with runs of `step` tets in
 * the order of the file. With a step of 1 everything is drawn.
 *
 * FORMAT.md gives the hash. All functions are pure.
 */
#ifndef FORMATS_LEAF_HISTOGRAM_DRAW_H
#define FORMATS_LEAF_HISTOGRAM_DRAW_H

#include <stddef.h>
#include <stdint.h>

#include "formats/base/sample.h"
#include "formats/leaf/histogram.h"

typedef struct histogram_draw {
    uint32_t dims[3];
    uint32_t step;
    uint32_t blocks[3];
    uint32_t count; /* number of blocks: the length of the array of cells */
} histogram_draw;

/* histogram_draw_grid() - for a grid of these nodes. */
histogram_draw histogram_draw_grid(const uint32_t dims[3]);

/* histogram_draw_node() - the node that is drawn from a block x, y, z; returns the block's
 * index. */
uint32_t histogram_draw_node(const histogram_draw *d, const uint32_t block[3], uint32_t node[3]);

/* Lengths and volumes of a grid's cells. */
typedef struct histogram_space {
    double inverse[3][3];  /* inverse of the linear part of to_world */
    double volume;         /* of a cell of 1 x 1 x 1 in grid space */
    const double *axis[3]; /* coordinates of the nodes in grid space; NULL: 0, 1, 2, .. */
} histogram_space;

/* histogram_space_of() - to_world: double[12], row-major 3x4, invertible. axis[] is NULL then. */
histogram_space histogram_space_of(const double *to_world);

/* Samples of a box of nodes. Nodes [first, end) are drawn from. Samples begin at node `first`; they
 * include one more node on each axis, unless that is the grid's end. */
typedef struct histogram_block {
    uint32_t first[3], end[3];
    sample_type type; /* a stored one */
    const void *samples;
    size_t row, slice; /* samples from one row to the next, from one slice to the next */
} histogram_block;

/* histogram_draw_take() - measure all nodes that are drawn from the block. cells: d->count of them;
 * exactly one call writes each. */
void histogram_draw_take(const histogram_draw *d, const histogram_space *s,
                         const histogram_block *b, histogram_cell *cells);

/* Runs of a mesh's tets: run i has the tets i * step .. i * step + step - 1, as far as they
 * exist. */
typedef struct histogram_run {
    uint64_t total, step;
    uint32_t count; /* number of runs */
} histogram_run;

/* histogram_draw_tets() - the runs for a mesh of `total` tets with `sets` sets of values: at most
 * HISTOGRAM_TETS / sets of them, but at least one. */
enum { HISTOGRAM_TETS = 1 << 16 };
histogram_run histogram_draw_tets(uint64_t total, uint32_t sets);

/* histogram_draw_tet() - the tet that is drawn from run i. */
uint64_t histogram_draw_tet(const histogram_run *r, uint32_t i);

/* histogram_tet() - measure a tet with these corners and values. histogram_hex() - a hexahedron, by
 * the gradient and the volume in its middle; corners as of formats/base/hexahedron.h. */
enum { HISTOGRAM_CORNERS = 8 };
histogram_cell histogram_tet(const float *const corners[4], const float values[4]);
histogram_cell histogram_hex(const float *const corners[HISTOGRAM_CORNERS],
                             const float values[HISTOGRAM_CORNERS]);

#endif
