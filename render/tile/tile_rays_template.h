/* tile_rays_template.h - the rays of a tile; included by the units of an ISA (see
 * formats/base/simd.h). They define TILE, the pixels on a side, and TILE_WINDOWS: whether windows
 * use its rays. */
#ifndef RENDER_TILE_TILE_RAYS_TEMPLATE_H
#define RENDER_TILE_TILE_RAYS_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include <string.h>

#include "render/frame/tile.h"
#include "render/ray/ray_box_template.h"

/* A vector of rays is a window: rows of four pixels below each other, anywhere in the tile. */
enum {
    WINDOW_X = 4,
    WINDOW_Y = VF_N / WINDOW_X,
    STRIDE = TILE + WINDOW_X,
    ROWS = TILE + WINDOW_Y,
    PADDED = STRIDE * ROWS,
    TILE_RAYS = TILE * TILE
};

static const tile_row row_full = (tile_row)((UINT64_C(1) << TILE) - 1);

/* One float for each ray, with a margin on the right and below for windows that reach over the
 * edge. */
typedef float tile_plane[PADDED];

typedef struct tile_rays {
    double d[3][TILE_RAYS]; /* grid space, as ray.h; all start at the eye */
    double t0[TILE_RAYS], t1[TILE_RAYS];
    /* For conservative tests of windows: d is scaled to ordinary size by projection.scale, and t to
     * match. */
    tile_plane near_d[3], reciprocal[3], near_t0, near_t1;
    float towards_eye[3][TILE_RAYS]; /* world space */
    tile_row single[TILE];           /* pixels left to single rays */
} tile_rays;

/* A direction of size about 1 with a component smaller than this has no usable reciprocal. */
static const double component_min = 1e-10;

SIMD vf window_load(const float *at) {
    return f_load_rows(at, STRIDE);
}

/* Cut t0 .. t1 to a half-space n . p + w >= 0: tracer_ray()'s rule, VD_N rays at a time. */
SIMD void clip_rays(const double plane[4], const double eye[3], const vd d[3], vd *t0, vd *t1) {
    const double at_eye = plane[0] * eye[0] + plane[1] * eye[1] + plane[2] * eye[2] + plane[3];
    const vd slope = d_set(plane[0]) * d[0] + d_set(plane[1]) * d[1] + d_set(plane[2]) * d[2];
    const vd zero = d_set(0.0), t = d_set(-at_eye) / slope;
    *t0 = d_select(md_and(d_gt(slope, zero), d_gt(t, *t0)), t, *t0);
    *t1 = d_select(md_and(d_lt(slope, zero), d_lt(t, *t1)), t, *t1);
    if (!(at_eye >= 0.0))
        *t1 = d_select(d_eq(slope, zero), d_set(-INFINITY), *t1);
}

/* Cut t0 .. t1 to the volume's box, as tracer_box(). */
SIMD void box_rays(const tracer *tr, const double eye[3], const vd d[3], vd *t0, vd *t1) {
    for (int a = 0; a < 3; a++)
        ray_slabs(d_set(tr->box[0][a] - eye[a]), d_set(tr->box[1][a] - eye[a]), d[a], t0, t1);
}

/* The unit directions of rays through the picture at (u, v): camera_ray() in the same order of
 * operations. */
SIMD void ray_directions(const camera *c, vd u, vd v, vd unit[3]) {
    vd d[3];
    for (int a = 0; a < 3; a++)
        d[a] = d_set(c->forward[a]) + u * d_set(c->right[a]) + v * d_set(c->up[a]);
    const vd shrink = d_set(1.0) / d_sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    for (int a = 0; a < 3; a++)
        unit[a] = d[a] * shrink + d_set(0.0);
}

/* Make VD_N rays of a row, through the picture at (u, v), by camera_ray() and tracer_ray() in the
 * same order of operations. Returns which of them are left to single rays. */
SIMD unsigned make_rays(const frame *f, vd u, vd v, unsigned at, tile_rays *rays) {
    const camera *c = &f->camera;
    const tracer *tr = f->tracer;
    const vd scale = d_set(f->projection->scale), unscale = d_set(f->projection->unscale);
    vd world[3], grid[3], t0 = d_set(0.0), t1 = d_set(INFINITY);
    ray_directions(c, u, v, world);
    for (int a = 0; a < 3; a++)
        d_store_floats(rays->towards_eye[a] + at, d_set(-0.0) - world[a]);
    for (int i = 0; i < tr->clip_count; i++)
        clip_rays(tr->clip[i], c->eye, world, &t0, &t1);
    for (int a = 0; a < 3; a++) {
        const double *m = tr->space.to_grid[a];
        grid[a] =
            d_set(m[0]) * world[0] + d_set(m[1]) * world[1] + d_set(m[2]) * world[2] + d_set(0.0);
        d_store(rays->d[a] + at, grid[a]);
    }
    if (tr->boxed)
        box_rays(tr, f->projection->eye, grid, &t0, &t1);
    d_store(rays->t0 + at, t0);
    d_store(rays->t1 + at, t1);
    const unsigned padded = at / TILE * STRIDE + at % TILE;
    md ordinary = md_of_bits(~0u);
    for (int a = 0; a < 3; a++) {
        const vd scaled = grid[a] * scale;
        ordinary = md_and(ordinary, d_ge(d_abs(scaled), d_set(component_min)));
        if (TILE_WINDOWS)
            d_store_floats(rays->near_d[a] + padded, scaled);
    }
    if (TILE_WINDOWS) {
        /* Rounding to float is within the tests' slack. */
        d_store_floats(rays->near_t0 + padded, t0 * unscale);
        d_store_floats(rays->near_t1 + padded, t1 * unscale);
    }
    return ~md_bits(ordinary) & ((1u << VD_N) - 1u);
}

/* Make all rays of a tile. Marks those that are left to single rays. */
static void tile_rays_make(const frame *f, uint32_t x0, uint32_t y0, tile_rays *rays) {
    const double *middle = f->camera.middle, height = f->camera.height;
    double u[TILE];
    for (unsigned x = 0; x < TILE; x++)
        u[x] = (2.0 * (x0 + x + 0.5) - middle[0]) / height;
    for (unsigned y = 0; y < TILE; y++) {
        unsigned single = 0;
        const vd v = d_set((middle[1] - 2.0 * (y0 + y + 0.5)) / height);
        for (unsigned x = 0; x < TILE; x += VD_N)
            single |= make_rays(f, d_load(u + x), v, TILE * y + x, rays) << x;
        for (int a = 0; a < 3 && TILE_WINDOWS; a++)
            for (unsigned at = STRIDE * y; at < STRIDE * y + TILE; at += VF_N)
                f_store(rays->reciprocal[a] + at, f_set(1.0f) / f_load(rays->near_d[a] + at));
        rays->single[y] = single;
    }
}

#endif
#endif
