#include "render/walk/tree_pieces.h"

#include "formats/base/box3.h"
#include "render/walk/box_interval.h"
#include "render/walk/tree_passage.h"
#include "render/walk/tree_walks.h"

static segment_key key_of(const segment *s) {
    return (segment_key){s->t0, s->cell};
}

/* ---- Pieces ahead ---- */

/* Drop the piece with the greatest key. */
static void drop(segments_state *s) {
    s->limit = key_of(&s->ahead[--s->count]);
}

void tree_pieces_hold(segments_state *s, const segment *piece) {
    const segment_key key = key_of(piece);
    if (!segment_key_less(s->last, key) || !segment_key_less(key, s->limit))
        return;
    if (s->count == s->room && segment_key_less(key_of(&s->ahead[s->count - 1]), key)) {
        s->limit = key;
        return;
    }
    if (s->count == s->room)
        drop(s);
    uint32_t at = s->count++;
    for (; at > 0 && segment_key_less(key, key_of(&s->ahead[at - 1])); at--)
        s->ahead[at] = s->ahead[at - 1];
    s->ahead[at] = *piece;
}

/* Returns how many of the held pieces begin before t. No piece found later, which begins at t or
 * behind it, can come before them. */
static uint32_t held_before(const segments_state *s, double t) {
    uint32_t n = 0;
    while (n < s->count && s->ahead[n].t0 < t)
        n++;
    return n;
}

/* ---- Treelets ---- */

/* Treelet t is absent. Hold a piece of doubt all along its box. */
static void hold_doubt(const tracer *tr, const ray *r, segments_state *s, uint32_t t) {
    const box_line slabs = box_line_of(r);
    double box[2][3];
    box_interval in;
    box3_of_floats(tr->treelets->tree->bounds[0][t], box);
    if (!box_interval_in(&slabs, box[0], box[1], &in) || !(in.t_in < in.t_out))
        return;
    const segment doubt = segment_doubt(tr, t, SEGMENT_BESIDE, in.t_in, in.t_out);
    tree_pieces_hold(s, &doubt);
}

/* Go on from the last treelet entered, until a piece can be given out. SEGMENTS_END: no piece is
 * left, except pieces that were dropped. */
static segments_result go_on(const tracer *tr, const ray *r, segments_state *state,
                             ray_counters *counters) {
    const hit after = hit_behind(state->last.t0);
    tree_passages s;
    bool resuming = state->blocked != LEAF_NO_TREELET;
    tree_passage at = {state->t_from, resuming ? state->blocked : state->entered};
    tree_passages_begin(&s, tr->treelets->tree, r, &after, counters);
    for (;; resuming = false) {
        if (!resuming) {
            const tree_passage next = tree_passages_next(&s, at, state->limit.t0);
            const bool none = next.t == LEAF_NO_TREELET;
            state->sure = none ? state->count : held_before(state, next.t_in);
            if (none || state->sure > 0)
                return state->sure > 0 ? SEGMENTS_SOME : SEGMENTS_END;
            at = next;
        }
        const treelet *here =
            tracer_enter(tr, at.t, at.t_in, &state->t_from, &state->blocked, &state->provisional);
        if (!here && state->blocked != LEAF_NO_TREELET)
            return SEGMENTS_BLOCKED;
        state->blocked = LEAF_NO_TREELET;
        state->t_from = at.t_in;
        state->entered = at.t;
        if (here)
            tr->kind->inside->pieces(tr, here, r, &after, state, counters);
        else if (tr->doubts)
            hold_doubt(tr, r, state, at.t);
    }
}

segments_result tree_pieces(const tracer *tr, const ray *r, segments_state *state,
                            ray_counters *counters) {
    segments_result result = go_on(tr, r, state, counters);
    while (result == SEGMENTS_END && state->limit.t0 < INFINITY) {
        /* Begin once more, behind the pieces that were given out. */
        state->limit = (segment_key){INFINITY, 0};
        state->t_from = -INFINITY;
        state->entered = LEAF_NO_TREELET;
        result = go_on(tr, r, state, counters);
    }
    return result;
}
