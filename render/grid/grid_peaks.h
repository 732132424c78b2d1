/* grid_peaks.h - the greatest, or the least, values on many rays through a grid: the kind's kernel
 * of extreme_batch.h.
 *
 * Rays of one octant of directions climb together, best first: subtrees of the directory by falling
 * bound, of equal ones those that the rays come to first; in a treelet's tree, the best child
 * first. With each node goes the set of rays that meet it, by their own intervals in single
 * precision and widened, and that have found less than its bound. Rays that meet a block of 4^3
 * cells are packed side by side. The greatest samples of its groups of 2^3 cells, the best first,
 * and of its cells are compared with what the rays have found. Ray-cells that are left are
 * collected: first bounded by their control values, in single precision and proven, then computed,
 * as many at a time as a vector has doubles, operation by operation as grid_extreme_cell() does.
 *
 * Left to single rays: directions with a component that is all but zero; previews; those for which
 * the list of subtrees has no room.
 */
#ifndef RENDER_GRID_GRID_PEAKS_H
#define RENDER_GRID_GRID_PEAKS_H

#include "formats/base/cpu.h"
#include "render/ray/extreme_batch.h"

/* What such a kernel needs. */
enum { GRID_PEAKS_SCRATCH = 128 << 10 };

/* By ISA; scalar, NULL: every ray by itself. */
extern const extreme_batch_fn grid_peaks_kernels[CPU_ISAS];

#endif
