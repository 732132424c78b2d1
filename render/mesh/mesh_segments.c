#include "render/mesh/mesh_segments.h"

#include "formats/base/box3.h"
#include "render/mesh/mesh_chain.h"
#include "render/mesh/mesh_passage.h"
#include "render/mesh/mesh_tracer.h"

static segment_key key_of(const segment *s) {
    return (segment_key){s->t0, s->cell};
}

/* ---- Pieces ahead ---- */

/* Drop the piece with the greatest key. */
static void drop(segments_state *s) {
    s->limit = key_of(&s->ahead[--s->count]);
}

static void hold(segments_state *s, const segment *piece) {
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

/* Returns how many of the pieces held begin before t: they come before all that begin at t or
 * later. */
static uint32_t held_before(const segments_state *s, double t) {
    uint32_t n = 0;
    while (n < s->count && s->ahead[n].t0 < t)
        n++;
    return n;
}

/* ---- Tets ---- */

typedef struct collector {
    const ray *r;
    segments_state *state;
    double above; /* see tracer.above */
} collector;

/* Cut a piece to the ray's [t0, t1]. A new end gets the linear value there. */
static void cut(const tet_piece *p, const ray *r, segment *s) {
    const double slope = (p->f[1] - p->f[0]) / (p->t[1] - p->t[0]);
    s->t0 = p->t[0];
    s->t1 = p->t[1];
    s->b[0] = p->f[0];
    s->b[1] = p->f[1];
    if (s->t0 < r->t0) {
        s->t0 = r->t0;
        s->b[0] = p->f[0] + (r->t0 - p->t[0]) * slope;
    }
    if (s->t1 > r->t1) {
        s->t1 = r->t1;
        s->b[1] = p->f[0] + (r->t1 - p->t[0]) * slope;
    }
}

/* False: the piece has no length. */
static bool piece_of(const tet_piece *p, const ray *r, segment *s) {
    if (!(p->t[0] < p->t[1]))
        return false;
    s->degree = 1;
    cut(p, r, s);
    return s->t0 < s->t1;
}

bool mesh_piece(const tet *x, const ray *r, segment *s) {
    tet_piece p;
    return tet_segment(x, r, &p) && piece_of(&p, r, s);
}

static bool is_even(const resident_mesh *at, uint32_t local) {
    const tet x = mesh_walk_tet(at, local);
    return x.f[0] == x.f[1] && x.f[0] == x.f[2] && x.f[0] == x.f[3];
}

static void visit_passed(void *ctx, const resident_mesh *at, uint32_t local, const tet_piece *p) {
    const collector *c = ctx;
    segment s = {.cell = at->first_tet + local, .treelet = at->head.id};
    if (!piece_of(p, c->r, &s))
        return;
    if (p->f[0] == p->f[1] && is_even(at, local))
        s.spread = SEGMENT_EVEN;
    for (int end = 0; end < 2; end++)
        s.b[end] -= c->above;
    hold(c->state, &s);
}

static void visit_tet(void *ctx, const resident_mesh *at, uint32_t local, const tet *x) {
    const collector *c = ctx;
    tet_piece p;
    if (tet_segment(x, c->r, &p))
        visit_passed(ctx, at, local, &p);
}

/* ---- Treelets ---- */

/* Treelet t is absent. Hold a piece of doubt all along its box. */
static void hold_doubt(const tracer *tr, const ray *r, segments_state *s, uint32_t t) {
    const mesh_slabs slabs = mesh_slabs_of(r);
    double box[2][3];
    mesh_interval in;
    box3_of_floats(mesh_rays_of(tr)->tree->bounds[0][t], box);
    if (!mesh_interval_in(&slabs, box[0], box[1], &in) || !(in.t_in < in.t_out))
        return;
    const segment doubt = segment_doubt(tr, t, SEGMENT_BESIDE, in.t_in, in.t_out);
    hold(s, &doubt);
}

/* Go on from the last treelet entered, until a piece is sure. SEGMENTS_END: there are no more,
 * except those that were dropped. */
static segments_result go_on(const tracer *tr, const ray *r, segments_state *state,
                             ray_counters *counters) {
    const hit after = hit_behind(state->last.t0);
    collector c = {r, state, tr->above};
    mesh_passages s;
    bool resuming = state->blocked != LEAF_NO_TREELET;
    mesh_passage at = {state->t_from, resuming ? state->blocked : state->entered};
    const mesh_walk_visitor visitor = {.visit = visit_tet, .ctx = &c};
    mesh_passages_begin(&s, mesh_rays_of(tr)->tree, r, &after, counters);
    for (;; resuming = false) {
        if (!resuming) {
            const mesh_passage next = mesh_passages_next(&s, at, state->limit.t0);
            const bool none = next.t == LEAF_NO_TREELET;
            state->sure = none ? state->count : held_before(state, next.t_in);
            if (none || state->sure > 0)
                return state->sure > 0 ? SEGMENTS_SOME : SEGMENTS_END;
            at = next;
        }
        const resident_mesh *here = resident_mesh_of(
            tracer_enter(tr, at.t, at.t_in, &state->t_from, &state->blocked, &state->provisional));
        if (!here && !tr->preview)
            return SEGMENTS_BLOCKED;
        state->blocked = LEAF_NO_TREELET;
        state->t_from = at.t_in;
        state->entered = at.t;
        if (!here && tr->doubts)
            hold_doubt(tr, r, state, at.t);
        if (here && here->faces)
            mesh_chain_each(here, r, state->limit.t0, visit_passed, &c, counters);
        else if (here)
            mesh_walk_each(here, r, &after, state->limit.t0, &visitor, counters);
    }
}

segments_result mesh_segments(const tracer *tr, const ray *r, segments_state *state,
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

/* Rounding of a value: of the ends', and of cut(). */
#define VALUE_ROUNDING (TET_VALUE_ROUNDING + 14.0 * 0x1p-53)

segments_error mesh_segments_error(const tracer *tr, const ray *r, const double range[2]) {
    const double *widest = mesh_rays_of(tr)->tree->widest;
    double reach = 0.0, across = 0.0, dd = 0.0;
    for (int a = 0; a < 3; a++) {
        const double far = fmax(fabs(tr->box[0][a] - r->o[a]), fabs(tr->box[1][a] - r->o[a]));
        across += fabs(r->d[a]) * widest[a];
        reach += fabs(r->d[a]) * far;
        dd += r->d[a] * r->d[a];
    }
    return (segments_error){.t = (TET_MEAN_ERROR * across + TET_T_ROUNDING * reach) / dd,
                            .value = TET_MEAN_ERROR * (range[1] - range[0]) +
                                     VALUE_ROUNDING * fmax(fabs(range[0]), fabs(range[1]))};
}
