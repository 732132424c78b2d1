/* resample.h - resamples a mesh, or a curvilinear grid, on a regular grid of floats, out of core.
 *
 * It is a treelet file. Its treelets can be read in any order and hold all their nodes. The regular
 * grid is made one slab of rows at a time. Treelets that reach into the slab are read, some at a
 * time, and drawn into it by many threads. A node's value is interpolated in the cell that holds it
 * (resample_cells.h). If several do (a mesh that overlaps itself), the first in the file's order
 * counts. If none does, it is NaN. So the samples depend on the file and the grid alone.
 */
#ifndef PREP_RESAMPLE_RESAMPLE_H
#define PREP_RESAMPLE_RESAMPLE_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/progress.h"
#include "formats/base/status.h"
#include "formats/grid/grid.h"
#include "formats/leaf/leaf_file.h"
#include "prep/resample/resample_block.h"

/* The grid asked for; zero = not given. */
typedef struct resample_wish {
    uint32_t dims[3]; /* all three; or the first alone: nodes along the longest edge of the box */
    double spacing;   /* instead of dims */
    bool bounded;     /* box is given; else use the mesh's */
    double box[6];    /* lo x y z, hi x y z */
    uint64_t nodes;   /* if dims and spacing are not given: most nodes, but at least 2 per axis */
} resample_wish;

/* resample_grid_choose() - choose the grid over the box. It begins at the lower corner. No node
 * lies beyond the upper one unless the spacing exceeds the box. *out: the same as a grid of floats.
 * bounds: of the mesh. ST_UNSUPPORTED: the box has no extent along an axis, or the grid is too
 * large or finer than doubles. */
CHECKED status resample_grid_choose(const resample_wish *wish, const float bounds[6],
                                    const char *name, resample_grid *g, grid *out);

typedef struct resample_options {
    uint32_t set;    /* of values; vertices are at its step's positions */
    uint64_t memory; /* budget in bytes, including all that m has in use */
    int threads;
} resample_options;

typedef struct resample_result {
    uint64_t nodes, held; /* held: nodes inside a cell */
    uint64_t slabs;       /* passes over the treelets */
    uint64_t bytes_read;
} resample_result;

/* Receives the next `count` samples, x fastest. */
typedef status (*resample_take)(void *ctx, const float *samples, size_t count);

/* resample_run() - hand over all samples of g in order. f: one that has resample_cells. ST_NOMEM
 * names the smallest budget that would do. p may be NULL. */
CHECKED status resample_run(mem *m, leaf_file *f, const resample_grid *g, const resample_options *o,
                            const progress *p, resample_take take, void *ctx,
                            resample_result *result);

#endif
