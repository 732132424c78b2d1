/* curvilinear_shade_template.h - shades the hits of a tile's rays in a curvilinear grid as pixels;
 * included by the units of an ISA (see formats/base/simd.h). */
#ifndef RENDER_CURVILINEAR_CURVILINEAR_SHADE_TEMPLATE_H
#define RENDER_CURVILINEAR_CURVILINEAR_SHADE_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/curvilinear/curvilinear_tile.h"
#include "render/curvilinear/curvilinear_walk.h"
#include "stream/curvilinear_resident.h"

/* For the templates that follow. A hit's parameters in its cell are kept, and its normal. */
enum { TILE = CURVILINEAR_TILE, TILE_WINDOWS = 0 };
#define TILE_SURFACE_OWN \
    double in_cell[3];   \
    float normal[3];

#include "render/tile/tile_shade_template.h"

typedef struct curvilinear_shading {
    const tile_state *s;
    tile_pixels pixels;
} curvilinear_shading;

static uint64_t curvilinear_cell_of(const frame *f, const tile_surface *s) {
    (void)f;
    return resident_curvilinear_of(s->at)->lattice.first + s->local;
}

static bool curvilinear_less(const hit *a, const hit *b) {
    return hit_less(a, b);
}

static bool curvilinear_same(const hit *a, const hit *b) {
    return !hit_less(a, b) && !hit_less(b, a);
}

static const tile_order curvilinear_order = {curvilinear_cell_of, curvilinear_less,
                                             curvilinear_same};

static void curvilinear_normals(void *work, const tile_layer *l, tile_normals normal) {
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

static void curvilinear_starts(void *work, const tile_layer *l, unsigned i, unsigned which,
                               surface_point to[]) {
    const curvilinear_shading *m = work;
    for (unsigned left = which; left; left &= left - 1) {
        const unsigned n = i + (unsigned)__builtin_ctz(left);
        const tile_surface *x = surface_of(l, n);
        const hexahedron cell =
            curvilinear_walk_cell(&resident_curvilinear_of(x->at)->lattice, x->local);
        const ray r = tile_ray(m->s, n);
        *to++ = hex_walk_surface(&cell, x->in_cell, &r, x->t);
    }
}

static const tile_kind curvilinear_kind_of_tile = {curvilinear_normals, curvilinear_starts};

#endif
#endif
