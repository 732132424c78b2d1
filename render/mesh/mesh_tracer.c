#include "render/mesh/mesh_tracer.h"

#include "render/mesh/mesh_passage.h"
#include "render/mesh/tet_smooth.h"

/* Look for hits in a treelet. Returns whether the search is over. */
static bool walk_passage(const tracer *tr, const treelet *here, const ray *r, trace_state *state,
                         ray_counters *counters) {
    if (!mesh_walk(&tr->isos, resident_mesh_of(here), r, state, counters))
        return false;
    if (!state->any)
        state->point = mesh_tracer_surface(tr, here, r, &state->best);
    return state->any;
}

trace_result mesh_tracer_next(const tracer *tr, const ray *r, trace_state *state,
                              ray_counters *counters) {
    mesh_passages s;
    bool resuming = state->blocked != LEAF_NO_TREELET;
    mesh_passage at = {resuming ? state->t_from : -INFINITY, resuming ? state->blocked : 0};
    mesh_passages_begin(&s, mesh_rays_of(tr)->tree, r, &state->after, counters);
    for (;; resuming = false) {
        if (!resuming) {
            at = mesh_passages_next(&s, at, state->best.t);
            if (at.t == LEAF_NO_TREELET)
                return hit_exists(&state->best) ? TRACE_HIT : TRACE_MISS;
        }
        const treelet *here =
            tracer_enter(tr, at.t, at.t_in, &state->t_from, &state->blocked, &state->provisional);
        if (!here && !tr->preview)
            return TRACE_BLOCKED;
        if (here && walk_passage(tr, here, r, state, counters))
            return TRACE_HIT;
    }
}

surface_point mesh_tracer_surface(const tracer *tr, const treelet *found, const ray *r,
                                  const hit *h) {
    const resident_mesh *at = resident_mesh_of(found);
    const uint32_t local = (uint32_t)(h->cell - at->first_tet);
    const double iso = tr->isos.isovalues[h->iso];
    const tet x = mesh_walk_tet(at, local);
    surface_point point = tet_surface(&x, r, iso, h);
    isopolygon g;
    if (mesh_rays_of(tr)->smooth && isopolygon_of(&x, iso, &g)) {
        float gradients[4][3];
        tet_smooth s;
        mesh_walk_gradients(at, local, gradients);
        tet_smooth_of(&x, iso, &g, (const float(*)[3])gradients, &s);
        (void)tet_smooth_normal(&s, r->o, r->d, h->t, point.normal);
    }
    return point;
}
