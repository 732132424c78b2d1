/* mesh_tile_state_template.h - the state of a tile through a mesh, and how far its rays look;
 * included by the units of an ISA (see formats/base/simd.h). */
#ifndef RENDER_MESH_MESH_TILE_STATE_TEMPLATE_H
#define RENDER_MESH_MESH_TILE_STATE_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/mesh/mesh_shade_template.h"
#include "render/mesh/mesh_tile.h"
#include "render/mesh/mesh_tracer.h"
#include "render/mesh/tet_polygons_template.h"
#include "render/tile/tile_boxes_template.h"

/* Active tets of a treelet, a lane each, waiting for covers_of(). */
typedef struct tet_lanes {
    uint32_t vertex[4][VF_N]; /* numbers in the treelet */
    tile_rect within[VF_N];   /* rectangles of their leaves */
    uint32_t local[VF_N];
    unsigned count;
} tet_lanes;

/* What the queue and the tile have of tets, beside: */
#define FLAT_QUEUE_OWN \
    tet_columns tets;  \
    double isovalue[VD_N];
#define FLAT_TILE_OWN                                                                          \
    tet_lanes lanes[2]; /* one that fills, and maybe a full one that waits for its vertices */ \
    unsigned filling;

#include "render/flat/flat_tile_template.h"

typedef flat_tile mesh_tile;

#endif
#endif
