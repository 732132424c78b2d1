/* grid_near_template.h - conservative tests of rays against a grid's cells, in single precision:
 * which rays may visit a cell, and which of those may cross a surface there; included by the units
 * of an ISA (see formats/base/simd.h).
 *
 * Lanes are rays of a window that look at one cell, cells that one ray looks at, or ray-cells of
 * any kind. What these tests let through goes to the cell kernel (cell_batch.h), which decides.
 */
#ifndef RENDER_GRID_GRID_NEAR_TEMPLATE_H
#define RENDER_GRID_GRID_NEAR_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/projection.h"
#include "render/tile_rays_template.h"
#include "stream/grid_resident.h"

/* ---- Visits ---- */

static const float UNIT = 0x1p-24f; /* of float rounding */

/* Cut t_in .. t_out to where rays with these reciprocals are between two planes, both seen from the
 * eye. */
SIMD void near_slab(vf lo, vf hi, vf reciprocal, vf *t_in, vf *t_out) {
    const vf to_lo = lo * reciprocal, to_hi = hi * reciprocal;
    *t_in = f_max(*t_in, f_min(to_lo, to_hi));
    *t_out = f_min(*t_out, f_max(to_lo, to_hi));
}

/* What is left of them after all axes. Planes, reciprocals and products err by 4 units of t at
 * most, and so do t0 and t1; the test gives 16. */
SIMD unsigned near_passes(vf t_in, vf t_out) {
    const vf slack = f_set(16.0f * UNIT) * (f_abs(t_in) + f_abs(t_out));
    /* Inf - inf is no reason to drop a ray. */
    return ~mf_bits(f_gt(t_in - t_out, slack));
}

/* The cells of a group of 2^3, a lane a cell: lane % 8 is the octant from `from` on. */
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

/* Which cells of a group a ray may visit. */
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

/* f - iso over cells, one a lane, as a sum of products of coordinates, 1 x y z xy yz xz xyz, and
 * the bound of may_cross(). */
typedef struct near_forms {
    vf c[8], bound;
} near_forms;

/* What the bound takes from where VF_N cells lie. */
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
    const vf x0 = f[1] - f[0], x1 = f[3] - f[2], x2 = f[5] - f[4], x3 = f[7] - f[6];
    const vf y0 = f[2] - f[0], xy0 = x1 - x0;
    const vf bound = largest * ((f_set(2048.0f) + f_set(32.0f) * reach) * f_set(UNIT));
    return (near_forms){
        {f[0], x0, y0, f[4] - f[0], xy0, (f[6] - f[4]) - y0, x2 - x0, (x3 - x2) - xy0},
        bound + f_set(0x1p-130f)};
}

/* Where visits enter their cells, in the cells' coordinates, and their way through them. */
typedef struct near_way {
    vf in[3], way[3];
} near_way;

SIMD vf near_coordinate(vf t, vf d, vf lo, vf inv) {
    return f_min(f_max((t * d - lo) * inv, f_set(0.0f)), f_set(1.0f));
}

/* Which rays' control polygons (cell_cubic()) may change side: the others have no root, says the
 * cell kernel too.
 *
 * The proof, in units u = 2^-24. Coordinates in the cell, (t d - lo) inv: t errs by 5 u of itself,
 * d by u, and with the product's u, lo's and the difference's the sum errs by at most 10 u
 * max(|lo|, |hi|) inv, since |t d| is no more than that where the ray passes the cell; inv and the
 * product add 2 u, taking entry from exit and adding it again 2 u: less than e = 16 u (max(|lo|,
 * |hi|) inv + 1). Clamping takes nothing away. The form is linear in each coordinate with slopes of
 * at most 2 F, F = max |f|: positions add 2 F (e_x + e_y + e_z). Values: f errs by u F, the eight
 * coefficients by 81 u F together; their sizes add up to 27 F. The cubic's coefficients k0 .. k3
 * add up to 27, 54, 36 and 8 F before signs cancel, with at most 14 roundings on the way: 1750 u F.
 * Where results are denormal, 2^-149 a step. Together with the kernel's own rounding, 2^-50 F, less
 * than F (2048 u + 2 (e_x + e_y + e_z)) + 2^-130. */
SIMD unsigned may_cross(const near_way *v, const near_forms *forms) {
    const vf *in = v->in, *way = v->way, *c = forms->c, bound = forms->bound;
    const vf x = in[0], y = in[1], z = in[2];
    /* Per power of x and y, as a linear function along the visit: e + s h. */
    const vf e0 = c[0] + c[3] * z, h0 = c[3] * way[2];
    const vf ex = c[1] + c[6] * z, hx = c[6] * way[2];
    const vf ey = c[2] + c[5] * z, hy = c[5] * way[2];
    const vf exy = c[4] + c[7] * z, hxy = c[7] * way[2];
    const vf xy = x * y, xy1 = x * way[1] + y * way[0], xy2 = way[0] * way[1];
    const vf k0 = e0 + ex * x + ey * y + exy * xy;
    const vf k1 = h0 + hx * x + ex * way[0] + hy * y + ey * way[1] + hxy * xy + exy * xy1;
    const vf k2 = hx * way[0] + hy * way[1] + hxy * xy1 + exy * xy2;
    const vf k3 = hxy * xy2;
    const vf third = f_set(1.0f / 3.0f), b1 = k0 + third * k1, b2 = b1 + third * (k1 + k2);
    const vf b3 = k0 + k1 + k2 + k3;
    const vf least = f_min(f_min(k0, b3), f_min(b1, b2));
    const vf greatest = f_max(f_max(k0, b3), f_max(b1, b2));
    return ~mf_bits(mf_or(f_gt(least, bound), f_lt(greatest, f_set(-0.0f) - bound)));
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

/* Which of the lanes may cross any of the surfaces. */
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

/* Active cells, one a lane, and windows of rays that visit them, on their way to the filter: many
 * at a time, so that none waits for what another's is decided by. */
enum { STAGE_CELLS = 16, STAGE_WINDOWS = 32 };

typedef struct cell_stage {
    float lo[3][STAGE_CELLS], hi[3][STAGE_CELLS], inv[3][STAGE_CELLS]; /* as in near_queue */
    float samples[STAGE_CELLS][8];
    float form[8][STAGE_CELLS], bound[STAGE_CELLS];
    const resident_grid *at[STAGE_CELLS];
    uint32_t cell[STAGE_CELLS][3];
    float t_in[STAGE_WINDOWS][VF_N], t_out[STAGE_WINDOWS][VF_N];
    uint8_t of[STAGE_WINDOWS]; /* the cell */
    uint8_t x[STAGE_WINDOWS], y[STAGE_WINDOWS];
    uint16_t visitors[STAGE_WINDOWS]; /* rays of the window, a bit each */
    uint16_t crossing[STAGE_WINDOWS];
    unsigned cells, windows;
} cell_stage;

/* Put a cell on the stage; it goes when it is not counted. */
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

/* Forms of all cells. */
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

/* The rays of a window that may cross the surface that the forms are of. */
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
