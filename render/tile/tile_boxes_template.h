/* tile_boxes_template.h - a tile that walks trees of boxes (stream/treelet_tree.h): the tree over
 * treelets, or what is in one; included by the units of an ISA (see formats/base/simd.h).
 *
 * Nearer boxes first. A box is dropped when it covers no pixel of the tile, or when every pixel
 * that it can cover has its surfaces in front of it.
 */
#ifndef RENDER_TILE_TILE_BOXES_TEMPLATE_H
#define RENDER_TILE_TILE_BOXES_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include <float.h>

#include "render/tile/tile_rects_template.h"
#include "render/tile/tile_state_template.h"
#include "render/walk/box_interval_template.h"

typedef struct tile_boxes {
    tile_state s;
    tile_view view;
    double eye[3];
    float far2[TILE_RAYS + VF_N]; /* squares of how far rays look; below 0: not at all */
} tile_boxes;

/* ---- Which rays see what ---- */

/* Margin for squared distances in single precision: more than their rounding. */
static const float SURELY = 1.0f - 0x1p-20f;

/* Update how far ray i looks. */
SIMD void look_as_far(tile_boxes *w, unsigned i) {
    const double t = w->s.reach[i];
    w->far2[i] = (float)(t * t) + FLT_MIN;
}

/* Let rays that are not open look no farther. */
static void look_with_open(tile_boxes *w) {
    for (unsigned y = 0; y < TILE; y++)
        for (unsigned left = row_full & ~w->s.open[y]; left; left &= left - 1)
            w->far2[TILE * y + (unsigned)__builtin_ctz(left)] = -1.0f;
}

/* Begin with nothing found. */
static void look_at_all(tile_boxes *w) {
    for (unsigned i = 0; i < TILE_RAYS + VF_N; i += VF_N)
        f_store(w->far2 + i, f_set(INFINITY));
    look_with_open(w);
}

/* Returns whether an open ray of the rectangle has no surface nearer than the squared distance
 * near2. True if near2 is NaN. */
SIMD bool in_sight(const tile_boxes *w, tile_rect r, float near2) {
    enum { LANES = (1u << VF_N) - 1 };
    const vf at = f_set(near2 * SURELY);
    const unsigned columns = row_mask(r);
    for (unsigned y = r.y0; y <= r.y1; y++)
        for (unsigned x = r.x0; x <= r.x1; x += VF_N)
            if (~mf_bits(f_lt(f_load(w->far2 + TILE * y + x), at)) & columns >> x & LANES)
                return true;
    return false;
}

/* ---- Boxes ---- */

/* Eight boxes, their planes relative to the eye. AVX-512 has idle lanes. */
enum { BOX_LANES = VF_N > 8 ? VF_N : 8 };

typedef struct near_boxes {
    _Alignas(64) float lo[3][BOX_LANES], hi[3][BOX_LANES];
} near_boxes;

typedef struct box_rects {
    tile_rects rects;
    _Alignas(64) float near2[BOX_LANES]; /* their squared distances from the eye */
} box_rects;

/* Fill lanes without a box with harmless numbers. */
SIMD void leave_idle(near_boxes *b, unsigned from) {
    for (int a = 0; a < 3; a++)
        for (unsigned c = from; c < BOX_LANES; c++)
            b->lo[a][c] = b->hi[a][c] = 0.0f;
}

/* Project VF_N boxes, from `lane` on. */
SIMD void rects_of_planes(const tile_boxes *w, const vf lo[3], const vf hi[3], unsigned lane,
                          const tile_rect *parent, box_rects *out) {
    const projection *p = w->view.p;
    const vf zero = f_set(0.0f);
    children_entries c = {.far = zero};
    vf near2 = zero;
    for (int a = 0; a < 3; a++) {
        const vf outside_of = f_max(f_max(lo[a], f_set(-0.0f) - hi[a]), zero);
        near2 = near2 + outside_of * outside_of;
        c.x.lo[a] = lo[a] * f_set(p->axis[a][0]);
        c.x.hi[a] = hi[a] * f_set(p->axis[a][0]);
        c.y.lo[a] = lo[a] * f_set(p->axis[a][1]);
        c.y.hi[a] = hi[a] * f_set(p->axis[a][1]);
        c.w.lo[a] = lo[a] * f_set(p->axis[a][2]);
        c.w.hi[a] = hi[a] * f_set(p->axis[a][2]);
        c.far = c.far + f_max(f_abs(lo[a]), f_abs(hi[a])) * f_set(p->axis[a][3]);
    }
    f_store(out->near2 + lane, near2);
    tile_rects_of_entries(&w->view, &c, lane, parent, &out->rects);
}

SIMD void rects_of_boxes(const tile_boxes *w, const near_boxes *b, const tile_rect *parent,
                         box_rects *out) {
    out->rects.alive = 0;
    for (unsigned lane = 0; lane < 8; lane += VF_N) {
        vf lo[3], hi[3];
        for (int a = 0; a < 3; a++) {
            lo[a] = f_load(b->lo[a] + lane);
            hi[a] = f_load(b->hi[a] + lane);
        }
        rects_of_planes(w, lo, hi, lane, parent, out);
    }
    out->rects.alive &= 255u;
}

/* Sort the children in `left`, the farthest first. */
SIMD unsigned by_distance(const float near2[BOX_LANES], unsigned left, uint8_t order[8]) {
    unsigned count = 0;
    for (; left; left &= left - 1) {
        const unsigned c = (unsigned)__builtin_ctz(left);
        unsigned at = count++;
        for (; at > 0 && near2[order[at - 1]] < near2[c]; at--)
            order[at] = order[at - 1];
        order[at] = (uint8_t)c;
    }
    return count;
}

/* ---- Trees ---- */

/* A node still to be visited. */
typedef struct tile_pending {
    uint32_t level, i;
    tile_rect rect;
    float near2;
} tile_pending;

enum { TREE_STACK_MAX = TREELET_TREE_LEVELS_MAX * TREELET_TREE_ARITY };

/* Put the children in `left` on a stack, the nearest on top. */
SIMD int push_boxes(const box_rects *boxes, unsigned left, tile_pending *stack, int top) {
    uint8_t order[8];
    const unsigned count = by_distance(boxes->near2, left, order);
    for (unsigned k = 0; k < count; k++) {
        stack[top].i = order[k];
        stack[top].rect = boxes->rects.of[order[k]];
        stack[top++].near2 = boxes->near2[order[k]];
    }
    return top;
}

/* What a walk does with a tree's boxes; all but visit may be NULL. */
typedef struct tile_visitor {
    void (*visit)(void *work, const tile_pending *box);
    void (*queued)(void *work, uint32_t box); /* it may be visited soon */
    void (*next)(void *work, uint32_t box);   /* it is visited next, unless it is hidden by then */
} tile_visitor;

/* Visit the active boxes of a tree that the tile's rays look at. */
SIMD void walk_tree(tile_boxes *w, const treelet_tree *tree, tile_rect rect, float near2,
                    const tile_visitor *v, void *work) {
    tile_pending stack[TREE_STACK_MAX];
    int top = 0;
    if (tree->active[tree->levels - 1][0])
        stack[top++] = (tile_pending){tree->levels - 1, 0, rect, near2};
    while (top > 0) {
        const tile_pending p = stack[--top];
        if (!in_sight(w, p.rect, p.near2))
            continue;
        if (p.level == 0) {
            if (v->next && top > 0 && stack[top - 1].level == 0)
                v->next(work, stack[top - 1].i);
            v->visit(work, &p);
            continue;
        }
        uint32_t count, first = treelet_tree_children(tree, p.level, p.i, &count);
        near_boxes b;
        box_rects boxes;
        unsigned active = 0;
        for (uint32_t c = 0; c < count; c++) {
            const float *bounds = tree->bounds[p.level - 1][first + c];
            active |= (unsigned)tree->active[p.level - 1][first + c] << c;
            for (int a = 0; a < 3; a++) {
                b.lo[a][c] = (float)((double)bounds[a] - w->eye[a]);
                b.hi[a][c] = (float)((double)bounds[a + 3] - w->eye[a]);
            }
        }
        leave_idle(&b, count);
        w->s.counters->nodes++;
        rects_of_boxes(w, &b, &p.rect, &boxes);
        const int bottom = top;
        top = push_boxes(&boxes, boxes.rects.alive & active, stack, top);
        for (int k = bottom; k < top; k++) {
            stack[k].i += first;
            stack[k].level = p.level - 1;
            if (v->queued && p.level == 1)
                v->queued(work, stack[k].i);
        }
    }
}

/* ---- Treelets ---- */

/* Returns which of VD_N rays pass through a box before their nearest hit so far. */
SIMD unsigned rays_through(const tile_boxes *w, const double lo[3], const double hi[3],
                           unsigned i) {
    const tile_rays *rays = &w->s.rays;
    const vd d[3] = {d_load(rays->d[0] + i), d_load(rays->d[1] + i), d_load(rays->d[2] + i)};
    double from_eye[2][3];
    for (int a = 0; a < 3; a++) {
        from_eye[0][a] = lo[a] - w->eye[a];
        from_eye[1][a] = hi[a] - w->eye[a];
    }
    return box_interval_meets(d, from_eye[0], from_eye[1], d_load(rays->t0 + i),
                              d_min(d_load(rays->t1 + i), d_load(w->s.reach + i)));
}

/* Suspend rays that pass an absent treelet. */
static inline void wait_for_treelet(tile_boxes *w, uint32_t t, tile_rect r) {
    const float *bounds = w->s.f->tracer->treelets->tree->bounds[0][t];
    const double lo[3] = {bounds[0], bounds[1], bounds[2]};
    const double hi[3] = {bounds[3], bounds[4], bounds[5]};
    tile_outcome *out = w->s.out;
    unsigned any = 0;
    for (unsigned y = r.y0; y <= r.y1; y++) {
        unsigned passing = 0;
        for (unsigned x = r.x0 & ~(VD_N - 1u); x <= r.x1; x += VD_N)
            passing |= (rays_through(w, lo, hi, TILE * y + x) & ((1u << VD_N) - 1u)) << x;
        passing &= w->s.open[y] & row_mask(r);
        out->waits[y] |= (tile_row)passing;
        w->s.open[y] &= ~(tile_row)passing;
        any |= passing;
    }
    if (any)
        look_with_open(w);
    if (any)
        tile_absent(out, t, 0);
}

/* Returns a treelet that the tile's rays look at. NULL: it is absent, and the rays that pass it are
 * suspended. */
static inline const treelet *treelet_in_sight(tile_boxes *w, const tile_pending *p) {
    const tracer *tr = w->s.f->tracer;
    if (!w->s.has_rays) {
        tile_state_rays(&w->s);
        look_with_open(w);
    }
    const treelet *at = loader_lookup(tr->treelets, p->i);
    if (!at) {
        wait_for_treelet(w, p->i, p->rect);
        return NULL;
    }
    tracer_touch(tr, p->i); /* judged by rectangles alone */
    return at;
}

/* ---- A tile ---- */

SIMD void tile_boxes_begin(tile_boxes *w, const frame *f, const tile_order *order, uint32_t x0,
                           uint32_t y0, const tile_row asked[], tile_outcome *out,
                           ray_counters *counters) {
    tile_state_begin(&w->s, f, order, TILE_LAYERS, x0, y0, asked, out, counters);
    w->view = tile_view_of(f, x0, y0);
    for (int a = 0; a < 3; a++)
        w->eye[a] = f->projection->eye[a];
}

/* Begin a walk from the eye: its rectangle. */
SIMD tile_rect tile_boxes_again(tile_boxes *w) {
    look_at_all(w);
    return (tile_rect){0, TILE - 1, 0, TILE - 1};
}

#endif
#endif
