#include "render/mesh/mesh_chain.h"

#include <math.h>

#include "render/mesh/mesh_walk.h"
#include "render/mesh/tet_sight.h"

typedef struct chain {
    const ray *r;
    double enough; /* tets that begin behind this t are not wanted */
    mesh_chain_visit *visit;
    void *ctx;
    ray_counters *counters;
} chain;

/* Follow the chain from a tet that the ray enters by this face. */
static void follow(const chain *c, const resident_mesh *at, uint32_t local, int entered,
                   tet_sight *s) {
    tet_piece p;
    tet_sight_meet(s, entered, &p.t[0], &p.f[0]);
    s->tests = 0;
    /* Bound the loop by the number of tets, so that it ends whatever bytes a file holds. */
    for (uint32_t n = 0; n < at->mesh.tets && p.t[0] <= c->enough; n++) {
        const int left = tet_sight_leaves_by(s, entered);
        const uint32_t beyond = at->faces->beyond[local][left];
        tet_sight_meet(s, left, &p.t[1], &p.f[1]);
        c->counters->passed_tets++;
        if (at->active->tets[local / 64] >> local % 64 & 1u) {
            c->counters->cells++;
            c->visit(c->ctx, at, local, &p);
        }
        if (beyond == MESH_OUTER)
            break;
        local = beyond >> 2;
        entered = (int)(beyond & 3);
        const tet next = mesh_walk_tet(at, local);
        tet_sight_go(s, left, &next, entered);
        p.t[0] = p.t[1];
        p.f[0] = p.f[1];
    }
    c->counters->edge_tests += s->tests;
}

/* Begin a chain at a tet with outer faces, if the ray enters by one. */
static void begin(void *ctx, const resident_mesh *at, uint32_t local, const tet *x) {
    const chain *c = ctx;
    tet_sight s;
    int entered = -1;
    s.tests = 0;
    tet_sight_begin(&s, x, c->r);
    for (int k = 0; k < TET_FACES && entered < 0; k++)
        if (at->faces->beyond[local][k] == MESH_OUTER && tet_sight_crosses(&s, k)) {
            const int orientation = exact_orientation((const double(*)[3])s.p);
            if (orientation == 0)
                return;
            entered = tet_sight_enters(&s, k, orientation) ? k : entered;
        }
    if (entered >= 0)
        follow(c, at, local, entered, &s);
}

/* The ray may enter a chain before its own t0, so start at -INFINITY. The slack is more than the
 * error of t. */
void mesh_chain_each(const resident_mesh *at, const ray *r, double nearest, mesh_chain_visit *visit,
                     void *ctx, ray_counters *counters) {
    const hit first = hit_before_all();
    ray line = *r;
    line.t0 = -INFINITY;
    const double end = nearest < r->t1 ? nearest : r->t1;
    const double slack = isinf(end) ? 0.0 : box_interval_slack(at->bounds, r, end);
    chain c = {r, end + slack, visit, ctx, counters};
    const mesh_walk_visitor visitor = {.visit = begin, .ctx = &c, .among = &at->faces->outer};
    mesh_walk_each(at, &line, &first, nearest, &visitor, counters);
}
