/* mesh_tetgen.h - TetGen's `F.node` and `F.ele`: the path of either opens both.
 *
 * Points: `count 3 attributes markers`, then a line each: `id x y z [attributes] [marker]`. Tets:
 * `count 4 attributes`, then `id a b c d [attributes]`. Ids start at 0 or 1, as the first point's
 * does, and have no gaps. # begins a comment. Fields: attr1, attr2, .. (also 1, 2, ..) and marker;
 * for cells_to_points region1, region2, .. (also 1, 2, ..; region is the first).
 *
 * Refused: two dimensions, and tets of 10 nodes.
 */
#ifndef FORMATS_MESH_MESH_TETGEN_H
#define FORMATS_MESH_MESH_TETGEN_H

#include "formats/input/text_tokens.h"
#include "formats/mesh/mesh_reader.h"

enum { MESH_TETGEN_ATTRIBUTES_MAX = 4096 };

/* The counts in front of the points. Files of surfaces have them, too. */
typedef struct mesh_tetgen_columns {
    int64_t points, attributes, markers;
} mesh_tetgen_columns;

/* mesh_tetgen_points() - read the header of the points. ST_CORRUPT for more than `most` points. */
CHECKED status mesh_tetgen_points(text_tokens *t, uint64_t most, mesh_tetgen_columns *out);

extern const mesh_reader mesh_tetgen_reader;

#endif
