/* grid_pieces.h - the pieces of many rays through a grid: the kind's kernel of segment_batch.h.
 *
 * A few rays are under way at a time, each through one treelet after the other. In a treelet, the
 * crossings with the planes of one axis are sorted by t already. To merge the three axes, count for
 * each crossing how many crossings of the other axes come before it, a vector at a time. The sum is
 * its place, and the counts give the cell behind it. Only layers of blocks with an active cell are
 * looked at. Nodes that are taken whole (block_way.h) divide a way into stretches. A piece is a
 * cell with a bit in the treelet's masks, between crossings of different t, as in grid_segments().
 * Values are computed with vectors of doubles.
 */
#ifndef RENDER_GRID_GRID_PIECES_H
#define RENDER_GRID_GRID_PIECES_H

#include "formats/base/cpu.h"
#include "render/ray/segment_batch.h"

/* Bytes of scratch that the kernel needs. */
enum { GRID_PIECES_SCRATCH = 96 << 10 };

/* By ISA. The scalar entry is NULL: every ray walks alone. */
extern const segment_batch_fn grid_pieces_kernels[CPU_ISAS];

#endif
