/* grid_tile_template.h - grid_tile_trace_X() of grid_tile.h; included by the units of an ISA (see
 * formats/base/simd.h). */
#ifndef RENDER_GRID_GRID_TILE_TEMPLATE_H
#define RENDER_GRID_GRID_TILE_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/grid/grid_tile.h"

enum { TILE = GRID_TILE, TILE_WINDOWS = 1 }; /* for the templates included below */

#include "render/grid/grid_normals_template.h"

void SIMD_NAME(grid_tile_trace)(const frame *f, uint32_t x0, uint32_t y0, const tile_row asked[],
                                tile_outcome *out, ray_counters *counters);

/* The layout of the outcome's scratch. */
typedef struct tile_work {
    tile_walk walk;
    tile_pixels pixels;
} tile_work;
_Static_assert(sizeof(tile_work) <= GRID_TILE_SCRATCH, "a tile has room in its scratch");

void SIMD_NAME(grid_tile_trace)(const frame *f, uint32_t x0, uint32_t y0, const tile_row asked[],
                                tile_outcome *out, ray_counters *counters) {
    tile_work *work = out->scratch;
    tile_walk *w = &work->walk;
    tile_pixels *p = &work->pixels;
    tile_walk_begin(w, f, x0, y0, asked, out, counters);
    do {
        tile_walk_run(w);
        shade_walk(&w->s, &grid_kind_of_tile, w, p);
    } while (tile_walk_again(w, p->rgba[3]));
    shade_behind_all(f, p);
    write_tile(&w->s, p);
    out->first = tile_walk_next(w);
}

#endif
#endif
