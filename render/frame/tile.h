/* tile.h - kernels that trace the primary rays of a square of pixels together: their input and
 * outcome. They find all surfaces that count (the tiles of each kind: grid/grid_tile.h,
 * mesh/mesh_tile.h, curvilinear/curvilinear_tile.h, mixed/mixed_tile.h).
 *
 * All these rays start at the eye, so one order of nodes is front to back for all of them. The tree
 * is walked once per tile. Each node has the rectangle of pixels that it can cover (projection.h).
 * A node is dropped when the rectangle is empty, or all its pixels have their surfaces. So empty
 * space and hidden nodes cost nothing more. The picture equals the one by single rays, to the bit.
 *
 * Two cases are left to single rays: rays that meet an absent treelet, and directions with a
 * component that is nearly, but not exactly, zero.
 */
#ifndef RENDER_FRAME_TILE_H
#define RENDER_FRAME_TILE_H

#include "render/frame/frame.h"
#include "render/ray/ray_kernels.h"

/* One bit for each pixel of a tile's row. */
typedef uint32_t tile_row;

/* The most treelets that a tile reports as absent at a time. */
enum { TILE_ABSENT_MAX = 32 };

/* A treelet of the first volume that rays need on a leg of their way (see integrator.h). */
typedef struct tile_treelet {
    uint32_t t;
    uint16_t leg;
} tile_treelet;

/* What a kernel leaves to do, row by row of the tile. All other pixels that were asked for are
 * written. */
typedef struct tile_outcome {
    /* The caller's room, since stacks may be small: kind_tiles.scratch bytes, 64-byte aligned; */
    void *scratch;
    ray_batch *batch;        /* for rays behind the first surfaces, */
    void *batch_scratch;     /* and the largest kind_batches.scratch of all volumes,
                                and of what stands in for them */
    tile_row open[TILE_MAX]; /* pixels to be traced one by one, from their start */
    tile_row
        waits[TILE_MAX]; /* pixels that met an absent treelet: try again with it, or one by one */
    tile_treelet absent[TILE_ABSENT_MAX]; /* the absent treelets, as many as fit */
    int absent_count;
    /* Given, and left for the next try: where the walk begins. No pixel asked for needs a treelet
     * that comes before this one, front to back. 0: it begins at the root, as always of kinds that
     * do not set it. */
    uint32_t first;
} tile_outcome;

/* A tile_fn (ray_kernels.h) traces rays of the tile whose first pixel is (x0, y0): the set bits of
 * pixels[], a tile_row each. f->projection must be usable. */

/* tile_absent() - note that rays met treelet t, which is absent. */
static inline void tile_absent(tile_outcome *out, uint32_t t, uint16_t leg) {
    for (int i = 0; i < out->absent_count; i++)
        if (out->absent[i].t == t && out->absent[i].leg == leg)
            return;
    if (out->absent_count < TILE_ABSENT_MAX)
        out->absent[out->absent_count++] = (tile_treelet){t, leg};
}

#endif
