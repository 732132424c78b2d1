/* triangle_shade_template.h - shades the hits of a tile's rays on triangles as pixels; included by
 * the units of an ISA (see formats/base/simd.h). */
#ifndef RENDER_TRIANGLE_TRIANGLE_SHADE_TEMPLATE_H
#define RENDER_TRIANGLE_TRIANGLE_SHADE_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/triangle/triangle_facts_template.h"
#include "render/triangle/triangle_tile.h"
#include "render/triangle/triangle_walk.h"
#include "stream/triangle_resident.h"

enum { TILE = TRIANGLE_TILE, TILE_WINDOWS = 0 }; /* for the templates that follow */

#include "render/tile/tile_shade_template.h"

/* Slots for the last smooth triangles: neighbouring rays hit the same ones. */
enum { KNOWN_TRIANGLES = 64 };

typedef struct triangle_shading {
    const tile_state *s;
    tile_pixels pixels;
    const treelet *at[KNOWN_TRIANGLES]; /* NULL: the slot is empty */
    uint32_t local[KNOWN_TRIANGLES];
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

/* Returns what is known of a smooth triangle, found out when first needed. */
static const triangle_smooth *smooth_of(triangle_shading *m, const tile_surface *x) {
    const unsigned k = x->local % KNOWN_TRIANGLES;
    if (m->at[k] != x->at || m->local[k] != x->local) {
        const triangle met = triangle_met(x);
        m->at[k] = x->at;
        m->local[k] = x->local;
        m->smooth[k] = triangle_smooth_of(&met);
    }
    return &m->smooth[k];
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

/* Collect the triangles of surfaces of the rays `which`, a bit each, of VD_N rays from i on. The
 * other lanes have none. */
SIMD void columns_of(const tile_layer *l, unsigned i, unsigned which, triangle_columns *c) {
    if (which != (1u << VD_N) - 1u)
        memset(c, 0, sizeof *c);
    for (; which; which &= which - 1) {
        const unsigned k = (unsigned)__builtin_ctz(which);
        const tile_surface *x = surface_of(l, i + k);
        triangle_columns_put(c, k, &resident_triangles_of(x->at)->blocks, x->local);
    }
}

/* Bend the normals of smooth triangles. */
static void smooth_normals(triangle_shading *m, const tile_layer *l, unsigned i, unsigned which,
                           tile_normals normal) {
    for (; which; which &= which - 1) {
        const unsigned n = i + (unsigned)__builtin_ctz(which);
        const tile_surface *x = surface_of(l, n);
        if (!resident_triangles_of(x->at)->blocks.normals)
            continue;
        const triangle_smooth *smooth = smooth_of(m, x);
        if (!smooth->any)
            continue;
        const ray r = triangle_ray(m, n);
        float of[3] = {normal[0][n], normal[1][n], normal[2][n]};
        triangle_smooth_normal(smooth, &r, x->t, of);
        for (int a = 0; a < 3; a++)
            normal[a][n] = of[a];
    }
}

static void triangle_normals(void *work, const tile_layer *l, tile_normals normal) {
    for (unsigned i = 0; i < TILE_RAYS; i += VD_N) {
        const unsigned which = hits_from(l, i, VD_N);
        triangle_columns c;
        point_columns facts;
        if (!which)
            continue;
        columns_of(l, i, which, &c);
        triangle_facts(&c, &facts);
        for (int a = 0; a < 3; a++)
            d_store_floats(normal[a] + i, d_set(-0.0) - facts.gradient[a]);
        smooth_normals(work, l, i, which, normal);
    }
}

static void triangle_starts(void *work, const tile_layer *l, unsigned i, unsigned which,
                            surface_point to[]) {
    const triangle_shading *m = work;
    double t[VD_N] = {0.0}, span[VD_N], gradient[3][VD_N], error[VD_N];
    triangle_columns c;
    point_columns facts;
    columns_of(l, i, which, &c);
    triangle_facts(&c, &facts);
    for (unsigned left = which; left; left &= left - 1)
        t[__builtin_ctz(left)] = surface_of(l, i + (unsigned)__builtin_ctz(left))->t;
    facts.t = d_load(t);
    for (int a = 0; a < 3; a++) {
        facts.d[a] = d_load(m->s->rays.d[a] + i);
        d_store(gradient[a], facts.gradient[a]);
    }
    point_errors(&facts, m->s->f->projection->eye, error);
    d_store(span, triangle_spans(&c));
    for (unsigned left = which; left; left &= left - 1, to++) {
        const unsigned k = (unsigned)__builtin_ctz(left);
        *to = (surface_point){.error = error[k], .span = span[k]};
        for (int a = 0; a < 3; a++)
            to->gradient[a] = gradient[a][k];
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
