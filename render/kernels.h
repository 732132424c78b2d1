/* kernels.h - the table of kernels, filled by what the CPU can do.
 *
 * Scalar versions are the truth; the others give the same bits.
 */
#ifndef RENDER_KERNELS_H
#define RENDER_KERNELS_H

#include "render/experiments/stepping_batch.h"
#include "render/grid/cell_batch.h"
#include "render/grid/grid_batch.h"
#include "render/grid/grid_peaks.h"
#include "render/grid/grid_pieces.h"
#include "render/grid/grid_tile.h"
#include "render/grid/walk.h"
#include "render/medium/medium_batch.h"
#include "render/mesh/mesh_batch.h"
#include "render/mesh/mesh_packet.h"
#include "render/mesh/mesh_tile.h"
#include "render/mesh/tet_batch.h"

typedef struct kernels {
    const char *name;
    cpu_isa isa;
    walk_fn grid_walk;            /* one ray through one treelet */
    cell_batch_fn cells;          /* many ray-cells: the first surface of each, */
    cell_roots_fn roots;          /* or all of them */
    tile_fn grid_tile;            /* a tile of primary rays through a grid; NULL: one by one */
    batch_fn grid_batch;          /* rays of any kind through a grid; NULL: one by one */
    segment_batch_fn grid_pieces; /* pieces of rays through a grid; NULL: ray by ray */
    extreme_batch_fn grid_peaks;  /* greatest values on rays through a grid; NULL: ray by ray */
    tile_fn mesh_tile;            /* ... through a mesh */
    tile_fn mesh_packet;          /* ... the way of W07 */
    tet_batch_fn tets;            /* many rays and an isopolygon */
    batch_fn mesh_batch;          /* a batch of rays through a mesh; NULL: one by one */
    medium_batch_fn medium;       /* many pieces of a medium */
    stepping_batch_fn stepping;   /* ... in equal steps */
    uint8_t packet; /* pixels on a side that walk together: GRID_TILE, or less of it */
    bool by_cell;   /* a batch never holds ray-cells of more than one cell */
} kernels;

/* kernels_for() - NULL or "auto" for the best there is, or a name: that of an ISA, or of one of
 * the alternatives of experiments E1 and E4. False where this build or this CPU has no such
 * kernels. */
bool kernels_for(const char *name, kernels *out);

/* kernels_in_use() - those of an open volume, for experiments and tests to change. */
kernels *kernels_in_use(leafcast *volume);

#endif
