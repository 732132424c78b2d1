/* grid_near_template.h - conservative tests of rays against a grid's cells, in single precision:
 * which rays may visit a cell, and which of those may cross a surface there; included by the units
 * of an ISA (see formats/base/simd.h).
 *
 * Lanes are rays of a window at one cell, cells of one ray, or any ray-cells. Those that pass these
 * tests go to the cell kernel (cell_batch.h), which decides.
 */
#ifndef RENDER_GRID_GRID_NEAR_TEMPLATE_H
#define RENDER_GRID_GRID_NEAR_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/grid/grid_cross_template.h"
#include "render/look/projection.h"
#include "render/tile/tile_rays_template.h"
#include "stream/grid_resident.h"

/* ---- Visits ---- */

/* Cut t_in .. t_out to where rays with these reciprocals are between two planes. The planes'
 * coordinates are relative to the eye. */
SIMD void near_slab(vf lo, vf hi, vf reciprocal, vf *t_in, vf *t_out) {
    const vf to_lo = lo * reciprocal, to_hi = hi * reciprocal;
    *t_in = f_max(*t_in, f_min(to_lo, to_hi));
    *t_out = f_min(*t_out, f_max(to_lo, to_hi));
}

/* Returns the lanes with something left after all axes. Planes, reciprocals and products err by at
 * most 4 units (2^-24) of t, and so do t0 and t1; the test allows 16. */
SIMD unsigned near_passes(vf t_in, vf t_out) {
    const vf slack = f_set(16.0f * UNIT) * (f_abs(t_in) + f_abs(t_out));
    /* Inf - inf is no reason to drop a ray. */
    return ~mf_bits(f_gt(t_in - t_out, slack));
}

/* The planes of a group's 2^3 cells, a lane a cell: lane k is octant (from + k) % 8. */
typedef struct group_planes {
    vf lo[3], hi[3];
} group_planes;

SIMD group_planes group_planes_of(const plane_projection *const planes[3], const uint32_t first[3],
                                  unsigned from) {
    static const unsigned upper[3] = {0xaaaau, 0xccccu, 0xf0f0u};
    group_planes g;
    for (int a = 0; a < 3; a++) {
        const plane_projection *plane = &planes[a][first[a]];
        const vf middle = f_set(plane[1].from_eye);
        const mf above = mf_of_bits(upper[a] >> from & ((1u << VF_N) - 1u));
        g.lo[a] = f_select(above, middle, f_set(plane[0].from_eye));
        g.hi[a] = f_select(above, f_set(plane[2].from_eye), middle);
    }
    return g;
}

/* Returns which cells of a group a ray may visit, and sets t of their entries and exits. */
SIMD unsigned group_visits(const tile_rays *rays, unsigned at, const group_planes *g, float t_in[],
                           float t_out[]) {
    vf in = f_set(rays->near_t0[at]), out = f_set(rays->near_t1[at]);
    for (int a = 0; a < 3; a++)
        near_slab(g->lo[a], g->hi[a], f_set(rays->reciprocal[a][at]), &in, &out);
    f_store(t_in, in);
    f_store(t_out, out);
    return near_passes(in, out) & ((1u << VF_N) - 1u);
}

/* ---- The filter ---- */

/* Returns the part of may_cross()'s bound that depends on where VF_N cells lie: e_x + e_y + e_z, in
 * units of 16 u. */
SIMD vf near_reach(const vf lo[3], const vf hi[3], const vf inv[3]) {
    vf e = f_set(3.0f);
    for (int a = 0; a < 3; a++)
        e = e + f_max(f_abs(lo[a]), f_abs(hi[a])) * inv[a];
    return e;
}

SIMD near_forms near_forms_of(const float samples[8][VF_N], vf reach, double iso) {
    vf f[8], largest = f_set(0.0f);
    for (int s = 0; s < 8; s++) {
        double difference[VF_N];
        for (int k = 0; k < VF_N; k += VD_N)
            d_store(difference + k, d_of_floats(samples[s] + k) - d_set(iso));
        f[s] = f_of_doubles(difference);
        largest = f_max(largest, f_abs(f[s]));
    }
    near_forms forms;
    near_coefficients(f, forms.c);
    forms.bound =
        largest * ((f_set(2048.0f) + f_set(32.0f) * reach) * f_set(UNIT)) + f_set(0x1p-130f);
    return forms;
}

/* ---- Ray-cells, one a lane ---- */

/* Ray-cells, one a lane, on their way to the filter: d, planes and t as in tile_rays. */
typedef struct near_queue {
    float t_in[VF_N], t_out[VF_N], d[3][VF_N], lo[3][VF_N], hi[3][VF_N], inv[3][VF_N];
    float samples[8][VF_N];
    const resident_grid *at[VF_N];
    uint32_t cell[VF_N][3];
    uint16_t ray[VF_N];
    unsigned count;
} near_queue;

/* Returns the lanes that may cross any of the surfaces. */
SIMD unsigned queue_may_cross(const near_queue *q, const double isovalues[], int count) {
    vf lo[3], hi[3], inv[3];
    near_way v;
    for (int a = 0; a < 3; a++) {
        const vf d = f_load(q->d[a]);
        lo[a] = f_load(q->lo[a]);
        hi[a] = f_load(q->hi[a]);
        inv[a] = f_load(q->inv[a]);
        v.in[a] = near_coordinate(f_load(q->t_in), d, lo[a], inv[a]);
        v.way[a] = near_coordinate(f_load(q->t_out), d, lo[a], inv[a]) - v.in[a];
    }
    const vf reach = near_reach(lo, hi, inv);
    unsigned crossing = 0;
    for (int i = 0; i < count; i++) {
        const near_forms forms = near_forms_of(q->samples, reach, isovalues[i]);
        crossing |= may_cross(&v, &forms);
    }
    return crossing;
}

/* ---- Cells and windows ---- */

/* Active cells, one a lane, and windows of rays that visit them, on their way to the filter. Many
 * are filtered at a time, so that no cell waits for the result of another. */
enum { STAGE_CELLS = 16, STAGE_WINDOWS = 32 };

typedef struct cell_stage {
    float lo[3][STAGE_CELLS], hi[3][STAGE_CELLS], inv[3][STAGE_CELLS]; /* as in near_queue */
    float samples[STAGE_CELLS][8];
    float form[8][STAGE_CELLS], bound[STAGE_CELLS];
    const resident_grid *at[STAGE_CELLS];
    uint32_t cell[STAGE_CELLS][3];
    float t_in[STAGE_WINDOWS][VF_N], t_out[STAGE_WINDOWS][VF_N];
    uint8_t of[STAGE_WINDOWS]; /* number of the window's cell */
    uint8_t x[STAGE_WINDOWS], y[STAGE_WINDOWS];
    uint16_t visitors[STAGE_WINDOWS]; /* rays of the window, a bit each */
    uint16_t crossing[STAGE_WINDOWS];
    unsigned cells, windows;
} cell_stage;

/* Put a cell on the stage. The next one replaces it unless the caller counts it in s->cells. */
SIMD void stage_cell(cell_stage *s, const resident_grid *at,
                     const plane_projection *const planes[3], const uint32_t cell[3]) {
    const unsigned k = s->cells;
    s->at[k] = at;
    for (int a = 0; a < 3; a++) {
        s->cell[k][a] = cell[a];
        s->lo[a][k] = planes[a][cell[a]].from_eye;
        s->hi[a][k] = planes[a][cell[a] + 1].from_eye;
        s->inv[a][k] = planes[a][cell[a]].inverse;
    }
}

/* Compute the forms of all cells on the stage. */
SIMD void stage_forms(cell_stage *s, double iso) {
    for (unsigned from = 0; from < s->cells; from += VF_N) {
        float samples[8][VF_N];
        vf lo[3], hi[3], inv[3];
        for (unsigned k = 0; k < VF_N; k++)
            for (int c = 0; c < 8; c++)
                samples[c][k] = s->samples[from + k][c];
        for (int a = 0; a < 3; a++) {
            lo[a] = f_load(s->lo[a] + from);
            hi[a] = f_load(s->hi[a] + from);
            inv[a] = f_load(s->inv[a] + from);
        }
        const near_forms forms = near_forms_of(samples, near_reach(lo, hi, inv), iso);
        for (int c = 0; c < 8; c++)
            f_store(s->form[c] + from, forms.c[c]);
        f_store(s->bound + from, forms.bound);
    }
}

/* Returns the rays of window n that may cross the surface for which the forms were made. */
SIMD unsigned window_crosses(const cell_stage *s, const tile_rays *rays, unsigned n) {
    const unsigned k = s->of[n], at = STRIDE * s->y[n] + s->x[n];
    const vf t_in = f_load(s->t_in[n]), t_out = f_load(s->t_out[n]);
    near_way v;
    near_forms forms;
    for (int a = 0; a < 3; a++) {
        const vf d = window_load(rays->near_d[a] + at);
        const vf lo = f_set(s->lo[a][k]), inv = f_set(s->inv[a][k]);
        v.in[a] = near_coordinate(t_in, d, lo, inv);
        v.way[a] = near_coordinate(t_out, d, lo, inv) - v.in[a];
    }
    for (int c = 0; c < 8; c++)
        forms.c[c] = f_set(s->form[c][k]);
    forms.bound = f_set(s->bound[k]);
    return may_cross(&v, &forms);
}

#endif
#endif
