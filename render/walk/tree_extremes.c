#include "render/walk/tree_extremes.h"

#include "render/walk/tree_passage.h"
#include "render/walk/tree_walks.h"

void tree_extreme_ways(const tracer *tr, const ray *r, extreme_ways *ways, ray_counters *counters) {
    const hit before = hit_before_all();
    tree_passages s;
    tree_passage at = {-INFINITY, 0};
    tree_passages_begin(&s, tr->treelets->tree, r, &before, counters);
    for (;;) {
        at = tree_passages_next(&s, at, INFINITY);
        if (at.t == LEAF_NO_TREELET)
            return;
        const float bound = extreme_bound(ways->state, tracer_range(tr, at.t));
        if (!extreme_ways_skip(ways, bound, at.t_in))
            extreme_ways_take(ways, &(extreme_way){.t_in = at.t_in, .bound = bound, .t = at.t});
    }
}

void tree_extreme(const tracer *tr, const treelet *at, const ray *r, const extreme_way *way,
                  extreme_state *s, ray_counters *counters) {
    (void)way;
    tr->kind->inside->extremes(tr, at, r, r, s, counters);
}

void tree_extreme_near(const tracer *tr, const treelet *at, const ray *r, double t,
                       extreme_state *s, ray_counters *counters) {
    ray part = *r;
    part.t0 = part.t1 = fmin(fmax(t, r->t0), r->t1);
    tr->kind->inside->extremes(tr, at, r, &part, s, counters);
}
