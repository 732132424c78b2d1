/* grid_way.h - the treelets that a ray passes when it wants pieces (segments.h), one after the
 * other, resumable.
 */
#ifndef RENDER_GRID_GRID_WAY_H
#define RENDER_GRID_GRID_WAY_H

#include "render/grid/grid_passage.h"
#include "render/grid/stand_in.h"
#include "render/ray/segments.h"

typedef struct grid_way {
    bool resuming; /* still on the way to the treelet state->blocked */
    bool doubted;  /* the treelet to be walked has a doubt, */
    segment doubt; /* to be given before its pieces; then set state->doubted to its treelet */
    bool bounded;  /* each piece of *at tells how far it may be off (SEGMENT_BOUNDED) */
    int top;
    grid_passage stack[GRID_PASSAGES_MAX];
} grid_way;

/* grid_way_begin() - begins at the ray's start, or where *state has come to. Returns false when
 * nothing is left. */
static inline bool grid_way_begin(grid_way *w, const tracer *tr, const ray *r,
                                  const segments_state *state) {
    double t_in = fmax(r->t0, state->t_from), t_out = r->t1;
    if (!tracer_box(tr, r, &t_in, &t_out))
        return false;
    w->resuming = state->blocked != LEAF_NO_TREELET;
    w->doubted = w->bounded = false;
    w->top = 1;
    w->stack[0] = (grid_passage){t_in, t_out, 0, 0};
    return true;
}

/* grid_way_next() - finds the next treelet to be walked: *at, over *passage. *at is NULL if treelet
 * passage->t is taken whole, or if passage->t is LEAF_NO_TREELET and there is only w->doubt.
 * Returns SEGMENTS_BLOCKED or SEGMENTS_END when there is no next one; *state says why. */
static inline segments_result grid_way_next(grid_way *w, const tracer *tr, const ray *r,
                                            segments_state *state, ray_counters *counters,
                                            const resident_grid **at, grid_passage *passage) {
    while (w->top > 0) {
        const grid_passage node = w->stack[--w->top];
        /* Crossings are the cells' own: a node without length has no cell with a length. t_from is
         * the end of a piece, to the bit, so nothing before it comes again. */
        if (!(node.t_in < node.t_out))
            continue;
        if (!grid_passage_drawn(tr, &node)) {
            counters->nodes++;
            w->top = grid_passage_push(tr, r, &node, w->stack, w->top, NULL);
            continue;
        }
        const bool whole = tr->treelets->whole[node.t];
        if (!(tr->treelets->own[node.t] || whole) ||
            (w->resuming && !tracer_resumes(tr, node.t, state->blocked)))
            continue;
        *passage = node;
        *at = NULL;
        w->doubted = w->bounded = false;
        if (whole)
            return SEGMENTS_SOME;
        *at = resident_grid_of(tracer_enter(tr, node.t, node.t_in, &state->t_from, &state->blocked,
                                            &state->provisional));
        if (!*at && state->blocked != LEAF_NO_TREELET)
            return SEGMENTS_BLOCKED;
        w->resuming = false;
        state->blocked = LEAF_NO_TREELET;
        if (*at)
            return SEGMENTS_SOME;
        const stand_in found = stand_in_for(tr, node.t);
        if (found.t == LEAF_NO_TREELET && !tr->doubts)
            continue;
        w->bounded =
            tr->doubts && found.at && found.at->wide && stand_in_is_bounded(tr, node.t, &found);
        w->doubted = tr->doubts && state->doubted != node.t;
        if (w->doubted)
            w->doubt = segment_doubt(tr, node.t, w->bounded ? SEGMENT_BOUNDED : SEGMENT_GUESSED,
                                     node.t_in, node.t_out);
        passage->t = found.t;
        *at = found.at;
        return SEGMENTS_SOME;
    }
    state->t_from = INFINITY;
    return SEGMENTS_END;
}

#endif
