#include "render/mesh/mesh_tracer.h"

#include "render/mesh/mesh_walk.h"
#include "render/mesh/tet_smooth.h"

bool mesh_hits(const tracer *tr, const treelet *at, const ray *r, trace_state *state,
               ray_counters *counters) {
    if (!mesh_walk(&tr->isos, resident_mesh_of(at), r, state, counters))
        return false;
    if (!state->any)
        state->point = mesh_tracer_surface(tr, at, r, &state->best);
    return true;
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
