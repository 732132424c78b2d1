/* triangle_tile_template.h - triangle_tile_X() of triangle_tile.h; included by the units of an ISA
 * (see formats/base/simd.h). */
#ifndef RENDER_TRIANGLE_TRIANGLE_TILE_TEMPLATE_H
#define RENDER_TRIANGLE_TRIANGLE_TILE_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/triangle/triangle_shade_template.h"
#include "render/triangle/triangle_turn_template.h"

#include "render/tile/tile_boxes_template.h"

/* Active triangles of a treelet, a lane each, waiting until a vector is full. */
typedef struct triangle_lanes {
    uint32_t vertex[3][VF_N]; /* numbers in the treelet */
    tile_rect within[VF_N];   /* rectangles of their blocks */
    uint32_t local[VF_N];
    unsigned count;
} triangle_lanes;

/* What the tile has of triangles, beside: */
#define FLAT_TILE_OWN  \
    const treelet *at; \
    triangle_lanes lanes;

#include "render/flat/flat_tile_template.h"

/* They are put into the queue as they are. */
static void flat_make_polygons(flat_tile *w, unsigned lanes) {
    (void)w, (void)lanes;
}

/* What is kept in the outcome's scratch. */
typedef struct triangle_work {
    flat_tile tile;
    triangle_shading shading;
} triangle_work;
_Static_assert(sizeof(triangle_work) <= TRIANGLE_TILE_SCRATCH, "a tile has room in its scratch");

/* ---- Triangles ---- */

/* Triangles as seen from the eye, a lane each: homogeneous pixel coordinates of their vertices. */
typedef struct triangles_in_view {
    vf x[3], y[3], w[3];
    vf far; /* bound of all vertices' distances */
} triangles_in_view;

/* Positions, and the eye's in double, are relative to the treelet's lower corner. So the error is a
 * few units of 2^-24 of the distance and of the treelet's size. */
SIMD void view_triangles(const flat_tile *w, const triangle_blocks *b, const vf corner[3][3],
                         triangles_in_view *v) {
    const projection *p = w->b.view.p;
    const float *bounds = b->tree.bounds[b->tree.levels - 1][0];
    float size = 0.0f;
    for (int a = 0; a < 3; a++)
        size += p->axis[a][3] * (bounds[a + 3] - bounds[a]);
    v->far = f_set(0.0f);
    for (int k = 0; k < 3; k++) {
        vf away = f_set(size);
        v->x[k] = v->y[k] = v->w[k] = f_set(0.0f);
        for (int a = 0; a < 3; a++) {
            const float lo = bounds[a];
            const vf q = (corner[k][a] - f_set(lo)) - f_set((float)(w->b.eye[a] - (double)lo));
            v->x[k] = v->x[k] + f_set(p->axis[a][0]) * q;
            v->y[k] = v->y[k] + f_set(p->axis[a][1]) * q;
            v->w[k] = v->w[k] + f_set(p->axis[a][2]) * q;
            away = away + f_set(p->axis[a][3]) * f_abs(q);
        }
        v->far = f_max(v->far, away);
    }
}

/* Corners in the picture. */
typedef struct triangle_corners {
    vf x[3], y[3];
} triangle_corners;

SIMD children_extent extent_of_triangles(const triangles_in_view *v, triangle_corners *c) {
    children_extent e = {.w0 = v->w[0]};
    for (int k = 0; k < 3; k++) {
        const vf r = f_reciprocal(v->w[k]);
        c->x[k] = v->x[k] * r;
        c->y[k] = v->y[k] * r;
        e.x0 = k ? f_min(e.x0, c->x[k]) : c->x[k];
        e.x1 = k ? f_max(e.x1, c->x[k]) : c->x[k];
        e.y0 = k ? f_min(e.y0, c->y[k]) : c->y[k];
        e.y1 = k ? f_max(e.y1, c->y[k]) : c->y[k];
        e.w0 = f_min(e.w0, v->w[k]);
    }
    return e;
}

SIMD flat_polygons flatten(const tile_view *tile, const void *points) {
    const triangle_corners *c = points;
    flat_polygons p;
    for (int i = 0; i < 5; i++) {
        const int k = i < 3 ? i : i == 3 ? 2 : 0;
        p.x[i] = c->x[k] - f_set(tile->x);
        p.y[i] = c->y[k] - f_set(tile->y);
    }
    return p;
}

/* Find which part of their blocks' rectangles the triangles can cover. Returns the lanes that cover
 * anything. A triangle nearer than a sixteenth of the bound on distances counts as covering the
 * whole rectangle. */
SIMD unsigned covers_of(const flat_tile *w, const triangle_lanes *l, const triangles_in_view *v,
                        flat_covers *out) {
    const unsigned lanes = (1u << l->count) - 1u;
    const rect_lanes within = rect_lanes_load(l->within);
    triangle_corners c;
    const children_extent e = extent_of_triangles(v, &c);
    const mf whole = f_lt(e.w0, v->far * f_set(projection_depth_share));
    mf alive;
    const vi packed =
        rects_of_extent(&w->b.view, &e, 2.0f * w->b.view.p->margin, whole, within, &alive);
    memcpy(out->rect, &packed, sizeof packed);
    f_store(out->depth, f_select(whole, f_set(0.0f), e.w0 - f_set(0x1p-19f) * v->far));
    alive = mf_and(alive, mf_of_bits(lanes));
    const mf none =
        cover_no_centre(&w->b.view, flatten, &c, &e, v->far, mf_and_not(alive, whole), out);
    return mf_bits(mf_and_not(alive, none));
}

/* Queue a lane's triangle. Flush when the queue is full. */
SIMD void put_triangle(flat_tile *w, const turned_triangles *t, unsigned lane, tile_rect rect,
                       uint32_t centres) {
    flat_queue *q = &w->queue;
    const unsigned to = q->count++;
    turned_put(t, lane, &q->polygons, to);
    q->at[to] = w->at;
    q->local[to] = w->lanes.local[lane];
    q->iso[to] = 0;
    q->rect[to] = rect;
    q->centres[to] = centres;
    q->pixels += (rect.x1 - rect.x0 + 1u) * (rect.y1 - rect.y0 + 1u);
    if (q->count == VD_N || q->pixels >= QUEUE_PIXELS)
        walk_queue(w);
}

static void walk_lanes(flat_tile *w) {
    const triangle_blocks *b = &resident_triangles_of(w->at)->blocks;
    triangle_lanes *l = &w->lanes;
    turned_triangles turned;
    triangles_in_view view;
    flat_covers covers;
    vf corner[3][3];
    for (unsigned k = l->count; k < VF_N; k++)
        for (int v = 0; v < 3; v++)
            l->vertex[v][k] = l->vertex[v][0];
    turn_triangles(b, (const uint32_t(*)[VF_N])l->vertex, corner, &turned);
    view_triangles(w, b, (const vf(*)[3])corner, &view);
    for (unsigned left = covers_of(w, l, &view, &covers); left; left &= left - 1) {
        const unsigned k = (unsigned)__builtin_ctz(left);
        const float near2 = covers.depth[k] * covers.depth[k];
        const tile_rect rect = covers.rect[k];
        const uint32_t centres = centres_in_sight(w, rect, covers.centres[k], near2);
        if (centres || (!covers.centres[k] && in_sight(&w->b, rect, near2)))
            put_triangle(w, &turned, k, rect, centres);
    }
    w->b.s.counters->cells += l->count;
    l->count = 0;
}

static void walk_block(void *work, const tile_pending *p) {
    flat_tile *w = work;
    const triangle_blocks *b = &resident_triangles_of(w->at)->blocks;
    triangle_lanes *l = &w->lanes;
    for (unsigned left = b->active[p->i]; left; left &= left - 1) {
        const uint32_t i = TRIANGLE_BLOCK * p->i + (uint32_t)__builtin_ctz(left);
        const uint16_t *v = b->rows[i];
        for (int k = 0; k < 3; k++)
            l->vertex[k][l->count] = v[k];
        l->within[l->count] = p->rect;
        l->local[l->count++] = i;
        if (l->count == VF_N)
            walk_lanes(w);
    }
}

/* ---- Treelets ---- */

static const tile_visitor block_visitor = {walk_block, NULL, NULL};

static void visit_treelet(void *work, const tile_pending *p) {
    flat_tile *w = work;
    w->at = treelet_in_sight(&w->b, p);
    if (!w->at)
        return;
    walk_tree(&w->b, &resident_triangles_of(w->at)->blocks.tree, p->rect, p->near2, &block_visitor,
              w);
    if (w->lanes.count > 0)
        walk_lanes(w);
    /* Walk the queue now: its hits may hide other treelets, which need not be loaded then. */
    if (w->queue.count > 0)
        walk_queue(w);
}

static void queue_treelet(void *work, uint32_t t) {
    const flat_tile *w = work;
    loader_prefetch(w->b.s.f->tracer->treelets, t);
}

static const tile_visitor treelet_visitor = {visit_treelet, queue_treelet, NULL};

void SIMD_NAME(triangle_tile)(const frame *f, uint32_t x0, uint32_t y0, const tile_row asked[],
                              tile_outcome *out, ray_counters *counters);

void SIMD_NAME(triangle_tile)(const frame *f, uint32_t x0, uint32_t y0, const tile_row asked[],
                              tile_outcome *out, ray_counters *counters) {
    triangle_work *work = out->scratch;
    flat_tile *w = &work->tile;
    triangle_shading *m = &work->shading;
    tile_boxes_begin(&w->b, f, &triangle_order, x0, y0, asked, out, counters);
    w->lanes.count = 0;
    w->queue.count = w->queue.pixels = 0;
    memset(&w->queue.polygons, 0, sizeof w->queue.polygons);
    m->s = &w->b.s;
    memset(m->at, 0, sizeof m->at);
    do {
        walk_tree(&w->b, f->tracer->treelets->tree, tile_boxes_again(&w->b), 0.0f, &treelet_visitor,
                  w);
        shade_walk(&w->b.s, &triangle_kind_of_tile, m, &m->pixels);
    } while (tile_state_again(&w->b.s, TILE_LAYERS, m->pixels.rgba[3]));
    shade_behind_all(f, &m->pixels);
    write_tile(&w->b.s, &m->pixels);
}

#endif
#endif
