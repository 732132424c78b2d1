/* grid_pieces.h - the pieces of many rays through a grid: the kind's kernel of segment_batch.h.
 *
 * A few rays are under way at a time, each through one treelet after the other. There, the planes
 * of each axis are crossed in order of t; where a crossing stands among those of the other axes is
 * how many of theirs come before it: looked up for a vector of crossings at a time. That sorts
 * them, and tells which cell lies behind each; only layers of blocks are looked at in which some
 * cell is active. Nodes that are taken whole (block_way.h) part a way into stretches. Cells with a
 * bit in the treelet's masks, between crossings of different t, are the pieces that grid_segments()
 * finds; their values are computed as many at a time as a vector has doubles.
 */
#ifndef RENDER_GRID_GRID_PIECES_H
#define RENDER_GRID_GRID_PIECES_H

#include "formats/base/cpu.h"
#include "render/ray/segment_batch.h"

/* What such a kernel needs. */
enum { GRID_PIECES_SCRATCH = 96 << 10 };

/* By ISA; scalar, NULL: every ray by itself. */
extern const segment_batch_fn grid_pieces_kernels[CPU_ISAS];

#endif
