/* grid_batch.h - rays of any origins and directions through a grid together: the kind's kernel of
 * ray_batch.h.
 *
 * Rays of one octant of directions pass the children of a node in one order. So they walk the
 * directory and the treelets' trees together, with a set of rays at each node: those whose own
 * intervals, in single precision and widened, meet it. Neighbours lie beside each other in vectors.
 * A block of 4^3 cells is taken at once: each vector of rays is tested against its active cells, in
 * the rays' order. The ray-cells wait, are filtered in single precision, and those that may meet
 * the surface go to the cell kernel together (cell_batch.h), whose answer is the same as for single
 * rays.
 *
 * Rays with a component of 0, as towards a light along an axis, walk along, and ask the scalar
 * kernel of cells where that is too near to a plane (CELL_ALONG). Left to single rays: those that
 * meet an absent treelet, or go on from one; directions with a component that is all but zero;
 * previews.
 */
#ifndef RENDER_GRID_GRID_BATCH_H
#define RENDER_GRID_GRID_BATCH_H

#include "formats/base/cpu.h"
#include "render/ray/ray_batch.h"

/* What a batch_fn of a grid needs. */
enum { GRID_BATCH_SCRATCH = 80 << 10 };

/* By ISA; scalar, NULL: every ray by itself. */
extern const batch_fn grid_batch_kernels[CPU_ISAS];

#endif
