#include "render/mesh/mesh_gradient.h"

#include <math.h>
#include <string.h>

#include "formats/base/vec3.h"
#include "render/mesh/mesh_tracer.h"
#include "render/mesh/mesh_walk.h"

/* Compute barycentric coordinates at t. Clamp them to the tet, since rounding may lead out of it.
 * Returns false if the tet has no volume. */
static bool weights_at(const tet *x, const ray *r, double t, double weights[4]) {
    double edge[3][3], away[3], sum = 0.0;
    for (int a = 0; a < 3; a++) {
        for (int i = 0; i < 3; i++)
            edge[i][a] = (double)x->p[i + 1][a] - (double)x->p[0][a];
        away[a] = (r->o[a] - (double)x->p[0][a]) + t * r->d[a];
    }
    const double volume = vec3_det(edge[0], edge[1], edge[2]);
    weights[1] = vec3_det(away, edge[1], edge[2]) / volume;
    weights[2] = vec3_det(edge[0], away, edge[2]) / volume;
    weights[3] = vec3_det(edge[0], edge[1], away) / volume;
    weights[0] = 1.0 - (weights[1] + weights[2] + weights[3]);
    for (int i = 0; i < 4; i++) {
        weights[i] = fmin(fmax(weights[i], 0.0), 1.0);
        sum += weights[i];
    }
    for (int i = 0; i < 4; i++)
        weights[i] /= sum;
    return volume != 0.0 && isfinite(sum);
}

/* Interpolate the gradients at the vertices, at t. */
static bool smooth_at(const tet *x, const float gradients[4][3], const ray *r, double t,
                      double out[3]) {
    double weights[4];
    if (!weights_at(x, r, t, weights))
        return false;
    for (int a = 0; a < 3; a++) {
        out[a] = 0.0;
        for (int i = 0; i < 4; i++)
            out[a] += weights[i] * (double)gradients[i][a];
    }
    return isfinite(out[0] + out[1] + out[2]);
}

/* Store a gradient that changes linearly. */
static void put(const double from[3], const double to[3], segment_gradient *out) {
    for (int a = 0; a < 3; a++) {
        out->power[a][0] = from[a];
        out->power[a][1] = to[a] - from[a];
        out->power[a][2] = out->power[a][3] = 0.0;
    }
}

void mesh_gradient(const tracer *tr, const treelet *treelet_at, const ray *r, const segment *s,
                   segment_gradient *out) {
    const resident_mesh *at = resident_mesh_of(treelet_at);
    const uint32_t local = (uint32_t)(s->cell - at->first_tet);
    const tet x = mesh_walk_tet(at, local);
    double from[3] = {0.0, 0.0, 0.0}, to[3];
    float gradients[4][3];
    if (mesh_rays_of(tr)->smooth) {
        mesh_walk_gradients(at, local, gradients);
        if (smooth_at(&x, (const float(*)[3])gradients, r, s->t0, from) &&
            smooth_at(&x, (const float(*)[3])gradients, r, s->t1, to)) {
            put(from, to, out);
            return;
        }
    }
    (void)tet_gradient(&x, from);
    put(from, from, out);
}
