/* mixed_corner_coder.h - the corners of a mixed mesh's cells, and where its nodes are, as streams,
 * for mixed_coder.c.
 *
 * Nodes are numbered in the order in which cells use them first, so a node that is new needs no
 * name. Any other is one of the cell's own; or at the end of an edge, where an earlier cell had an
 * edge from the same node along the same axis; or one of the last MIXED_LAST corners; or far. Each
 * corner has a code:
 *
 *   0          a new node: the next one
 *   1, 2, 3    the end of the last edge that began in the cell's corner before on axis x, y, z
 *   4 .. 10    the node of corner 0 .. 6 of the same cell
 *   11 .. 254  a corner of a cell before: 11 is that cell's corner 7, 12 its corner 6, ..
 *   255        any other: a word says how many nodes have come since
 *
 * The last edges are kept for MIXED_EDGES nodes, by the lowest bits of their numbers.
 *
 * A new node is predicted from those of its cell that are there already (mixed_corner_coder.c:
 * guess_from()).
 */
#ifndef FORMATS_LEAF_MIXED_CORNER_CODER_H
#define FORMATS_LEAF_MIXED_CORNER_CODER_H

#include <stdbool.h>

#include "formats/leaf/coded_streams.h"
#include "formats/leaf/mixed_geometry.h"

enum {
    MIXED_NEW = 0,
    MIXED_EDGE = 1,
    MIXED_OWN = 4,
    MIXED_EARLIER = 11,
    MIXED_FAR = 255,
    MIXED_LAST = MIXED_FAR - MIXED_EARLIER,
    MIXED_EDGES = 4096
};

/* mixed_corners_room() - returns the most bytes of all streams. */
size_t mixed_corners_room(const mixed_shape *s);

/* mixed_corners_encode() - encode corners and coordinates of a topology. False: its nodes are not
 * numbered in the order in which they are used first. scratch: a word for each corner.
 * mixed_corners_decode() - fill in both. All of `in` is theirs. False: it is malformed. */
bool mixed_corners_encode(const mixed_shape *s, const void *topology, void *scratch,
                          coded_streams *out);
bool mixed_corners_decode(const mixed_shape *s, coded_input *in, void *topology);

#endif
