/* triangle_shade_template.h - shades the hits of a tile's rays on triangles as pixels; included by
 * the units of an ISA (see formats/base/simd.h). */
#ifndef RENDER_TRIANGLE_TRIANGLE_SHADE_TEMPLATE_H
#define RENDER_TRIANGLE_TRIANGLE_SHADE_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/triangle/triangle_tile.h"
#include "render/triangle/triangle_walk.h"
#include "stream/triangle_resident.h"

enum { TILE = TRIANGLE_TILE, TILE_WINDOWS = 0 }; /* for the templates that follow */

#include "render/tile/tile_shade_template.h"

/* Slots for the last triangles: neighbouring rays hit the same ones. */
enum { KNOWN_TRIANGLES = 64 };

typedef struct triangle_shading {
    const tile_state *s;
    tile_pixels pixels;
    const treelet *at[KNOWN_TRIANGLES]; /* NULL: the slot is empty */
    uint32_t local[KNOWN_TRIANGLES];
    flat_facts facts[KNOWN_TRIANGLES];
    triangle_smooth smooth[KNOWN_TRIANGLES];
} triangle_shading;

static uint64_t triangle_cell_of(const frame *f, const tile_surface *s) {
    (void)f;
    return triangle_blocks_number(&resident_triangles_of(s->at)->blocks, s->local);
}

static bool triangle_comes_before(const hit *a, const hit *b) {
    return triangle_less(a, b);
}

static bool triangle_same(const hit *a, const hit *b) {
    return flat_polygon_double(a, b);
}

static const tile_order triangle_order = {triangle_cell_of, triangle_comes_before, triangle_same};

static triangle triangle_met(const tile_surface *x) {
    return triangle_walk_one(&resident_triangles_of(x->at)->blocks, x->local);
}

/* Returns the slot of a surface's triangle, filled when first needed. */
static unsigned slot_of(triangle_shading *m, const tile_surface *x) {
    const unsigned k = x->local % KNOWN_TRIANGLES;
    if (m->at[k] != x->at || m->local[k] != x->local) {
        const triangle met = triangle_met(x);
        m->at[k] = x->at;
        m->local[k] = x->local;
        m->facts[k] = triangle_flat_facts(&met);
        m->smooth[k] = triangle_smooth_of(&met);
    }
    return k;
}

static const flat_facts *facts_of(triangle_shading *m, const tile_surface *x) {
    return &m->facts[slot_of(m, x)];
}

static ray triangle_ray(const triangle_shading *m, unsigned i) {
    const tile_state *s = m->s;
    ray r = {.t0 = s->rays.t0[i], .t1 = s->rays.t1[i]};
    for (int a = 0; a < 3; a++) {
        r.o[a] = r.held[a] = s->f->projection->eye[a];
        r.d[a] = s->rays.d[a][i];
    }
    return r;
}

static void triangle_normals(void *work, const tile_layer *l, tile_normals normal) {
    triangle_shading *m = work;
    for (unsigned i = 0; i < TILE_RAYS; i++) {
        if (!in_layer(l, i))
            continue;
        const tile_surface *x = surface_of(l, i);
        const unsigned k = slot_of(m, x);
        float n[3];
        memcpy(n, m->facts[k].point.normal, sizeof n);
        if (m->smooth[k].any) {
            const ray r = triangle_ray(m, i);
            triangle_smooth_normal(&m->smooth[k], &r, x->t, n);
        }
        for (int a = 0; a < 3; a++)
            normal[a][i] = n[a];
    }
}

static void triangle_starts(void *work, const tile_layer *l, unsigned i, unsigned which,
                            surface_point to[]) {
    triangle_shading *m = work;
    for (unsigned left = which; left; left &= left - 1) {
        const unsigned n = i + (unsigned)__builtin_ctz(left);
        const tile_surface *x = surface_of(l, n);
        const ray r = triangle_ray(m, n);
        const hit h = {.t = x->t};
        *to++ = flat_point_at(facts_of(m, x), &r, &h);
    }
}

static void triangle_colours(void *work, const tile_layer *l, unsigned i, unsigned which,
                             float rgb[][3]) {
    triangle_shading *m = work;
    const frame *f = m->s->f;
    for (unsigned left = which; left; left &= left - 1) {
        const unsigned k = (unsigned)__builtin_ctz(left);
        const tile_surface *x = surface_of(l, i + k);
        const triangle met = triangle_met(x);
        const ray r = triangle_ray(m, i + k);
        const hit h = {.t = x->t};
        surface_point at;
        triangle_values(&met, &r, x->t, f->tracer->coloured, &at);
        surface_colour(f, 0, &h, &at, rgb[k]);
    }
}

static const tile_kind triangle_kind_of_tile = {triangle_normals, triangle_starts,
                                                triangle_colours};

#endif
#endif
