#include "render/mesh/mesh_extreme.h"

#include "render/mesh/mesh_passage.h"
#include "render/mesh/mesh_segments.h"
#include "render/mesh/mesh_tracer.h"

static const float *range_of(const tracer *tr, uint32_t t) {
    return tr->treelets->file->own[leaf_layout_samples(tr->layout, tr->set, t)];
}

void mesh_extreme_ways(const tracer *tr, const ray *r, extreme_ways *ways, ray_counters *counters) {
    const hit before = hit_before_all();
    mesh_passages s;
    mesh_passage at = {-INFINITY, 0};
    mesh_passages_begin(&s, mesh_rays_of(tr)->tree, r, &before, counters);
    for (;;) {
        at = mesh_passages_next(&s, at, INFINITY);
        if (at.t == LEAF_NO_TREELET)
            return;
        const float bound = extreme_bound(ways->state, range_of(tr, at.t));
        if (!extreme_ways_skip(ways, bound, at.t_in))
            extreme_ways_take(ways, &(extreme_way){.t_in = at.t_in, .bound = bound, .t = at.t});
    }
}

/* ---- In a treelet ---- */

typedef struct climb {
    const ray *r;
    extreme_state *s;
    quantizer codes;
} climb;

static double score_of(const climb *c, double value) {
    return c->s->least ? -value : value;
}

/* Choose the children that may have a value as good as the best found. */
static unsigned choose(void *ctx, const resident_mesh *at, uint32_t node) {
    const climb *c = ctx;
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
    const climb *c = ctx;
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

/* Search the tets of a treelet whose boxes the ray meets within `part`. */
static void climb_part(const tracer *tr, const treelet *at, const ray *r, const ray *part,
                       extreme_state *s, ray_counters *counters) {
    const float *own = range_of(tr, at->id);
    climb c = {r, s, quantizer_of(own[0], own[1], SAMPLE_F32)};
    const hit before = hit_before_all();
    const mesh_walk_visitor visitor = {try_tet, choose, &c, NULL};
    mesh_walk_each(resident_mesh_of(at), part, &before, INFINITY, &visitor, counters);
}

void mesh_extreme(const tracer *tr, const treelet *at, const ray *r, const extreme_way *way,
                  extreme_state *s, ray_counters *counters) {
    (void)way;
    climb_part(tr, at, r, r, s, counters);
}

void mesh_extreme_near(const tracer *tr, const treelet *at, const ray *r, double t,
                       extreme_state *s, ray_counters *counters) {
    ray part = *r;
    part.t0 = part.t1 = fmin(fmax(t, r->t0), r->t1);
    climb_part(tr, at, r, &part, s, counters);
}
