/* tile_template.h - tile_trace_X() of tile.h; included by the units of an ISA (see
 * formats/base/simd.h). */
#ifndef RENDER_TILE_TEMPLATE_H
#define RENDER_TILE_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/tile.h"

enum { TILE = GRID_TILE, TILE_WINDOWS = 1 }; /* of the templates that follow */

#include "render/tile_normals_template.h"

void SIMD_NAME(tile_trace)(const frame *f, uint32_t x0, uint32_t y0, const tile_row asked[],
                           tile_outcome *out, frame_counters *counters);

void SIMD_NAME(tile_trace)(const frame *f, uint32_t x0, uint32_t y0, const tile_row asked[],
                           tile_outcome *out, frame_counters *counters) {
    tile_walk w;
    tile_pixels pixels;
    tile_walk_run(&w, f, x0, y0, asked, out, counters);
    clear_pixels(f, &pixels);
    const bool together = shaded_together(f);
    if (together) {
        tile_normals(&w, &pixels);
        shade_tile(&w.s, &pixels);
    }
    write_tile(&w.s, together, &pixels);
    for (unsigned i = 0; i < TILE_RAYS && !together; i++)
        if (out->found[i / TILE] >> i % TILE & 1u)
            out->hits[i].cell = index_of(&w, w.s.at[i], w.cell[i]);
}

#endif
#endif
