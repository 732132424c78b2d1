#include "render/walk/tree_hits.h"

#include "render/walk/tree_passage.h"
#include "render/walk/tree_walks.h"

trace_result tree_hits_next(const tracer *tr, const ray *r, trace_state *state,
                            ray_counters *counters) {
    const treelet_walks *inside = tr->kind->inside;
    tree_passages s;
    bool resuming = state->blocked != LEAF_NO_TREELET;
    tree_passage at = {resuming ? state->t_from : -INFINITY, resuming ? state->blocked : 0};
    tree_passages_begin(&s, tr->treelets->tree, r, &state->after, counters);
    for (;; resuming = false) {
        if (!resuming) {
            at = tree_passages_next(&s, at, state->best.t);
            if (at.t == LEAF_NO_TREELET)
                return hit_exists(&state->best) ? TRACE_HIT : TRACE_MISS;
        }
        const treelet *here =
            tracer_enter(tr, at.t, at.t_in, &state->t_from, &state->blocked, &state->provisional);
        if (!here && state->blocked != LEAF_NO_TREELET)
            return TRACE_BLOCKED;
        if (here && inside->hits(tr, here, r, state, counters) && state->any)
            return TRACE_HIT;
    }
}
