/* mesh_tile.h - traces the primary rays of 32 x 32 pixels through a mesh together, up to the last
 * surface that counts: the counterpart of grid/grid_tile.h.
 *
 * The tree over the treelets, and the trees in them, are walked once for all rays of a tile, near
 * children first. A node carries the rectangle of pixels that its box can cover (projection.h). It
 * is dropped when the rectangle is empty, or when every pixel in it has its surfaces in front of
 * the box. Active tets whose isopolygons may cover a pixel's centre are made into isopolygons (W07
 * 4.1), a vector of tets at a time. Seen from the eye, an edge function is one vector an edge, and
 * its value for a ray is a scalar product. Where the signs are sure, vectors of rays are decided;
 * all others go to tet_kernel.h. So the picture has the same bits as with single rays.
 *
 * Deviation from W07 5.2, whose packets test one ray, then intervals, then all rays against a box:
 * a rectangle is tighter than intervals of directions, and a box costs the same whether one ray or
 * 256 look at it.
 */
#ifndef RENDER_MESH_MESH_TILE_H
#define RENDER_MESH_MESH_TILE_H

#include "render/frame/tile.h"

/* MESH_TILE: pixels on a side; render/README.md says why. MESH_TILE_SCRATCH: bytes that a tile_fn
 * needs beside its outcome. */
enum { MESH_TILE = 32, MESH_TILE_SCRATCH = 768 << 10 };

/* By ISA. Scalar: NULL, so each ray is traced by itself. */
extern const tile_fn mesh_tile_kernels[CPU_ISAS];

#endif
