#include "render/ray/extremes.h"

#include "render/ray/kind.h"

static const extreme_way none = {.t = LEAF_NO_TREELET};

extreme_state extreme_begin(bool least) {
    return (extreme_state){.least = least,
                           .score = -INFINITY,
                           .t = -INFINITY,
                           .in = LEAF_NO_TREELET,
                           .doubt = (float)-INFINITY,
                           .next = none,
                           .blocked = LEAF_NO_TREELET};
}

void extreme_go_on(extreme_state *s, const tracer *tr) {
    s->of = tr;
    s->in = LEAF_NO_TREELET;
    s->next = none;
    s->blocked = LEAF_NO_TREELET;
    s->doubt = (float)-INFINITY;
}

/* ---- The order ---- */

bool extreme_way_before(const extreme_way *a, const extreme_way *b) {
    if (a->bound != b->bound)
        return a->bound > b->bound;
    if (a->t_in != b->t_in)
        return a->t_in < b->t_in;
    return a->t != b->t ? a->t < b->t : a->octants < b->octants;
}

static bool is_wanted(const extreme_ways *w, const extreme_way *way) {
    if (w->behind.t == LEAF_NO_TREELET)
        return true;
    return w->too ? !extreme_way_before(way, &w->behind) : extreme_way_before(&w->behind, way);
}

void extreme_ways_take(extreme_ways *w, const extreme_way *way) {
    if (extreme_ways_skip(w, way->bound, way->t_in) || !is_wanted(w, way))
        return;
    if (w->count == EXTREME_WAYS_MAX) {
        w->full = true;
        if (!extreme_way_before(way, &w->of[w->count - 1]))
            return;
        w->count--;
    }
    uint32_t at = w->count++;
    for (; at > 0 && extreme_way_before(way, &w->of[at - 1]); at--)
        w->of[at] = w->of[at - 1];
    w->of[at] = *way;
}

/* ---- The search ---- */

/* Search the next treelet. Returns false if it is absent and needed. */
static bool look_into(const tracer *tr, const ray *r, const extreme_way *way, extreme_state *s,
                      ray_counters *counters) {
    double t_from = 0.0;
    const treelet *at = tracer_enter(tr, way->t, way->t_in, &t_from, &s->blocked, &s->provisional);
    if (!at && s->blocked != LEAF_NO_TREELET) {
        s->next = *way;
        return false;
    }
    s->provisional |= way->octants != 0;
    if (at)
        tr->kind->walks->extreme(tr, at, r, way, s, counters);
    return true;
}

/* Search first where the neighbour found its value. Do not request the treelet if it is absent. */
static void look_near(const tracer *tr, const ray *r, const extreme_state *near, extreme_state *s,
                      ray_counters *counters) {
    const bool there = near && near->of == tr && near->in != LEAF_NO_TREELET;
    if (!there || tr->preview || extreme_found(s))
        return;
    const treelet *at = loader_lookup(tr->treelets, near->in);
    if (at)
        tr->kind->walks->extreme_near(tr, at, r, near->t, s, counters);
}

trace_result extreme_next(const tracer *tr, const ray *r, const extreme_state *near,
                          extreme_state *s, ray_counters *counters) {
    extreme_ways w;
    look_near(tr, r, near, s, counters);
    w.state = s;
    w.behind = s->next;
    w.too = true;
    do {
        w.count = 0;
        w.full = false;
        tr->kind->walks->extreme_ways(tr, r, &w, counters);
        for (uint32_t i = 0; i < w.count; i++) {
            /* Treelets that follow have no better bound or place. */
            if (!extreme_matters(s, (double)w.of[i].bound, w.of[i].t_in)) {
                w.full = false;
                break;
            }
            if (!look_into(tr, r, &w.of[i], s, counters))
                return TRACE_BLOCKED;
        }
        w.behind = w.of[w.count > 0 ? w.count - 1 : 0];
        w.too = false;
    } while (w.full);
    s->provisional |= (double)s->doubt > s->score;
    return TRACE_MISS;
}
