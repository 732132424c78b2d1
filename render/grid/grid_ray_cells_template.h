/* grid_ray_cells_template.h - ray-cells on their way to the cell kernel: in single precision for
 * the filter, then as the kernel takes them; included by the units of an ISA (see
 * formats/base/simd.h).
 */
#ifndef RENDER_GRID_GRID_RAY_CELLS_TEMPLATE_H
#define RENDER_GRID_GRID_RAY_CELLS_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/grid/cell_batch.h"
#include "render/grid/grid_rays_template.h"
#include "render/grid/level_planes.h"

/* Where rays enter their cells, and how far they go there, in cell coordinates. e: may_cross()'s
 * error bounds of these, summed over the axes, in units of 16 u, less the constant 3. */
typedef struct ray_visits {
    near_way way;
    vf e;
} ray_visits;

/* Returns the visits of the rays at these places, one a lane. The cells lie between planes `from`
 * and `to`, counted from the rays' middle. */
SIMD ray_visits ray_visits_of(const grid_rays *g, const uint32_t places[], const vf from[3],
                              const vf to[3], const vf inverse[3]) {
    ray_visits v = {.e = f_set(0.0f)};
    vf o[3], d[3], r[3], span[3], lo[3];
    f_load_triples(g->o_of[0], places, o);
    f_load_triples(g->d_of[0], places, d);
    f_load_triples(g->per_d_of[0], places, r);
    f_load_triples(g->span_of[0], places, span);
    vf t_in = span[0], t_out = span[1];
    for (int a = 0; a < 3; a++) {
        const vf hi = to[a] - o[a];
        lo[a] = from[a] - o[a];
        const vf to_lo = lo[a] * r[a], to_hi = hi * r[a];
        /* A ray along the planes is between them all the way. */
        const mf across = f_gt(f_abs(d[a]), f_set(0.0f));
        t_in = f_select(across, f_max(t_in, f_min(to_lo, to_hi)), t_in);
        t_out = f_select(across, f_min(t_out, f_max(to_lo, to_hi)), t_out);
        v.e = v.e + (f_max(f_abs(lo[a]), f_abs(hi)) + f_set(g->rounding[a])) * inverse[a];
    }
    for (int a = 0; a < 3; a++) {
        v.way.in[a] = near_coordinate(t_in, d[a], lo[a], inverse[a]);
        v.way.way[a] = near_coordinate(t_out, d[a], lo[a], inverse[a]) - v.way.in[a];
    }
    return v;
}

/* Returns the forms of corners f, less the isovalue. Two errors add to the bound of may_cross().
 * Planes as seen from a ray's entry are off by up to 2^-23 `rounding`, which is in e. Corners are
 * off by less than `off`. */
SIMD near_forms ray_cell_forms(const vf f[8], vf e, vf off) {
    near_forms forms;
    vf largest = f_set(0.0f);
    for (int s = 0; s < 8; s++)
        largest = f_max(largest, f_abs(f[s]));
    near_coefficients(f, forms.c);
    forms.bound = largest * ((f_set(2048.0f + 96.0f) + f_set(32.0f) * e) * f_set(UNIT)) +
                  f_set(0x1p-130f) + off;
    return forms;
}

/* ---- In double ---- */

/* cell_batch_put() - puts a ray and a cell into lane k. */
SIMD void cell_batch_put(cell_batch *b, unsigned k, const level_planes *planes, const ray *r,
                         const uint32_t cell[3], const float samples[8]) {
    for (int a = 0; a < 3; a++) {
        b->d[a][k] = r->d[a] != 0.0 ? r->d[a] : CELL_ALONG;
        b->lo[a][k] = planes->at[a][cell[a]] - r->o[a];
        b->hi[a][k] = planes->at[a][cell[a] + 1] - r->o[a];
        b->inv[a][k] = planes->inverse[a][cell[a]];
    }
    b->t0[k] = r->t0;
    b->t1[k] = r->t1;
    for (int s = 0; s < 8; s++)
        b->samples[s][k] = samples[s];
}

/* cell_batch_along() - returns whether a batch can take a ray with a component of 0 in this cell:
 * see CELL_ALONG. */
static bool cell_batch_along(const level_planes *planes, const ray *r, const uint32_t cell[3],
                             double t_in, double t_out) {
    bool along = fabs(t_in) <= CELL_ALONG_T && fabs(t_out) <= CELL_ALONG_T;
    for (int a = 0; a < 3; a++) {
        const double lo = planes->at[a][cell[a]] - r->o[a],
                     hi = planes->at[a][cell[a] + 1] - r->o[a];
        along &= r->d[a] != 0.0 || (fabs(lo) >= CELL_ALONG_NEAR && fabs(hi) >= CELL_ALONG_NEAR);
    }
    return along;
}

#endif
#endif
