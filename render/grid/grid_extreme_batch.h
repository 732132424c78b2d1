/* grid_extreme_batch.h - the greatest, or the least, values on many rays through a grid: the kind's
 * kernel of extreme_batch.h.
 *
 * Rays of one octant of directions search together, best first. Subtrees of the directory come by
 * falling bound, equal ones in the rays' order. In a treelet's tree the best child comes first.
 * Each node has a set of rays: rays that meet it, by widened intervals in single precision, and to
 * which its bound matters. In a block of 4^3 cells, its rays are packed side by side. Their scores
 * are compared with the greatest sample of each group of 2^3 cells, the best group first, and then
 * of each cell. For the remaining ray-cells, control values give a proven bound, in single
 * precision. What still matters is computed with vectors of doubles, operation by operation as in
 * grid_extreme_cell().
 *
 * Single rays take over for directions with a component that is nearly zero, in previews, and where
 * the list of subtrees has no room.
 */
#ifndef RENDER_GRID_GRID_EXTREME_BATCH_H
#define RENDER_GRID_GRID_EXTREME_BATCH_H

#include "formats/base/cpu.h"
#include "render/ray/extreme_batch.h"

/* Bytes of scratch that the kernel needs. */
enum { GRID_EXTREME_BATCH_SCRATCH = 128 << 10 };

/* By ISA. The scalar entry is NULL: every ray searches alone. */
extern const extreme_batch_fn grid_extreme_batch_kernels[CPU_ISAS];

#endif
