/* grid_points_template.h - surface_at() without the normal, for many surfaces of a tile at a time,
 * to the bit; included by the units of an ISA (see formats/base/simd.h). */
#ifndef RENDER_GRID_GRID_POINTS_TEMPLATE_H
#define RENDER_GRID_GRID_POINTS_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include <float.h>

#include "render/grid/grid_walk_template.h"

/* Surfaces of VD_N rays in their cells, a lane each. Lanes without a surface are computed, too. */
typedef struct point_columns {
    double t[VD_N], iso[VD_N], lo[3][VD_N], size[3][VD_N], inverse[3][VD_N];
    float samples[8][VD_N];
} point_columns;

static void point_columns_put(point_columns *c, unsigned lane, const tile_walk *w,
                              const tile_surface *x) {
    const walk_scene *scene = scene_of(w);
    const resident_grid *at = resident_grid_of(x->at);
    const level_planes *planes = &scene->levels[at->level];
    uint32_t cell[3];
    float samples[8];
    cell_of_local(at, x->local, cell);
    walk_cell_samples(scene, at, cell, samples);
    for (int i = 0; i < 8; i++)
        c->samples[i][lane] = samples[i];
    for (int a = 0; a < 3; a++) {
        const double lo = planes->at[a][cell[a]];
        c->lo[a][lane] = lo - w->view.p->eye[a];
        c->size[a][lane] = planes->at[a][cell[a] + 1] - lo;
        c->inverse[a][lane] = planes->inverse[a][cell[a]];
    }
    c->t[lane] = x->t;
    c->iso[lane] = scene->isovalues[x->iso];
}

SIMD vd point_mix(vd a, vd b, vd s) {
    return (d_set(1.0) - s) * a + s * b;
}

/* Compute the gradients of the cells' own trilinear forms, as surface_trilinear() does. */
SIMD void point_gradients(const vd s[8], const vd at[3], const vd inverse[3], vd gradient[3]) {
    vd x[4], dx[4];
    for (int i = 0; i < 4; i++) {
        x[i] = point_mix(s[2 * i], s[2 * i + 1], at[0]);
        dx[i] = s[2 * i + 1] - s[2 * i];
    }
    const vd low = point_mix(x[0], x[1], at[1]), high = point_mix(x[2], x[3], at[1]);
    gradient[0] = point_mix(point_mix(dx[0], dx[1], at[1]), point_mix(dx[2], dx[3], at[1]), at[2]) *
                  inverse[0];
    gradient[1] = point_mix(x[1] - x[0], x[3] - x[2], at[2]) * inverse[1];
    gradient[2] = (high - low) * inverse[2];
}

/* The same as position_errors() of surface.c. */
SIMD void point_places(const affine *space, const double o[3], const vd d[3], vd t, vd error[3]) {
    vd grid[3], world[3];
    for (int a = 0; a < 3; a++)
        grid[a] = d_set(fabs(o[a])) + d_abs(t * d[a]);
    for (int i = 0; i < 3; i++) {
        world[i] = d_set(fabs(space->to_world[i][3]));
        for (int a = 0; a < 3; a++)
            world[i] = world[i] + d_set(fabs(space->to_world[i][a])) * grid[a];
    }
    for (int a = 0; a < 3; a++) {
        error[a] = grid[a];
        for (int i = 0; i < 3; i++)
            error[a] = error[a] + d_set(fabs(space->to_grid[a][i])) * world[i];
        error[a] = error[a] * d_set(4.0 * DBL_EPSILON);
    }
}

/* The points of all lanes, by columns. */
typedef struct start_points {
    double gradient[3][VD_N], error[VD_N], span[VD_N];
} start_points;

SIMD void points_of(const affine *space, const double o[3], const vd d[3], const point_columns *c,
                    start_points *out) {
    vd s[8], at[3], inverse[3], gradient[3], place[3];
    vd magnitude = d_set(0.0), span = d_set(INFINITY);
    const vd t = d_load(c->t);
    for (int i = 0; i < 8; i++) {
        s[i] = d_of_floats(c->samples[i]);
        magnitude = d_max(magnitude, d_abs(s[i] - d_load(c->iso)));
    }
    for (int a = 0; a < 3; a++) {
        inverse[a] = d_load(c->inverse[a]);
        const vd u = (t * d[a] - d_load(c->lo[a])) * inverse[a];
        at[a] = d_min(d_max(u, d_set(0.0)), d_set(1.0));
    }
    point_gradients(s, at, inverse, gradient);
    point_places(space, o, d, t, place);
    vd error = d_set(32.0 * DBL_EPSILON) * magnitude;
    for (int a = 0; a < 3; a++) {
        span = d_min(span, d_set(affine_unit(space, a)) * d_load(c->size[a]));
        error = error + d_abs(gradient[a]) * place[a];
    }
    d_store(out->error, error);
    d_store(out->span, span);
    for (int a = 0; a < 3; a++)
        d_store(out->gradient[a], d_set(space->to_grid[0][a]) * gradient[0] +
                                      d_set(space->to_grid[1][a]) * gradient[1] +
                                      d_set(space->to_grid[2][a]) * gradient[2]);
}

static void grid_starts(void *work, const tile_layer *l, unsigned i, unsigned which,
                        surface_point to[]) {
    const tile_walk *w = work;
    const tile_state *s = &w->s;
    point_columns c;
    start_points points;
    vd d[3];
    memset(&c, 0, sizeof c);
    for (unsigned left = which; left; left &= left - 1) {
        const unsigned k = (unsigned)__builtin_ctz(left);
        point_columns_put(&c, k, w, surface_of(l, i + k));
    }
    for (int a = 0; a < 3; a++)
        d[a] = d_load(s->rays.d[a] + i);
    points_of(&s->f->tracer->space, s->f->projection->eye, d, &c, &points);
    for (unsigned left = which, n = 0; left; left &= left - 1, n++) {
        const unsigned k = (unsigned)__builtin_ctz(left);
        to[n] = (surface_point){.error = points.error[k], .span = points.span[k]};
        for (int a = 0; a < 3; a++)
            to[n].gradient[a] = points.gradient[a][k];
    }
}

#endif
#endif
