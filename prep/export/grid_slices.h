/* grid_slices.h - streams the samples of a part of a treelet file's grid: x fastest, then y, then
 * z.
 *
 * Treelets are read a layer at a time, by many threads, into a slab of as many slices as fit the
 * budget. If less than a layer fits, its treelets are read several times.
 */
#ifndef PREP_EXPORT_GRID_SLICES_H
#define PREP_EXPORT_GRID_SLICES_H

#include <stddef.h>

#include "formats/base/progress.h"
#include "prep/export/grid_part.h"

/* Receives the next `count` samples, of the file's stored type. */
typedef status (*grid_slices_take)(void *ctx, const void *samples, size_t count);

/* grid_slices_run() - hand over all samples of the part in order. ST_NOMEM names the smallest
 * budget that would do (m's limit; 0: none). p may be NULL. */
CHECKED status grid_slices_run(mem *m, leaf_file *f, const grid_part *part, int threads,
                               const progress *p, grid_slices_take take, void *ctx);

#endif
