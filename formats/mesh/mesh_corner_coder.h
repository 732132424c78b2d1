/* mesh_corner_coder.h - the tets and positions of a topology as streams, for mesh_topology_coder.c.
 *
 * Coder and decoder keep a list of the last MESH_RECENT vertices that tets have used, latest first.
 * Each corner of a tet has a code:
 *
 *   1 .. MESH_RECENT  a vertex of the list. The first corner's code is its place, counted from 1; a
 *                     later one's is the distance from the place of the corner before. Corners in
 *                     the list come first, by ascending places
 *   255               a vertex that has been used, but is not in the list; a word names it
 *   0                 a vertex used for the first time; a word names it, and its position follows
 *
 * After each tet its four vertices move to the front of the list, the first corner foremost.
 *
 * A word is the vertex less a base vertex, folded (0, -1, 1, .. become 0, 1, 2, ..). A position is
 * the difference from the base's (float_planes.h). The base is the tet's first corner; of the first
 * corner itself, the vertex that has last been coded by 0. Before there is one, vertex 0 at 0 0 0.
 *
 * The streams:
 *
 *   0      u8 code[3][tets]              of the first three corners
 *   1      u8 code[tets]                 of the last one
 *   2 - 5  u8 plane[4][3][vertices]      of positions, by axis, in the order of first use
 *   6, 7   u8 low[words], high[words]    of all words, tet after tet and corner after corner
 */
#ifndef FORMATS_MESH_MESH_CORNER_CODER_H
#define FORMATS_MESH_MESH_CORNER_CODER_H

#include <stdbool.h>

#include "formats/leaf/coded_streams.h"
#include "formats/mesh/mesh_leaf.h"

enum { MESH_RECENT = 254, MESH_CORNER_NEW = 0, MESH_CORNER_FAR = 255 };

/* mesh_corners_room() - returns the most bytes of all streams.
 * mesh_corners_scratch() - returns the bytes of scratch that mesh_corners_encode() needs. */
size_t mesh_corners_room(const mesh_shape *s);
size_t mesh_corners_scratch(const mesh_shape *s);

/* mesh_corners_encode() - encode tets and positions of a topology. Returns false if a tet's
 * vertices do not ascend or are out of range, or if there are vertices without a tet.
 * mesh_corners_decode() - fill in tets and positions. All of `in` is theirs. Returns false if it is
 * malformed. Positions are 0 before. */
bool mesh_corners_encode(const mesh_shape *s, const void *topology, uint8_t *scratch,
                         coded_streams *out);
bool mesh_corners_decode(const mesh_shape *s, coded_input *in, void *topology);

#endif
