/* resample.h - a tetrahedral mesh to a regular grid of floats, out of core.
 *
 * The mesh is a treelet file, whose treelets can be read in any order and hold all their vertices.
 * The grid is made a slab of rows at a time: those treelets that reach into it are read, some at a
 * time, and drawn into it by many threads. A node's value is the linear interpolation in the tet
 * that holds it (tet_value.h); of several (a mesh that overlaps itself), in the first in the file's
 * order; NaN in none. So the samples depend on mesh and grid alone.
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

/* What the grid is to be; zero = not given. */
typedef struct resample_wish {
    uint32_t dims[3]; /* all, or the first alone: nodes along the longest edge of the box */
    double spacing;   /* instead of dims */
    bool bounded;     /* box is given; else the mesh's */
    double box[6];    /* lo x y z, hi x y z */
    uint64_t nodes;   /* without dims and spacing: at most so many, but 2 an axis at least */
} resample_wish;

/* resample_grid_choose() - the grid over the box: from its lower corner on, no node beyond the
 * upper one unless the spacing is larger than the box; *out the same as a grid of floats. bounds:
 * the mesh's. ST_UNSUPPORTED for a box without extent along an axis, and for grids that are too
 * large or finer than doubles. */
CHECKED status resample_grid_choose(const resample_wish *wish, const float bounds[6],
                                    const char *name, resample_grid *g, grid *out);

typedef struct resample_options {
    uint32_t set;    /* of values; vertices are where its step has them */
    uint64_t memory; /* budget in bytes, all that m has in use included */
    int threads;
} resample_options;

typedef struct resample_result {
    uint64_t nodes, held; /* held: by a tet */
    uint64_t slabs;       /* how often treelets were gone through */
    uint64_t bytes_read;
} resample_result;

/* Where samples go: the next `count`, x fastest. */
typedef status (*resample_take)(void *ctx, const float *samples, size_t count);

/* resample_run() - all of g, handed over in order. f: a mesh. ST_NOMEM names the smallest budget
 * that would do. p may be NULL. */
CHECKED status resample_run(mem *m, leaf_file *f, const resample_grid *g, const resample_options *o,
                            const progress *p, resample_take take, void *ctx,
                            resample_result *result);

#endif
