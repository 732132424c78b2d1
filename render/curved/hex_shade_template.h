/* hex_shade_template.h - shades the hits of a tile's rays in cells with bent faces as pixels;
 * included by the units of an ISA (see formats/base/simd.h). The kind defines before:
 *
 *   static curved_cell hex_tile_cell(const treelet *at, uint32_t local);   a cell of a treelet
 *   static uint64_t hex_tile_first(const treelet *at);   number of its first cell in the file
 */
#ifndef RENDER_CURVED_HEX_SHADE_TEMPLATE_H
#define RENDER_CURVED_HEX_SHADE_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/curved/hex_tile.h"
#include "render/curved/hex_walk.h"

/* For the templates that follow. A hit's parameters in its cell are kept, and its normal. */
enum { TILE = HEX_TILE, TILE_WINDOWS = 0 };
#define TILE_SURFACE_OWN \
    double in_cell[3];   \
    float normal[3];

#include "render/tile/tile_shade_template.h"

typedef struct hex_shading {
    const tile_state *s;
    tile_pixels pixels;
} hex_shading;

static uint64_t hex_number_of(const frame *f, const tile_surface *s) {
    (void)f;
    return hex_tile_first(s->at) + s->local;
}

static bool hex_less(const hit *a, const hit *b) {
    return hit_less(a, b);
}

static bool hex_same(const hit *a, const hit *b) {
    return !hit_less(a, b) && !hit_less(b, a);
}

static const tile_order hex_order = {hex_number_of, hex_less, hex_same};

static void hex_normals(void *work, const tile_layer *l, tile_normals normal) {
    (void)work;
    for (unsigned i = 0; i < TILE_RAYS; i++)
        for (int a = 0; a < 3 && in_layer(l, i); a++)
            normal[a][i] = surface_of(l, i)->normal[a];
}

static ray tile_ray(const tile_state *s, unsigned i) {
    ray r = {.t0 = s->rays.t0[i], .t1 = s->rays.t1[i]};
    for (int a = 0; a < 3; a++) {
        r.o[a] = r.held[a] = s->f->projection->eye[a];
        r.d[a] = s->rays.d[a][i];
    }
    return r;
}

static void hex_starts(void *work, const tile_layer *l, unsigned i, unsigned which,
                       surface_point to[]) {
    const hex_shading *m = work;
    for (unsigned left = which; left; left &= left - 1) {
        const unsigned n = i + (unsigned)__builtin_ctz(left);
        const tile_surface *x = surface_of(l, n);
        const curved_cell cell = hex_tile_cell(x->at, x->local);
        const ray r = tile_ray(m->s, n);
        *to++ = hex_walk_surface(&cell, x->in_cell, &r, x->t);
    }
}

static const tile_kind hex_kind_of_tile = {hex_normals, hex_starts, NULL};

#endif
#endif
