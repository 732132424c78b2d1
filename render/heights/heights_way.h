/* heights_way.h - the cells of a treelet on a ray's way, in order: nodes of 16, 4 and 1 cells on a
 * side, 4 x 4 in each other.
 *
 * As long as all of the way lies over one node, it is cut to that node's elevations, and goes on in
 * it: seen from above, most rays come down to a cell without a step. Then nodes are stepped through
 * from plane to plane. The planes' t are the kernel's own (plane - o) / d (heights_patch.h), and a
 * crossing at the very start counts as still to come. So no cell that the kernel accepts is left
 * out, however short the visit. Nodes whose elevations the ray does not meet are left out, and the
 * way in a node is cut to where it does: the margin of both is more than rounding.
 */
#ifndef RENDER_HEIGHTS_HEIGHTS_WAY_H
#define RENDER_HEIGHTS_HEIGHTS_WAY_H

#include "render/heights/heights_field.h"

enum { HEIGHTS_WAY_LEVELS = 3, HEIGHTS_WAY_LOG2 = 2 };

/* Nodes of one size, of those in a node of the next size. */
typedef struct heights_nodes {
    int at[2];        /* the current one, in the treelet, along axes 0 and 2 */
    int lo[2], hi[2]; /* the first ones, and those behind the last ones */
    double t_in, t_end;
    double t[2]; /* where the ray leaves the current one, along each axis */
    bool inside; /* it is one of them */
} heights_nodes;

typedef struct heights_way {
    const heights_block *b;
    const ray *r;
    double slack; /* of elevations */
    int top;      /* the level where it begins */
    int level;
    heights_nodes of[HEIGHTS_WAY_LEVELS];
} heights_way;

/* The t of a plane before a cell of the treelet. */
static inline double heights_plane(const heights_way *w, int axis, int cell) {
    const double at = (double)(w->b->of->first_cell[2 * axis] + (uint32_t)cell) * w->b->size;
    return (at - w->r->o[2 * axis]) / w->r->d[2 * axis];
}

/* Find the node that the ray is in at n->t_in. */
static inline void heights_way_find(const heights_way *w, heights_nodes *n, int log2, int axis) {
    const double d = w->r->d[2 * axis];
    const double x = d == 0.0 ? w->r->held[2 * axis] : w->r->o[2 * axis] + n->t_in * d;
    const double cells = x * w->b->inverse - (double)w->b->of->first_cell[2 * axis];
    const double guess = cells * (1.0 / (double)(1 << log2));
    const int last = n->hi[axis] - 1, step = d < 0.0 ? -1 : 1;
    int i = !(guess > n->lo[axis]) ? n->lo[axis] : guess < last ? (int)guess : last;
    n->at[axis] = i;
    if (d == 0.0) {
        n->t[axis] = INFINITY;
        return;
    }
    double far = heights_plane(w, axis, (i + (step > 0)) << log2);
    for (; far < n->t_in && i + step >= n->lo[axis] && i + step <= last; i += step)
        far = heights_plane(w, axis, (i + step + (step > 0)) << log2);
    for (; i - step >= n->lo[axis] && i - step <= last; i -= step) {
        const double near = heights_plane(w, axis, (i + (step < 0)) << log2);
        if (near < n->t_in)
            break;
        far = near;
    }
    n->at[axis] = i;
    n->t[axis] = far;
}

/* Go on behind the current node. Where both planes are crossed at one t, axis 0 is first. */
static inline void heights_way_step(const heights_way *w, heights_nodes *n, int log2) {
    const int axis = n->t[0] <= n->t[1] ? 0 : 1, step = w->r->d[2 * axis] < 0.0 ? -1 : 1;
    if (!(n->t[axis] <= n->t_end)) {
        n->inside = false;
        return;
    }
    n->t_in = n->t[axis];
    n->at[axis] += step;
    n->inside = n->at[axis] >= n->lo[axis] && n->at[axis] < n->hi[axis];
    if (n->inside)
        n->t[axis] = heights_plane(w, axis, (n->at[axis] + (step > 0)) << log2);
}

static inline double heights_way_out(const heights_nodes *n) {
    return heights_least(heights_least(n->t[0], n->t[1]), n->t_end);
}

/* Cut [*t_in, *t_out] to where the ray's elevation is in a range. False: nowhere. */
static inline bool heights_way_cut(const heights_way *w, const double range[2], double *t_in,
                                   double *t_out) {
    const double least = range[0] - w->slack, most = range[1] + w->slack;
    const double o = w->r->o[1], d = w->r->d[1];
    if (d == 0.0)
        return least <= o && o <= most;
    const double first = ((d < 0.0 ? most : least) - o) / d;
    const double last = ((d < 0.0 ? least : most) - o) / d;
    *t_in = heights_most(*t_in, first);
    *t_out = heights_least(*t_out, last);
    return *t_in <= *t_out;
}

static const uint16_t heights_spread[16] = {0,   1,   8,   9,   64,  65,  72,  73,
                                            512, 513, 520, 521, 576, 577, 584, 585};

static inline uint32_t heights_morton(uint32_t i, uint32_t k) {
    return heights_spread[i] | (uint32_t)heights_spread[k] << 2;
}

/* The elevations of the node of a level that is at a place. False: no cell of it has any. */
static inline bool heights_way_range(const heights_block *b, int level, const int at[2],
                                     double range[2]) {
    const uint32_t depth =
        b->of->shape.node_levels + LEAF_BLOCK_LOG2 - (uint32_t)(level * HEIGHTS_WAY_LOG2);
    return heights_block_range(b, depth, heights_morton((uint32_t)at[0], (uint32_t)at[1]), range);
}

/* heights_way_ask() - have the cache fetch what is read at a cell. */
static inline void heights_way_ask(const heights_block *b, uint32_t i, uint32_t k) {
    const size_t width = sample_size(b->type), row = b->slice * width;
    const char *sample = (const char *)b->first + i * width + k * row;
    const uint32_t depth = b->of->shape.node_levels;
    const uint8_t *code = b->codes + leaf_codes_at(depth) +
                          heights_morton(i >> LEAF_BLOCK_LOG2, k >> LEAF_BLOCK_LOG2);
    if (depth > 0) {
        __builtin_prefetch(code);
        __builtin_prefetch(code + ((size_t)1 << 3 * depth));
    }
    __builtin_prefetch(sample);
    __builtin_prefetch(sample + row);
}

/* Which cells the ray is over between two t, on an axis: those within rounding of them, too. */
static inline void heights_way_span(const heights_way *w, int axis, double t_in, double t_out,
                                    int span[2]) {
    const ray *r = w->r;
    const double o = r->o[2 * axis], d = r->d[2 * axis];
    const double a = d == 0.0 ? r->held[2 * axis] : o + t_in * d;
    const double b = d == 0.0 ? r->held[2 * axis] : o + t_out * d;
    const double slack = 0x1p-36 * (fabs(o) + fabs(a) + fabs(b));
    const double first = (double)w->b->of->first_cell[2 * axis];
    const double last = (double)(w->b->of->shape.cells[2 * axis] - 1);
    const double lo = (heights_least(a, b) - slack) * w->b->inverse - first;
    const double hi = (heights_most(a, b) + slack) * w->b->inverse - first;
    span[0] = lo > 0.0 ? (int)heights_least(lo, last) : 0; /* NaN: all of them */
    span[1] = hi < last ? (int)heights_most(hi, 0.0) : (int)last;
}

/* Find where the ray is in the nodes that the way begins with. */
static inline void heights_way_enter_first(heights_way *w, double t_in, double t_out) {
    heights_nodes *n = &w->of[w->top];
    w->level = w->top;
    n->t_in = t_in;
    n->t_end = t_out;
    for (int axis = 0; axis < 2 && n->inside; axis++)
        heights_way_find(w, n, w->top * HEIGHTS_WAY_LOG2, axis);
}

/* Begin with the nodes under the way, of the largest size of which there are several: of one alone
 * the way is cut to its elevations. A cell alone needs no search. */
static inline void heights_way_narrow(heights_way *w, double t_in, double t_out) {
    double range[2];
    for (;; w->top--) {
        const int log2 = w->top * HEIGHTS_WAY_LOG2;
        heights_nodes *n = &w->of[w->top];
        n->inside = true;
        for (int axis = 0; axis < 2; axis++) {
            int span[2];
            heights_way_span(w, axis, t_in, t_out, span);
            n->at[axis] = n->lo[axis] = span[0] >> log2;
            n->hi[axis] = (span[1] >> log2) + 1;
        }
        if (n->hi[0] - n->lo[0] > 1 || n->hi[1] - n->lo[1] > 1) {
            heights_way_enter_first(w, t_in, t_out);
            return;
        }
        if (w->top == 0) {
            *n = (heights_nodes){.at = {n->at[0], n->at[1]},
                                 .t_in = t_in,
                                 .t_end = t_out,
                                 .t = {INFINITY, INFINITY},
                                 .inside = true};
            w->level = 0;
            return;
        }
        if (!heights_way_range(w->b, w->top, n->at, range) ||
            !heights_way_cut(w, range, &t_in, &t_out)) {
            n->inside = false;
            w->level = w->top;
            return;
        }
    }
}

/* Begin with the nodes of one eighth of the treelet. */
static inline void heights_way_in_octant(heights_way *w, unsigned octant, double t_in,
                                         double t_out) {
    const int cells_log2 = (int)w->b->of->shape.node_levels + LEAF_BLOCK_LOG2;
    const int log2 = w->top * HEIGHTS_WAY_LOG2, half = 1 << (cells_log2 - 1 - log2);
    heights_nodes *n = &w->of[w->top];
    n->inside = true;
    for (int axis = 0; axis < 2; axis++) {
        const int all = (int)(w->b->of->shape.cells[2 * axis] + (1U << log2) - 1) >> log2;
        const bool upper = (octant & (axis ? 0xF0U : 0xAAU)) != 0;
        n->lo[axis] = upper ? half : 0;
        n->hi[axis] = !upper && half < all ? half : all;
        n->inside = n->inside && n->lo[axis] < n->hi[axis];
    }
    heights_way_enter_first(w, t_in, t_out);
}

/* heights_way_begin() - octants: which eighths of the treelet (x + 4z) to look at, one or all. */
static inline void heights_way_begin(heights_way *w, const heights_block *b, const ray *r,
                                     double t_in, double t_out, unsigned octants) {
    w->b = b;
    w->r = r;
    w->slack = b->slack + 0x1p-40 * fabs(r->o[1]);
    w->level = w->top = (int)(b->of->shape.node_levels + LEAF_BLOCK_LOG2 - 1) / HEIGHTS_WAY_LOG2;
    w->of[w->top].inside = false;
    if ((octants & (octants - 1)) == 0)
        heights_way_in_octant(w, octants, t_in, t_out);
    else if (heights_way_cut(w, b->range, &t_in, &t_out))
        heights_way_narrow(w, t_in, t_out);
}

/* Go down into the current node, if the ray meets its elevations. */
static inline bool heights_way_enter(heights_way *w) {
    const heights_nodes *n = &w->of[w->level];
    heights_nodes *in = &w->of[w->level - 1];
    const uint32_t *cells = w->b->of->shape.cells;
    const int log2 = (w->level - 1) * HEIGHTS_WAY_LOG2;
    double range[2], t_in = n->t_in, t_out = heights_way_out(n);
    if (!heights_way_range(w->b, w->level, n->at, range) ||
        !heights_way_cut(w, range, &t_in, &t_out))
        return false;
    for (int axis = 0; axis < 2; axis++) {
        const int all = (int)(cells[2 * axis] + (1U << log2) - 1) >> log2;
        in->lo[axis] = n->at[axis] << HEIGHTS_WAY_LOG2;
        in->hi[axis] = in->lo[axis] + (1 << HEIGHTS_WAY_LOG2);
        in->hi[axis] = in->hi[axis] < all ? in->hi[axis] : all;
    }
    in->inside = true;
    in->t_in = t_in;
    in->t_end = t_out;
    for (int axis = 0; axis < 2; axis++)
        heights_way_find(w, in, log2, axis);
    return true;
}

/* heights_way_next() - the next cell whose elevations the ray may meet, entered at `until` or
 * before: its place in the treelet, and its patch. False: there is none. */
static inline bool heights_way_next(heights_way *w, double until, int cell[2],
                                    heights_patch *patch) {
    for (;;) {
        heights_nodes *n = &w->of[w->level];
        if (!n->inside) {
            if (w->level == w->top)
                return false;
            w->level++;
            heights_way_step(w, &w->of[w->level], w->level * HEIGHTS_WAY_LOG2);
            continue;
        }
        if (n->t_in > until)
            return false;
        if (w->level > 0) {
            if (heights_way_enter(w))
                w->level--;
            else
                heights_way_step(w, n, w->level * HEIGHTS_WAY_LOG2);
            continue;
        }
        double t_in = n->t_in, t_out = heights_way_out(n), range[2];
        cell[0] = n->at[0];
        cell[1] = n->at[1];
        heights_way_step(w, n, 0);
        if (!heights_block_patch(w->b, (uint32_t)cell[0], (uint32_t)cell[1], patch))
            continue;
        const double *h = patch->h;
        range[0] = heights_least(heights_least(h[0], h[1]), heights_least(h[2], h[3]));
        range[1] = heights_most(heights_most(h[0], h[1]), heights_most(h[2], h[3]));
        if (heights_way_cut(w, range, &t_in, &t_out))
            return true;
    }
}

#endif
