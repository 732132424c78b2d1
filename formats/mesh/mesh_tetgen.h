/* mesh_tetgen.h - TetGen's .node and .ele: either names both, `F.node` and `F.ele`.
 *
 * Points: `count 3 attributes markers`, then a line each: `id x y z [attributes] [marker]`. Tets:
 * `count 4 attributes`, then `id a b c d [attributes]`. Ids count from 0 or 1, as the first point's
 * does, without gaps. # begins a comment. Fields: attr1, attr2, .. (also 1, 2, ..) and marker; for
 * cells_to_points region1, region2, .. (also 1, 2, ..; region is the first).
 *
 * Refused: two dimensions, and tets of 10 nodes.
 */
#ifndef FORMATS_MESH_MESH_TETGEN_H
#define FORMATS_MESH_MESH_TETGEN_H

#include "formats/input/text_tokens.h"
#include "formats/mesh/mesh_reader.h"

enum { MESH_TETGEN_ATTRIBUTES_MAX = 4096 };

/* What stands in front of the points, in files of surfaces, too. */
typedef struct mesh_tetgen_columns {
    int64_t points, attributes, markers;
} mesh_tetgen_columns;

/* mesh_tetgen_points() - the header of the points, of which there are at most so many. */
CHECKED status mesh_tetgen_points(text_tokens *t, uint64_t most, mesh_tetgen_columns *out);

extern const mesh_reader mesh_tetgen_reader;

#endif
