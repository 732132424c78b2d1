/* tile_state_template.h - what tiles through grids and through meshes have in common: their rays,
 * and what these have found; included by the units of an ISA (see formats/base/simd.h). */
#ifndef RENDER_TILE_STATE_TEMPLATE_H
#define RENDER_TILE_STATE_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/tile_rays_template.h"

typedef struct tile_state {
    const frame *f;
    ray_counters *counters;
    tile_outcome *out;
    uint32_t x0, y0; /* its first pixel */
    bool has_rays;
    tile_rays rays;       /* made when the first are needed */
    tile_row asked[TILE]; /* a bit a pixel, as in tile.h */
    tile_row open[ROWS];  /* rays that still look for their surface */
    /* What has been found. */
    double t[TILE_RAYS]; /* INFINITY: nothing */
    int32_t iso[TILE_RAYS];
    bool entering[TILE_RAYS];
    const treelet *at[TILE_RAYS];
} tile_state;

static void tile_state_begin(tile_state *s, const frame *f, uint32_t x0, uint32_t y0,
                             const tile_row asked[], tile_outcome *out, ray_counters *counters) {
    s->f = f;
    s->counters = counters;
    s->out = out;
    s->x0 = x0;
    s->y0 = y0;
    s->has_rays = false;
    out->absent_count = 0;
    for (unsigned y = 0; y < ROWS; y++)
        s->open[y] = y < TILE ? asked[y] : 0;
    for (unsigned y = 0; y < TILE; y++) {
        s->asked[y] = s->open[y];
        s->rays.single[y] = out->waits[y] = 0;
    }
    for (unsigned i = 0; i < TILE_RAYS; i++)
        s->t[i] = INFINITY;
}

/* Make the rays, once. Tiles that meet no active cell do without. */
static void tile_state_rays(tile_state *s) {
    if (s->has_rays)
        return;
    tile_rays_make(s->f, s->x0, s->y0, &s->rays);
    s->has_rays = true;
    for (unsigned y = 0; y < TILE; y++) {
        s->rays.single[y] &= s->asked[y];
        s->open[y] &= ~s->rays.single[y];
    }
}

#endif
#endif
