/* grid_pieces.h - the pieces of many rays through a grid: the kind's kernel of segment_batch.h.
 *
 * A few rays are under way at a time, each through one treelet after the other. In a treelet, the
 * planes of each axis are crossed in order of t. A crossing's place among the crossings of all axes
 * follows from how many of each other axis come before it: looked up for a vector of crossings at a
 * time. That sorts the crossings, and tells which cell lies behind each. Only layers of blocks with
 * an active cell are looked at. Nodes that are taken whole (block_way.h) part a way into stretches.
 * The pieces that grid_segments() finds are the cells with a bit in the treelet's masks, between
 * crossings of different t. Their values are computed as many at a time as a vector has doubles.
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
