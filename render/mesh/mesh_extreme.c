#include "render/mesh/mesh_extreme.h"

#include "render/mesh/mesh_segments.h"
#include "render/mesh/mesh_walk.h"

typedef struct extreme_search {
    const ray *r;
    extreme_state *s;
    quantizer codes;
} extreme_search;

static double score_of(const extreme_search *c, double value) {
    return c->s->least ? -value : value;
}

/* Choose the children that may have a value as good as the best found. */
static unsigned choose(void *ctx, const resident_mesh *at, uint32_t node) {
    const extreme_search *c = ctx;
    const mesh_codes *of = &mesh_leaf_codes(at->values)[node];
    const double value = extreme_value(c->s);
    unsigned chosen = 0;
    if (!extreme_found(c->s))
        return 255u;
    for (unsigned i = 0; i < MESH_CHILDREN; i++) {
        const bool may = c->s->least ? of->lo[i] <= quantizer_floor(&c->codes, value)
                                     : of->hi[i] >= quantizer_ceil(&c->codes, value);
        chosen |= (unsigned)may << i;
    }
    return chosen;
}

static void try_tet(void *ctx, const resident_mesh *at, uint32_t local, const tet *x) {
    const extreme_search *c = ctx;
    double most = -INFINITY;
    segment piece;
    (void)local;
    for (int k = 0; k < 4; k++)
        most = fmax(most, score_of(c, (double)x->f[k]));
    if (most < c->s->score || !mesh_piece(x, c->r, &piece))
        return;
    extreme_offer(c->s, fmin(score_of(c, piece.b[0]), most), piece.t0, at->head.id);
    extreme_offer(c->s, fmin(score_of(c, piece.b[1]), most), piece.t1, at->head.id);
}

void mesh_extremes(const tracer *tr, const treelet *at, const ray *r, const ray *part,
                   extreme_state *s, ray_counters *counters) {
    const float *own = tracer_range(tr, at->id);
    extreme_search c = {r, s, quantizer_of(own[0], own[1], SAMPLE_F32)};
    const hit before = hit_before_all();
    const mesh_walk_visitor visitor = {try_tet, choose, &c, NULL};
    mesh_walk_each(resident_mesh_of(at), part, &before, INFINITY, &visitor, counters);
}
