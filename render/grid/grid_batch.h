/* grid_batch.h - rays of any origins and directions through a grid together: the kind's kernel of
 * ray_batch.h.
 *
 * Rays of one octant of directions pass the children of a node in one order. So they walk the
 * directory and the treelets' trees together. Each node has a set of rays: their own intervals, in
 * single precision and widened, meet it. Neighbours lie beside each other in vectors. In a block of
 * 4^3 cells, each vector of rays is tested against the active cells, in the rays' order. The
 * ray-cells are collected and filtered in single precision. Those that may meet the surface go to
 * the cell kernel together (cell_batch.h), whose answer is the same as for single rays.
 *
 * Rays with a direction component of 0, as towards a light along an axis, walk with the others. In
 * cells with a plane too near to them they use the scalar kernel (CELL_ALONG). Single rays take
 * over at absent treelets and for states blocked at one, for directions with a component that is
 * nearly zero, and in previews.
 */
#ifndef RENDER_GRID_GRID_BATCH_H
#define RENDER_GRID_GRID_BATCH_H

#include "formats/base/cpu.h"
#include "render/ray/ray_batch.h"

/* Bytes of scratch that a batch_fn of a grid needs. */
enum { GRID_BATCH_SCRATCH = 80 << 10 };

/* By ISA. The scalar entry is NULL: every ray walks alone. */
extern const batch_fn grid_batch_kernels[CPU_ISAS];

#endif
