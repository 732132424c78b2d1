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
#include "render/ray/lane_counts.h"
#include "render/tile/tile_boxes_template.h"

/* Active tets of a treelet, a lane each, waiting for covers_of(). */
typedef struct tet_lanes {
    uint32_t vertex[4][VF_N]; /* numbers in the treelet */
    tile_rect within[VF_N];   /* rectangles of their leaves */
    uint32_t local[VF_N];
    unsigned count;
} tet_lanes;

/* The most pixels that waiting polygons may cover together. While they wait, they hide nothing. */
enum { QUEUE_PIXELS = 64 };

/* Tets of a treelet that rays may hit, a lane each, waiting to be made into polygons. */
typedef struct tet_queue {
    tet_columns tets;
    double isovalue[VD_N];
    const resident_mesh *at[VD_N];
    uint32_t local[VD_N];
    int32_t iso[VD_N];
    tile_rect rect[VD_N];   /* pixels where the polygon can be */
    uint32_t centres[VD_N]; /* which of these pixels look at it, as in tet_covers */
    unsigned count, pixels; /* sum of the rectangles' pixels */
    polygon_lanes polygons; /* while rays meet them */
} tet_queue;

typedef struct mesh_tile {
    tile_boxes b;
    tet_lanes lanes[2]; /* one that fills, and maybe a full one that waits for its vertices */
    unsigned filling;
    tet_queue queue;
} mesh_tile;

/* Side of a window of pixels that starts at a rectangle's corner. */
enum { CENTRES = 4 };

SIMD unsigned centre_ray(tile_rect r, unsigned bit) {
    return TILE * (r.y0 + bit / CENTRES) + r.x0 + bit % CENTRES;
}

/* Of the pixels `centres`, a bit each in a window of 4 x 4, row by row, returns the ones whose rays
 * have no surface nearer than the squared distance near2. */
SIMD uint32_t centres_in_sight(const mesh_tile *w, tile_rect r, uint32_t centres, float near2) {
    const float at = near2 * SURELY;
    uint32_t visible = 0;
    for (uint32_t left = centres; left; left &= left - 1)
        if (!(w->b.far2[centre_ray(r, (unsigned)__builtin_ctz(left))] < at))
            visible |= left & -left;
    return visible;
}

#endif
#endif
