/* tile_template.h - tile_trace_X() of tile.h; included by the units of an ISA (see
 * formats/base/simd.h). */
#ifndef RENDER_TILE_TEMPLATE_H
#define RENDER_TILE_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/tile_shade_template.h"

void SIMD_NAME(tile_trace)(const frame *f, uint32_t x0, uint32_t y0, const uint16_t asked[TILE],
                           tile_outcome *out, frame_counters *counters);

/* Whether a pixel is done with its first surface, and no light may be hidden from it. */
static bool shaded_together(const frame *f) {
    bool single = f->scene->layers_max == 1;
    if (!single) {
        single = true;
        for (int i = 0; i < f->tracer->scene.count; i++)
            single &= f->surfaces[i].opacity >= 1.0f;
    }
    return single && (f->scene->light_count == 0 || !f->scene->shadows);
}

void SIMD_NAME(tile_trace)(const frame *f, uint32_t x0, uint32_t y0, const uint16_t asked[TILE],
                           tile_outcome *out, frame_counters *counters) {
    tile_walk w;
    tile_pixels pixels;
    const bool together = shaded_together(f);
    tile_walk_run(&w, f, x0, y0, asked, out, counters);
    clear_pixels(f, &pixels);
    if (together)
        shade_tile(&w, &pixels);
    for (unsigned y = 0; y < TILE; y++) {
        unsigned found = 0;
        const unsigned left = w.rays.single[y] | out->waits[y];
        out->open[y] = w.rays.single[y];
        for (unsigned x = 0; x < TILE && !together; x++) {
            const unsigned i = TILE * y + x;
            if (!(w.t[i] < INFINITY) || left >> x & 1u)
                continue;
            found |= 1u << x;
            out->hits[i] = (hit){w.t[i], index_of(&w, w.at[i], w.cell[i]), w.iso[i], w.entering[i]};
            out->at[i] = w.at[i];
        }
        out->found[y] = (uint16_t)found;
        const unsigned done = w.asked[y] & ~(left | found);
        write_row(&w, y, done, &pixels);
    }
}

#endif
#endif
