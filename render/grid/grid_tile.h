/* grid_tile.h - the primary rays of 32 x 32 pixels through a grid together, up to the last surface
 * that counts.
 *
 * The implicit octree is walked once for all rays of a tile (tile.h). At an active cell the rays of
 * its rectangle are tested in single precision, conservatively. Rays that may meet the surface are
 * collected over several cells and go to the cell kernel together (cell_batch.h), whose answer is
 * the same as for single rays.
 */
#ifndef RENDER_GRID_GRID_TILE_H
#define RENDER_GRID_GRID_TILE_H

#include "render/frame/tile.h"

/* Pixels on a side (tests/measurements/tiles.md), and bytes of scratch that a tile_fn needs beside
 * its outcome. */
enum { GRID_TILE = 32, GRID_TILE_SCRATCH = 640 << 10 };

/* By ISA. The scalar entry is NULL: every ray walks alone. */
extern const tile_fn grid_tile_kernels[CPU_ISAS];

#endif
