/* heights_tile.h - the primary rays of 32 x 32 pixels over terrain together.
 *
 * The directory's quadtree is walked once for all rays of a tile, nearest treelets first; each has
 * the rectangle of pixels that it can cover. In a treelet a lane takes a ray, in single precision,
 * to the cells that it may meet (heights_ways_template.h); the kernel takes a lane for each of
 * those (heights_roots_template.h). Ways that single precision leaves in doubt go as single rays do
 * (heights_way.h). So the picture has the same bits.
 */
#ifndef RENDER_HEIGHTS_HEIGHTS_TILE_H
#define RENDER_HEIGHTS_HEIGHTS_TILE_H

#include "render/frame/tile.h"

/* HEIGHTS_TILE: pixels on a side. HEIGHTS_TILE_SCRATCH: bytes that a tile_fn needs beside its
 * outcome. */
enum { HEIGHTS_TILE = 32, HEIGHTS_TILE_SCRATCH = 1088 << 10 };

#endif
