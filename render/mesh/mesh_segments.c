#include "render/mesh/mesh_segments.h"

#include "render/mesh/mesh_chain.h"
#include "render/mesh/mesh_walk.h"
#include "render/walk/tree_pieces.h"

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

/* Make the segment of a tet's piece, cut to the ray. Returns false if the piece has no length. */
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
    tree_pieces_hold(c->state, &s);
}

static void visit_tet(void *ctx, const resident_mesh *at, uint32_t local, const tet *x) {
    const collector *c = ctx;
    tet_piece p;
    if (tet_segment(x, c->r, &p))
        visit_passed(ctx, at, local, &p);
}

void mesh_pieces(const tracer *tr, const treelet *found, const ray *r, const hit *after,
                 segments_state *state, ray_counters *counters) {
    const resident_mesh *at = resident_mesh_of(found);
    collector c = {r, state, tr->above};
    const mesh_walk_visitor visitor = {.visit = visit_tet, .ctx = &c};
    if (at->faces)
        mesh_chain_each(at, r, state->limit.t0, visit_passed, &c, counters);
    else
        mesh_walk_each(at, r, after, state->limit.t0, &visitor, counters);
}

/* Bound of the rounding of a value, relative to the largest one: at the ends of a piece, and by
 * cut(). */
#define VALUE_ROUNDING (TET_VALUE_ROUNDING + 14.0 * 0x1p-53)

segments_error mesh_segments_error(const tracer *tr, const ray *r, const double range[2]) {
    const double *widest = tr->treelets->tree->widest;
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
