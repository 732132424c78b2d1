/* mesh_tile.h - the primary rays of 32 x 32 pixels through a mesh together, up to the last
 * surface that counts: what grid/grid_tile.h is for grids.
 *
 * The tree over the treelets, and the trees in them, are walked once for all rays of a tile, near
 * children first. A node carries the rectangle of pixels that its box can cover (projection.h), and
 * goes when that is empty or every pixel of it has its surfaces in front of the box. Active tets
 * whose isopolygons may cover a pixel's centre are made isopolygons (W07 4.1), a vector of them at
 * a time, and seen from the eye by the rays that they may cover: an edge function is one vector an
 * edge then, and each ray's is a scalar product. Where their signs are sure, vectors of rays are
 * done with; the others go to tet_kernel.h. So the picture is the same bits as that of single rays.
 *
 * Deviation from W07 5.2, whose packets test one ray, then intervals, then all rays against a box:
 * a rectangle is tighter than intervals of directions, and a box costs the same whether one ray or
 * 256 look at it.
 */
#ifndef RENDER_MESH_MESH_TILE_H
#define RENDER_MESH_MESH_TILE_H

#include "render/frame/tile.h"

/* Pixels on a side: render/README.md says why. What a tile_fn needs beside its outcome. */
enum { MESH_TILE = 32, MESH_TILE_SCRATCH = 768 << 10 };

/* By ISA; scalar, NULL: every ray by itself. */
extern const tile_fn mesh_tile_kernels[CPU_ISAS];

#endif
