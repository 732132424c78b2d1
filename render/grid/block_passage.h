/* block_passage.h - the cells of a block on a ray's way, front to back.
 *
 * Inside a block there are no ranges of values, so the ray visits every active cell that it passes.
 * To move from cell to cell costs a comparison or two; to descend to each cell would cost a step of
 * octree_step.h. Crossings are computed and ordered as in the cell kernel: (plane - o) / d, in (t,
 * axis) order. So both agree.
 */
#ifndef RENDER_GRID_BLOCK_PASSAGE_H
#define RENDER_GRID_BLOCK_PASSAGE_H

#include "render/grid/level_planes.h"
#include "render/grid/walk.h"
#include "render/ray/ray.h"
#include "stream/active.h"

/* Along one axis: where the ray crosses the planes between cells, in its order, and the cell that
 * it is in. */
typedef struct block_axis {
    double t[BLOCK_SIDE]; /* the last: INFINITY */
    uint32_t crossed, cell;
    int step;
} block_axis;

typedef struct block_passage {
    block_axis axis[3];
    double t_in, t_out; /* still to be passed */
    uint64_t active;    /* cells: active_masks.cells of the block */
    bool done;
} block_passage;

static inline block_axis block_axis_of(const ray *r, int a, const double *plane, double t_in) {
    block_axis x = {.t = {INFINITY, INFINITY, INFINITY, INFINITY}};
    if (r->d[a] == 0.0) {
        for (int i = 1; i < BLOCK_SIDE; i++)
            x.cell += r->held[a] >= plane[i];
        return x;
    }
    const bool back = r->d[a] < 0.0;
    for (int i = 1; i < BLOCK_SIDE; i++) {
        x.t[i - 1] = (plane[back ? BLOCK_SIDE - i : i] - r->o[a]) / r->d[a];
        x.crossed += x.t[i - 1] < t_in;
    }
    x.cell = back ? BLOCK_SIDE - 1 - x.crossed : x.crossed;
    x.step = back ? -1 : 1;
    return x;
}

/* block_passage_begin() - begins the passage of the block whose first cell in its level is `first`.
 * The ray is in the block from t_in to t_out. */
static inline block_passage block_passage_begin(const level_planes *planes, const ray *r,
                                                const uint32_t first[3], uint64_t active,
                                                double t_in, double t_out) {
    block_passage p = {.t_in = t_in, .t_out = t_out, .active = active};
    for (int a = 0; a < 3; a++)
        p.axis[a] = block_axis_of(r, a, &planes->at[a][first[a]], t_in);
    return p;
}

/* Returns the axis whose next plane comes first. */
static inline unsigned block_passage_axis(const block_axis x[3]) {
    const double t[3] = {x[0].t[x[0].crossed], x[1].t[x[1].crossed], x[2].t[x[2].crossed]};
    const unsigned of_two = t[1] < t[0];
    return t[2] < t[of_two] ? 2 : of_two;
}

/* Returns whether the ray's cell is active. */
static inline bool block_passage_active(const block_passage *p) {
    static const uint8_t spread[BLOCK_SIDE] = {0, 1, 8, 9};
    const block_axis *x = p->axis;
    const unsigned bit = spread[x[0].cell] | spread[x[1].cell] << 1 | spread[x[2].cell] << 2;
    return p->active >> bit & 1u;
}

/* block_passage_next() - finds the next active cell that is passed for some length: its number
 * within the block, and *t_in where it is entered. Returns false when there is none. */
static inline bool block_passage_next(block_passage *p, uint32_t cell[3], double *t_in) {
    while (!p->done) {
        block_axis *x = p->axis;
        const unsigned a = block_passage_axis(x);
        const double from = p->t_in, next = x[a].t[x[a].crossed];
        const bool last = !(next <= p->t_out);
        const bool found = from < (last ? p->t_out : next) && block_passage_active(p);
        for (int i = 0; i < 3; i++)
            cell[i] = x[i].cell;
        p->done = last;
        p->t_in = next;
        if (!last) {
            x[a].cell += (uint32_t)x[a].step;
            x[a].crossed++;
        }
        *t_in = from;
        if (found)
            return true;
    }
    return false;
}

#endif
