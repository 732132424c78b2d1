/* grid_normals_template.h - the normals of the surfaces that a tile's rays have found in a grid;
 * included by the units of an ISA (see formats/base/simd.h).
 *
 * The operations and their order are those of surface_at(), for many pixels at a time. */
#ifndef RENDER_GRID_GRID_NORMALS_TEMPLATE_H
#define RENDER_GRID_GRID_NORMALS_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/grid/grid_points_template.h"
#include "render/grid/grid_walk_template.h"
#include "render/grid/surface.h"
#include "render/tile/tile_shade_template.h"

typedef double four __attribute__((vector_size(32)));

SIMD four four_set(double a) {
    return (four){a, a, a, a};
}

SIMD four four_load(const double *from) {
    four a;
    memcpy(&a, from, sizeof a);
    return a;
}

SIMD four mix_four(four a, four b, double s) {
    return four_set(1.0 - s) * a + four_set(s) * b;
}

/* The gradients at the corners of the cells that were hit last: neighbouring rays share them. */
enum { KNOWN_CELLS = 32 };

typedef struct known_cell {
    const resident_grid *at;
    uint32_t cell[3];
    double gradients[8][4];
} known_cell;

/* Returns the gradients at the corners of surface i's cell, computed or remembered. */
static const known_cell *corners_of(const tile_walk *w, const tile_layer *l, unsigned i,
                                    known_cell *known) {
    const resident_grid *at = resident_grid_of(surface_of(l, i)->at);
    uint32_t cell[3];
    cell_of_local(at, surface_of(l, i)->local, cell);
    known_cell *k = &known[(cell[0] + 5 * cell[1] + 11 * cell[2]) % KNOWN_CELLS];
    if (k->at == at && k->cell[0] == cell[0] && k->cell[1] == cell[1] && k->cell[2] == cell[2])
        return k;
    surface_gradients(scene_of(w), at, cell, k->gradients);
    k->at = at;
    for (int a = 0; a < 3; a++)
        k->cell[a] = cell[a];
    return k;
}

/* Compute the gradients for the normals of VD_N pixels. Lanes without a hit get any gradient. */
SIMD void gradients_at(const tile_walk *w, const tile_layer *l, unsigned i, unsigned hits,
                       bool central, known_cell *known, double gradient[3][VD_N]) {
    const walk_scene *scene = scene_of(w);
    double t[VD_N], lo[3][VD_N], inverse[3][VD_N], at[3][VD_N];
    uint32_t cell[VD_N][3] = {{0}};
    for (unsigned k = 0; k < VD_N; k++) {
        const bool has = hits >> k & 1u;
        const resident_grid *in = has ? resident_grid_of(surface_of(l, i + k)->at) : NULL;
        const level_planes *planes = &scene->levels[in ? in->level : 0];
        if (in)
            cell_of_local(in, surface_of(l, i + k)->local, cell[k]);
        t[k] = has ? surface_of(l, i + k)->t : 0.0;
        for (int a = 0; a < 3; a++) {
            lo[a][k] = planes->at[a][cell[k][a]] - w->view.p->eye[a];
            inverse[a][k] = planes->inverse[a][cell[k][a]];
        }
    }
    for (int a = 0; a < 3; a++) {
        const vd u = (d_load(t) * d_load(w->s.rays.d[a] + i) - d_load(lo[a])) * d_load(inverse[a]);
        d_store(at[a], d_min(d_max(u, d_set(0.0)), d_set(1.0)));
    }
    for (unsigned k = 0; k < VD_N; k++) {
        double g[4] = {1.0, 1.0, 1.0, 0.0};
        const double x = at[0][k], y = at[1][k], z = at[2][k];
        if ((hits >> k & 1u) && central) {
            const known_cell *corners = corners_of(w, l, i + k, known);
            four c[8];
            for (int corner = 0; corner < 8; corner++)
                c[corner] = four_load(corners->gradients[corner]);
            const four low = mix_four(mix_four(c[0], c[1], x), mix_four(c[2], c[3], x), y);
            const four high = mix_four(mix_four(c[4], c[5], x), mix_four(c[6], c[7], x), y);
            const four mixed = mix_four(low, high, z);
            memcpy(g, &mixed, sizeof g);
        } else if (hits >> k & 1u) {
            const double point[3] = {x, y, z};
            const double widths[3] = {inverse[0][k], inverse[1][k], inverse[2][k]};
            float samples[8];
            walk_cell_samples(scene, resident_grid_of(surface_of(l, i + k)->at), cell[k], samples);
            surface_trilinear(samples, point, widths, g);
        }
        for (int a = 0; a < 3; a++)
            gradient[a][k] = g[a];
    }
}

/* Compute unit normals against the gradients, VD_N at a time. Returns the lanes without a normal:
 * the gradient is zero or not finite. */
SIMD unsigned normals_of(const affine *space, double gradient[3][VD_N], unsigned i,
                         tile_normals normal) {
    vd grid[3], g[3], v[3];
    for (int a = 0; a < 3; a++)
        grid[a] = d_load(gradient[a]);
    for (int a = 0; a < 3; a++)
        g[a] = d_set(space->to_grid[0][a]) * grid[0] + d_set(space->to_grid[1][a]) * grid[1] +
               d_set(space->to_grid[2][a]) * grid[2];
    const vd largest = d_max(d_abs(g[0]), d_max(d_abs(g[1]), d_abs(g[2])));
    for (int a = 0; a < 3; a++)
        v[a] = g[a] / largest;
    const vd length = d_sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int a = 0; a < 3; a++)
        d_store_floats(normal[a] + i, (d_set(-0.0) - v[a]) / length);
    const vd sum = g[0] + g[1] + g[2], infinite = d_set(INFINITY);
    return ~md_bits(md_and(d_gt(largest, d_set(0.0)), d_lt(d_abs(sum), infinite)));
}

/* Returns ray i of the tile in the form of the scalar code. */
static ray ray_of(const tile_state *s, unsigned i) {
    ray r = {.t0 = s->rays.t0[i], .t1 = s->rays.t1[i]};
    for (int a = 0; a < 3; a++) {
        r.o[a] = r.held[a] = s->f->projection->eye[a];
        r.d[a] = s->rays.d[a][i];
    }
    return r;
}

/* Take the normal of surface_at(), where the vector code has found none. */
static void normal_of_its_own(const tile_walk *w, const tile_layer *l, unsigned i,
                              tile_normals normal) {
    const tracer *tr = w->s.f->tracer;
    const tile_surface *x = surface_of(l, i);
    const hit h = tile_hit(&w->s, x);
    const ray r = ray_of(&w->s, i);
    const surface_point point = surface_at(scene_of(w), &tr->space, resident_grid_of(x->at), &r, &h,
                                           scene_of(w)->analytic_normals);
    for (int a = 0; a < 3; a++)
        normal[a][i] = point.normal[a];
}

/* Compute the normals of all surfaces of a layer. */
static void grid_normals(void *work, const tile_layer *l, tile_normals normal) {
    const tile_walk *w = work;
    const tracer *tr = w->s.f->tracer;
    const bool central = !scene_of(w)->analytic_normals && scene_of(w)->halo > 0;
    known_cell known[KNOWN_CELLS];
    for (int k = 0; k < KNOWN_CELLS; k++)
        known[k].at = NULL;
    for (unsigned i = 0; i < TILE_RAYS; i += VD_N) {
        double gradient[3][VD_N];
        const unsigned hits = hits_from(l, i, VD_N);
        if (!hits)
            continue;
        gradients_at(w, l, i, hits, central, known, gradient);
        for (unsigned bad = normals_of(&tr->space, gradient, i, normal) & hits; bad; bad &= bad - 1)
            normal_of_its_own(w, l, i + (unsigned)__builtin_ctz(bad), normal);
    }
}

static const tile_kind grid_kind_of_tile = {grid_normals, grid_starts, NULL};

#endif
#endif
