#include "render/ray/tracer.h"

#include <math.h>
#include <string.h>

#include "render/ray/kind.h"
#include "render/ray/ray_box.h"

/* Cut [t0, t1] to where n . (o + t d) + w >= 0. Returns false when nothing is left. */
static bool cut(const double plane[4], const double o[3], const double d[3], double *t0,
                double *t1) {
    const double at_origin = plane[0] * o[0] + plane[1] * o[1] + plane[2] * o[2] + plane[3];
    const double slope = plane[0] * d[0] + plane[1] * d[1] + plane[2] * d[2];
    if (slope == 0.0)
        return at_origin >= 0.0;
    const double t = -at_origin / slope;
    if (slope > 0.0 && t > *t0)
        *t0 = t;
    if (slope < 0.0 && t < *t1)
        *t1 = t;
    return *t0 <= *t1;
}

int tracer_enters_by(const tracer *tr, const double origin[3], const double direction[3],
                     double *t) {
    double t0 = 0.0, t1 = INFINITY;
    int by = -1;
    for (int i = 0; i < tr->clip_count; i++) {
        const double before = t0;
        if (!cut(tr->clip[i], origin, direction, &t0, &t1))
            return -1;
        by = t0 > before ? i : by;
    }
    *t = t0;
    return by;
}

bool tracer_box(const tracer *tr, const ray *r, double *t0, double *t1) {
    for (int a = 0; a < 3; a++) {
        if (r->d[a] == 0.0) {
            if (r->o[a] < tr->box[0][a] || r->o[a] > tr->box[1][a])
                return false;
            continue;
        }
        ray_box_slab(tr->box[0][a], tr->box[1][a], r->o[a], r->d[a], t0, t1);
    }
    return *t0 <= *t1;
}

static void direction_at(const tracer *tr, const placement *place, const double direction[3],
                         double in_grid[3]) {
    double own[3];
    affine_vector_to_grid(&tr->space, placement_vector(place, direction, own), in_grid);
    for (int a = 0; a < 3; a++)
        in_grid[a] += 0.0; /* -0 becomes +0 */
}

/* Make a ray whose direction out->d holds. */
static bool ray_along(const tracer *tr, const placement *place, const double origin[3],
                      const double direction[3], double t0, double t1, ray *out) {
    for (int i = 0; i < tr->clip_count; i++)
        if (!cut(tr->clip[i], origin, direction, &t0, &t1))
            return false;
    double own[3];
    affine_point_to_grid(&tr->space, placement_point(place, origin, own), out->o);
    for (int a = 0; a < 3; a++) {
        const double end = tr->box[1][a];
        out->held[a] = out->o[a] < end ? out->o[a] : nextafter(end, tr->box[0][a]);
    }
    /* Coarse levels reach past the volume: there the box is a clip interval like any other. */
    if (tr->boxed && !tracer_box(tr, out, &t0, &t1))
        return false;
    out->t0 = t0;
    out->t1 = t1;
    return true;
}

void tracer_direction(const tracer *tr, const double direction[3], double in_grid[3]) {
    direction_at(tr, &tr->place, direction, in_grid);
}

bool tracer_ray_along(const tracer *tr, const double origin[3], const double direction[3],
                      double t0, double t1, ray *out) {
    return ray_along(tr, &tr->place, origin, direction, t0, t1, out);
}

bool tracer_ray_at(const tracer *tr, const placement *place, const double origin[3],
                   const double direction[3], double t0, double t1, ray *out) {
    direction_at(tr, place, direction, out->d);
    return ray_along(tr, place, origin, direction, t0, t1, out);
}

bool tracer_ray(const tracer *tr, const double origin[3], const double direction[3], double t0,
                double t1, ray *out) {
    return tracer_ray_at(tr, &tr->place, origin, direction, t0, t1, out);
}

trace_result tracer_find(const tracer *tr, const ray *r, trace_state *state,
                         ray_counters *counters) {
    return tr->kind->walks->next(tr, r, state, counters);
}

void tracer_take_back_from(const tracer *tr, const placement *place, const ray *r, double t,
                           surface_point *point) {
    double grid[3], reach[3];
    for (int a = 0; a < 3; a++)
        grid[a] = fabs(r->o[a]) + fabs(t * r->d[a]);
    for (int i = 0; i < 3; i++) {
        reach[i] = fabs(tr->space.to_world[i][3]);
        for (int a = 0; a < 3; a++)
            reach[i] += fabs(tr->space.to_world[i][a]) * grid[a];
    }
    placement_take_back(place, reach, point);
}

void tracer_take_back(const tracer *tr, const ray *r, trace_result result, trace_state *state) {
    if (tr->place.moved && result == TRACE_HIT && !state->any && !hit_is_bound(&state->best))
        tracer_take_back_from(tr, &tr->place, r, state->best.t, &state->point);
}

trace_result tracer_next(const tracer *tr, const ray *r, trace_state *state,
                         ray_counters *counters) {
    const trace_result result = tracer_find(tr, r, state, counters);
    tracer_take_back(tr, r, result, state);
    return result;
}

ray_bundle tracer_bundle(const tracer *tr, const ray_bundle *rays) {
    ray_bundle own = *rays;
    double vector[3];
    const double *to = rays->way == RAYS_ALONG ? placement_vector(&tr->place, rays->vector, vector)
                                               : placement_point(&tr->place, rays->vector, vector);
    memcpy(own.vector, to, sizeof own.vector);
    return own;
}

void tracer_gradient(const tracer *tr, const treelet *at, const ray *r, const segment *s,
                     segment_gradient *out) {
    tr->kind->gradient(tr, at, r, s, out);
    for (int i = 0; i < 4 && tr->place.moved; i++) {
        const double own[3] = {out->power[0][i], out->power[1][i], out->power[2][i]};
        double scene[3];
        affine_gradient_to_world(&tr->place.space, own, scene);
        for (int a = 0; a < 3; a++)
            out->power[a][i] = scene[a];
    }
}

void tracer_corners(const tracer *tr, double corners[8][3]) {
    for (int i = 0; i < 8; i++) {
        double grid[3], own[3];
        for (int a = 0; a < 3; a++)
            grid[a] = tr->box[i >> a & 1][a];
        affine_point_to_world(&tr->space, grid, own);
        placement_to_scene(&tr->place, own, corners[i]);
    }
}

uint32_t tracer_stand_in(const tracer *tr, uint32_t t) {
    return t != LEAF_NO_TREELET && loader_is_lost(tr->treelets, t)
               ? loader_stand_in(tr->treelets, t)
               : t;
}

const treelet *tracer_enter_lenient(const tracer *tr, uint32_t t, uint32_t *blocked,
                                    bool *provisional) {
    const uint32_t other = tracer_stand_in(tr, t);
    const treelet *at = other == LEAF_NO_TREELET ? NULL : loader_lookup(tr->treelets, other);
    *blocked = at ? LEAF_NO_TREELET : other;
    *provisional |= other != t;
    if (at)
        tracer_touch(tr, other);
    return at;
}
