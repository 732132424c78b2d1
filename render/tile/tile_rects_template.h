/* tile_rects_template.h - which pixels of a tile the eight children of a node can cover; included
 * by the units of an ISA (see formats/base/simd.h). */
#ifndef RENDER_TILE_TILE_RECTS_TEMPLATE_H
#define RENDER_TILE_TILE_RECTS_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include <string.h>

#include "render/frame/tile.h"
#include "render/look/projection.h"

/* A rectangle of pixels of a tile, ends included; as the bytes of a number, x0 is the lowest. */
typedef struct tile_rect {
    uint8_t x0, x1, y0, y1;
} tile_rect;

/* The rectangle's pixels in a row, a bit each. */
static inline unsigned row_mask(tile_rect r) {
    return (2u << r.x1) - (1u << r.x0);
}

typedef struct tile_rects {
    tile_rect of[16]; /* the octants' */
    unsigned alive;   /* bits of the octants whose rectangle is not empty */
} tile_rects;

/* A tile in the picture: the centre of its first pixel, relative to where the camera looks. */
typedef struct tile_view {
    const projection *p;
    float x, y;
} tile_view;

SIMD tile_view tile_view_of(const frame *f, uint32_t x0, uint32_t y0) {
    return (tile_view){f->projection, (float)(x0 + 0.5 - 0.5 * f->camera.middle[0]),
                       (float)(y0 + 0.5 - 0.5 * f->camera.middle[1])};
}

/* One homogeneous coordinate (x, y or w) of the eight children. A corner's coordinate is a sum over
 * the axes. lo, hi: what the child's lower or upper plane across an axis adds. */
typedef struct children_planes {
    vf lo[3], hi[3];
} children_planes;

/* Lanes are octants; AVX-512 has twice as many lanes as octants and repeats them. */
static const float octant_bit[3][16] = {{0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1},
                                        {0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1},
                                        {0, 0, 0, 0, 1, 1, 1, 1, 0, 0, 0, 0, 1, 1, 1, 1}};

SIMD void children_axis(children_planes *c, int a, unsigned lane, float first, float middle,
                        float last) {
    const mf upper = f_gt(f_load(octant_bit[a] + lane), f_set(0.0f));
    c->lo[a] = f_select(upper, f_set(middle), f_set(first));
    c->hi[a] = f_select(upper, f_set(last), f_set(middle));
}

/* The homogeneous coordinates of the children. far: a bound of their corners' distances. */
typedef struct children_entries {
    children_planes x, y, w;
    vf far;
} children_entries;

/* Returns which children's boxes lie wholly outside of x - c w >= 0 (sign 1) or <= 0 (sign -1).
 * Tests the corner nearest to the inside. */
SIMD mf outside(const children_planes *x, const children_planes *w, float c, float sign, vf error) {
    vf most = error;
    for (int a = 0; a < 3; a++)
        most = most + f_max(f_set(sign) * (x->lo[a] - f_set(c) * w->lo[a]),
                            f_set(sign) * (x->hi[a] - f_set(c) * w->hi[a]));
    return f_lt(most, f_set(0.0f));
}

/* Returns which children lie outside the tile's pyramid. Needed for children that reach behind the
 * eye, or too near to it: they have no rectangle of their own, and get their parent's. */
SIMD mf outside_tile(const tile_view *tile, const children_entries *e) {
    const float m = 0.5f;
    const vf error = f_set(tile->p->plane_error) * e->far;
    mf out = outside(&e->x, &e->w, tile->x - m, 1.0f, error);
    out = mf_or(out, outside(&e->x, &e->w, tile->x + (TILE - 1) + m, -1.0f, error));
    out = mf_or(out, outside(&e->y, &e->w, tile->y - m, 1.0f, error));
    return mf_or(out, outside(&e->y, &e->w, tile->y + (TILE - 1) + m, -1.0f, error));
}

/* Smallest and largest x / w, y / w and w over the eight corners of VF_N children. */
typedef struct children_extent {
    vf x0, x1, y0, y1, w0, w1;
} children_extent;

SIMD void extend(children_extent *e, vf x, vf y, vf w) {
    const vf r = f_reciprocal(w), px = x * r, py = y * r;
    e->x0 = f_min(e->x0, px);
    e->x1 = f_max(e->x1, px);
    e->y0 = f_min(e->y0, py);
    e->y1 = f_max(e->y1, py);
    e->w0 = f_min(e->w0, w);
    e->w1 = f_max(e->w1, w);
}

/* Extend by two corners that differ only in z. x, y and w: the sums over the other two axes. */
SIMD void extend_twice(children_extent *e, vf x, vf y, vf w, const children_planes *xs,
                       const children_planes *ys, const children_planes *ws) {
    extend(e, x + xs->lo[2], y + ys->lo[2], w + ws->lo[2]);
    extend(e, x + xs->hi[2], y + ys->hi[2], w + ws->hi[2]);
}

SIMD children_extent extent_of(const children_planes *x, const children_planes *y,
                               const children_planes *w) {
    const vf most = f_set(INFINITY), least = f_set(-INFINITY);
    children_extent e = {most, least, most, least, most, least};
    extend_twice(&e, x->lo[0] + x->lo[1], y->lo[0] + y->lo[1], w->lo[0] + w->lo[1], x, y, w);
    extend_twice(&e, x->hi[0] + x->lo[1], y->hi[0] + y->lo[1], w->hi[0] + w->lo[1], x, y, w);
    extend_twice(&e, x->lo[0] + x->hi[1], y->lo[0] + y->hi[1], w->lo[0] + w->hi[1], x, y, w);
    extend_twice(&e, x->hi[0] + x->hi[1], y->hi[0] + y->hi[1], w->hi[0] + w->hi[1], x, y, w);
    return e;
}

/* One rectangle in each lane. */
typedef struct rect_lanes {
    vf x0, x1, y0, y1;
} rect_lanes;

SIMD rect_lanes rect_lanes_of(const tile_rect *r) {
    return (rect_lanes){f_set(r->x0), f_set(r->x1), f_set(r->y0), f_set(r->y1)};
}

/* Load VF_N rectangles. */
SIMD rect_lanes rect_lanes_load(const tile_rect *from) {
    vi all;
    memcpy(&all, from, sizeof all);
    return (rect_lanes){
        __builtin_convertvector(all & 255, vf), __builtin_convertvector(all >> 8 & 255, vf),
        __builtin_convertvector(all >> 16 & 255, vf), __builtin_convertvector(all >> 24 & 255, vf)};
}

/* Returns the rectangles of the extents e, widened by the margin and cut to the rectangles
 * `within`. Lanes `whole` get `within` itself. *alive: lanes whose rectangle is not empty. */
SIMD vi rects_of_extent(const tile_view *tile, const children_extent *e, float margin, mf whole,
                        rect_lanes within, mf *alive) {
    vf x0 = f_max(f_ceil(e->x0 - f_set(tile->x + margin)), within.x0);
    vf x1 = f_min(f_floor(e->x1 - f_set(tile->x - margin)), within.x1);
    vf y0 = f_max(f_ceil(e->y0 - f_set(tile->y + margin)), within.y0);
    vf y1 = f_min(f_floor(e->y1 - f_set(tile->y - margin)), within.y1);
    *alive = mf_and(f_le(x0, x1), f_le(y0, y1));
    if (mf_bits(whole)) {
        x0 = f_select(whole, within.x0, x0);
        x1 = f_select(whole, within.x1, x1);
        y0 = f_select(whole, within.y0, y0);
        y1 = f_select(whole, within.y1, y1);
        *alive = mf_or(*alive, whole);
    }
    return f_to_int(x0) | f_to_int(x1) << 8 | f_to_int(y0) << 16 | f_to_int(y1) << 24;
}

/* Find the pixel rectangles that VF_N children can cover, those of the octants from `lane` on. c:
 * the entries of these children. Sets rects->of[lane ..] and their bits of rects->alive. */
SIMD void tile_rects_of_entries(const tile_view *tile, const children_entries *c, unsigned lane,
                                const tile_rect *parent, tile_rects *rects) {
    const children_extent e = extent_of(&c->x, &c->y, &c->w);
    const mf whole = f_lt(e.w0, c->far * f_set(projection_depth_share));
    mf alive;
    const vi packed =
        rects_of_extent(tile, &e, tile->p->margin, whole, rect_lanes_of(parent), &alive);
    if (mf_bits(whole)) {
        alive = mf_and_not(alive, f_lt(e.w1, f_set(-tile->p->plane_error) * c->far));
        alive = mf_and_not(alive, mf_and(whole, outside_tile(tile, c)));
    }
    memcpy(rects->of + lane, &packed, sizeof packed);
    rects->alive |= mf_bits(alive) << lane;
}

/* Find the rectangles of a node's children. Its planes, in their level, begin at `first` and are
 * `half` apart. */
SIMD void tile_rects_of(const tile_view *tile, const plane_projection *const planes[3],
                        const uint32_t first[3], uint32_t half, const tile_rect *parent,
                        tile_rects *rects) {
    const plane_projection *node[3][3];
    float far = 0.0f;
    for (int a = 0; a < 3; a++) {
        for (uint32_t i = 0; i < 3; i++)
            node[a][i] = &planes[a][first[a] + i * half];
        far += node[a][0]->far > node[a][2]->far ? node[a][0]->far : node[a][2]->far;
    }
    rects->alive = 0;
    for (unsigned lane = 0; lane < 8; lane += VF_N) {
        children_entries c = {.far = f_set(far)};
        for (int a = 0; a < 3; a++) {
            children_axis(&c.x, a, lane, node[a][0]->x, node[a][1]->x, node[a][2]->x);
            children_axis(&c.y, a, lane, node[a][0]->y, node[a][1]->y, node[a][2]->y);
            children_axis(&c.w, a, lane, node[a][0]->w, node[a][1]->w, node[a][2]->w);
        }
        tile_rects_of_entries(tile, &c, lane, parent, rects);
    }
    rects->alive &= 255u;
}

#endif
#endif
