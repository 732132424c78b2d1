/* triangle_tile.h - traces the primary rays of 32 x 32 pixels through triangles together, up to the
 * last surface that counts: as mesh/mesh_tile.h does, but the polygons are there already.
 */
#ifndef RENDER_TRIANGLE_TRIANGLE_TILE_H
#define RENDER_TRIANGLE_TRIANGLE_TILE_H

#include "render/frame/tile.h"

/* TRIANGLE_TILE: pixels on a side. TRIANGLE_TILE_SCRATCH: bytes that a tile_fn needs beside its
 * outcome. */
enum { TRIANGLE_TILE = 32, TRIANGLE_TILE_SCRATCH = 768 << 10 };

/* By ISA. Scalar: NULL, so each ray is traced by itself. */
extern const tile_fn triangle_tile_kernels[CPU_ISAS];

#endif
