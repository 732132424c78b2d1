/* block_way.h - a ray's way through a treelet with nodes that are taken whole (homogeneous.h).
 *
 * The way is a row of stretches: each passes one whole node, or the blocks between two of them.
 */
#ifndef RENDER_GRID_BLOCK_WAY_H
#define RENDER_GRID_BLOCK_WAY_H

#include <math.h>

#include "render/ray/segments.h"
#include "stream/grid_resident.h"

/* The way along an axis, by blocks of 4 cells. */
typedef struct block_axis_way {
    const double *planes; /* t of each plane between cells, in the ray's order */
    uint32_t leaves;      /* the plane where it leaves its block */
    uint32_t left;        /* blocks after this one; 0: it stays in this one */
    uint32_t at;          /* number of its block */
    bool back;            /* block numbers fall along the ray */
} block_axis_way;

typedef struct block_way {
    block_axis_way axis[3];
    double t_in, t_out; /* still to be passed */
    bool done;
} block_way;

/* A stretch of the way: through one node that is taken whole, or through blocks outside of such
 * nodes. */
typedef struct block_stretch {
    double t_in, t_out;
    uint32_t node;  /* the node's first block in Morton order */
    unsigned whole; /* as in active_masks.whole; 0: none */
    bool active;    /* some block has active cells */
} block_stretch;

static inline uint32_t block_way_morton(const block_way *w) {
    static const uint16_t spread[1 << (LEAF_CELLS_LOG2_MAX - LEAF_BLOCK_LOG2)] = {
        0, 1, 8, 9, 64, 65, 72, 73, 512, 513, 520, 521, 576, 577, 584, 585};
    uint32_t morton = 0;
    for (int a = 0; a < 3; a++)
        morton |= (uint32_t)spread[w->axis[a].at] << a;
    return morton;
}

static inline double block_way_leaves(const block_axis_way *x) {
    return x->left > 0 ? x->planes[x->leaves] : INFINITY;
}

/* Step out of the block. Sets *t_out to where the ray leaves it, w->t_out at the latest. */
static inline void block_way_step(block_way *w, double *t_out) {
    unsigned first = 0;
    for (unsigned a = 1; a < 3; a++)
        if (block_way_leaves(&w->axis[a]) < block_way_leaves(&w->axis[first]))
            first = a;
    block_axis_way *x = &w->axis[first];
    w->done = !(block_way_leaves(x) < w->t_out);
    *t_out = w->done ? w->t_out : block_way_leaves(x);
    if (w->done)
        return;
    w->t_in = *t_out;
    x->leaves += 1u << LEAF_BLOCK_LOG2;
    x->left--;
    x->at += x->back ? -1u : 1u;
}

/* block_way_next() - sets *s to the next stretch that has a length. Returns false when none is
 * left. */
static inline bool block_way_next(block_way *w, const active_masks *masks, block_stretch *s) {
    bool found = false;
    *s = (block_stretch){0};
    while (!w->done) {
        const block_way before = *w;
        const uint32_t block = block_way_morton(w);
        const unsigned whole = masks->whole[block];
        const uint32_t node = whole ? block >> 3 * (whole - 1) << 3 * (whole - 1) : 0;
        double t_out;
        block_way_step(w, &t_out);
        if (!(before.t_in < t_out))
            continue;
        if (found && (whole != s->whole || node != s->node)) {
            *w = before;
            return true;
        }
        if (!found)
            *s = (block_stretch){.t_in = before.t_in, .node = node, .whole = whole};
        s->t_out = t_out;
        s->active |= masks->cells[block] != 0;
        found = true;
    }
    return found;
}

/* ---- Pieces ---- */

/* block_way_piece() - returns the piece of a whole node or treelet with values in range[0] ..
 * range[1]. */
static inline segment block_way_piece(const double range[2], double t_in, double t_out) {
    const double middle = 0.5 * range[0] + 0.5 * range[1];
    return (segment){.t0 = t_in + 0.0,
                     .t1 = t_out + 0.0,
                     .b = {middle, middle, middle, middle},
                     .spread = segment_spread(range, middle),
                     .degree = 3};
}

/* block_way_node() - returns the piece of a whole node of a resident treelet. */
static inline segment block_way_node(const leaf_file *f, const leaf_layout *layout,
                                     const resident_grid *at, const block_stretch *node) {
    const uint32_t p = leaf_layout_samples(layout, at->head.set, at->head.id);
    double range[2];
    active_range(f, p, at->head.payload, at->shape.node_levels + 1 - node->whole,
                 node->node >> 3 * (node->whole - 1), range);
    segment s = block_way_piece(range, node->t_in, node->t_out);
    s.treelet = at->head.id;
    return s;
}

/* block_way_treelet() - returns the piece of treelet t taken whole. */
static inline segment block_way_treelet(const tracer *tr, uint32_t t, double t_in, double t_out) {
    const float *own = tr->treelets->file->own[leaf_layout_samples(tr->layout, tr->set, t)];
    segment s = block_way_piece((const double[2]){(double)own[0], (double)own[1]}, t_in, t_out);
    s.treelet = t;
    return s;
}

#endif
