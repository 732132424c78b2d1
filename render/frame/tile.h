/* tile.h - the primary rays of a square of pixels through a volume together, up to the last surface
 * that counts: what a kernel takes and what it leaves (grid/grid_tile.h, mesh/mesh_tile.h).
 *
 * All of them start at the eye, so one order of nodes is front to back for them all. The tree is
 * walked once a tile: every node carries the rectangle of pixels that it can cover (projection.h),
 * and goes when that is empty or all its pixels have their surfaces: empty space and what is hidden
 * cost nothing more. The picture is the same bits as that of single rays.
 *
 * What single rays do better or alone stays with them: rays that meet a treelet which is absent,
 * and directions with a component that is all but zero.
 */
#ifndef RENDER_FRAME_TILE_H
#define RENDER_FRAME_TILE_H

#include "render/frame/frame.h"
#include "render/ray/ray_kernels.h"

/* Pixels on a side of a kind's tiles, at most. */
enum { TILE_MAX = 32 };

/* Pixels of a tile's row, a bit each. */
typedef uint32_t tile_row;

/* Treelets that a tile is told to wait for at a time. */
enum { TILE_ABSENT_MAX = 32 };

/* A treelet of the first volume that rays need on a leg of their way (see integrator.h). */
typedef struct tile_treelet {
    uint32_t t;
    uint16_t leg;
} tile_treelet;

/* What is left to do. Rows and rays of the tile that there is, rays row by row. All other pixels
 * that were asked for have been written. */
typedef struct tile_outcome {
    /* Room of the caller's, since stacks may be small: kind.tile_scratch bytes, 64-byte aligned; */
    void *scratch;
    ray_batch *batch;         /* for rays behind the first surfaces, */
    void *batch_scratch;      /* and kind.batch_scratch bytes of whichever volume needs most */
    tile_row open[TILE_MAX];  /* to be traced one by one, from their start */
    tile_row waits[TILE_MAX]; /* met an absent treelet: again with it, or one by one */
    tile_treelet absent[TILE_ABSENT_MAX]; /* those treelets, as many as there is room for */
    int absent_count;
} tile_outcome;

/* A tile_fn (ray_kernels.h) takes rays of the tile whose first pixel is (x0, y0), those of
 * pixels[], a tile_row each; f->projection must be usable. */

/* tile_absent() - rays met treelet t, which is absent. */
static inline void tile_absent(tile_outcome *out, uint32_t t, uint16_t leg) {
    for (int i = 0; i < out->absent_count; i++)
        if (out->absent[i].t == t && out->absent[i].leg == leg)
            return;
    if (out->absent_count < TILE_ABSENT_MAX)
        out->absent[out->absent_count++] = (tile_treelet){t, leg};
}

#endif
