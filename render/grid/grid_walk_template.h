/* grid_walk_template.h - a tile's rays down to their first surfaces; included by the units of an
 * ISA (see formats/base/simd.h). */
#ifndef RENDER_GRID_GRID_WALK_TEMPLATE_H
#define RENDER_GRID_GRID_WALK_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/kernels.h"
#include "render/lane_counts.h"
#include "render/ray_box.h"
#include "render/tile_rects_template.h"
#include "render/tile_state_template.h"

/* Ray-cells, one a lane, on their way to the filter: d, planes and t as in tile_rays. */
typedef struct near_queue {
    float t_in[VF_N], t_out[VF_N], d[3][VF_N], lo[3][VF_N], hi[3][VF_N], inv[3][VF_N];
    float samples[8][VF_N];
    const resident_grid *at[VF_N];
    uint32_t cell[VF_N][3];
    uint8_t ray[VF_N];
    unsigned count;
} near_queue;

typedef struct tile_walk {
    tile_state s;
    tile_place place;
    tile_row pending[ROWS]; /* rays of s.open of which a cell waits in the batch */
    bool filter;            /* the intersector is the one that the filter knows */
    near_queue queue;
    /* Ray-cells on their way to the cell kernel. */
    cell_batch batch;
    unsigned waiting;
    uint8_t ray_of[CELL_BATCH];
    uint32_t cell_of[CELL_BATCH][3];
    const resident_grid *treelet_of[CELL_BATCH];
    uint32_t cell[TILE_RAYS][3]; /* of what has been found */
} tile_walk;

/* Where ray i has found something. */
SIMD const resident_grid *found_in(const tile_walk *w, unsigned i) {
    return resident_grid_of(w->s.at[i]);
}

SIMD const walk_scene *scene_of(const tile_walk *w) {
    return w->s.f->tracer->own;
}

static bool any_of(const tile_row rows[], tile_rect r) {
    unsigned any = 0;
    for (unsigned y = r.y0; y <= r.y1; y++)
        any |= rows[y];
    return any & row_mask(r);
}

/* ---- The batch ---- */

static uint64_t index_of(const tile_walk *w, const resident_grid *at, const uint32_t cell[3]) {
    return walk_cell_index(&scene_of(w)->levels[at->level], cell);
}

/* A hit of ray-cell k: nearer than what the ray has? */
static void take_hit(tile_walk *w, unsigned k, double t, int32_t iso, bool entering) {
    const unsigned i = w->ray_of[k];
    if (w->s.t[i] <= t) {
        const hit known = {w->s.t[i], index_of(w, found_in(w, i), w->cell[i]), w->s.iso[i], false};
        const hit found = {t, index_of(w, w->treelet_of[k], w->cell_of[k]), iso, false};
        if (!hit_less(&found, &known))
            return;
    }
    w->s.t[i] = t;
    w->s.iso[i] = iso;
    w->s.entering[i] = entering;
    w->s.at[i] = &w->treelet_of[k]->head;
    for (int a = 0; a < 3; a++)
        w->cell[i][a] = w->cell_of[k][a];
}

/* Let the cell kernel answer what waits. A ray with a hit is done: all cells to come lie behind.
 * But one that has it where it leaves the cell: the next cell may claim the same t. */
static void flush(tile_walk *w) {
    if (w->waiting == 0)
        return;
    const walk_scene *scene = scene_of(w);
    cell_batch_hits hits;
    w->s.f->kernels->cells(&w->batch, (int)w->waiting, scene->isovalues, scene->count,
                           scene->intersector, &hits);
    LANE_COUNT(batches, (1u << w->waiting) - 1u);
    LANE_COUNT(roots, hits.found);
    for (uint32_t left = hits.found; left; left &= left - 1) {
        const unsigned k = (unsigned)__builtin_ctz(left), i = w->ray_of[k];
        take_hit(w, k, hits.t[k], hits.iso[k], hits.entering >> k & 1u);
        if (!(hits.at_exit >> k & 1u))
            w->s.open[i / TILE] &= ~((tile_row)1 << i % TILE);
        else
            w->s.rays.near_t1[i / TILE * STRIDE + i % TILE] =
                (float)(w->s.t[i] * w->s.f->projection->unscale);
    }
    w->s.counters->roots += (unsigned)__builtin_popcount(hits.found);
    w->waiting = 0;
    for (unsigned y = 0; y < TILE; y++)
        w->pending[y] = 0;
}

static bool is_open(const tile_walk *w, unsigned i) {
    return w->s.open[i / TILE] >> i % TILE & 1u;
}

/* Let ray i wait for the cell kernel's answer. */
static void add_to_batch(tile_walk *w, const resident_grid *at, const uint32_t cell[3],
                         const float samples[8], unsigned i) {
    const level_planes *planes = &scene_of(w)->levels[at->level];
    cell_batch *b = &w->batch;
    const unsigned k = w->waiting++;
    for (int a = 0; a < 3; a++) {
        b->d[a][k] = w->s.rays.d[a][i];
        b->lo[a][k] = planes->at[a][cell[a]] - w->place.p->eye[a];
        b->hi[a][k] = planes->at[a][cell[a] + 1] - w->place.p->eye[a];
        b->inv[a][k] = planes->inverse[a][cell[a]];
        w->cell_of[k][a] = cell[a];
    }
    b->t0[k] = w->s.rays.t0[i];
    b->t1[k] = w->s.rays.t1[i];
    for (int s = 0; s < 8; s++)
        b->samples[s][k] = samples[s];
    w->ray_of[k] = (uint8_t)i;
    w->treelet_of[k] = at;
    w->pending[i / TILE] |= (tile_row)1 << i % TILE;
    if (w->waiting == CELL_BATCH)
        flush(w);
}

/* ---- Cells ---- */

/* A cell's box in single precision, t scaled as in tile_rays. */
typedef struct near_cell {
    float lo[3], hi[3], inv[3];
} near_cell;

/* f - iso over a cell, as a sum of products of coordinates, 1 x y z xy yz xz xyz, and the bound of
 * may_cross(). */
typedef struct near_form {
    float c[8];
    float bound;
} near_form;

/* What the filter needs is made when it is first needed. */
typedef struct active_cell {
    const resident_grid *at;
    uint32_t cell[3];
    near_cell near;
    bool has_samples, has_forms;
    float samples[8];
    near_form forms[ISOVALUES_MAX];
} active_cell;

typedef struct near_visit {
    vf t_in, t_out;
} near_visit;

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

/* Which rays of a window may visit the cell. */
SIMD unsigned visits(const tile_rays *rays, unsigned at, const near_cell *c, near_visit *v) {
    vf t_in = window_load(rays->near_t0 + at), t_out = window_load(rays->near_t1 + at);
    for (int a = 0; a < 3; a++) {
        const vf r = window_load(rays->reciprocal[a] + at);
        near_slab(f_set(c->lo[a]), f_set(c->hi[a]), r, &t_in, &t_out);
    }
    v->t_in = t_in;
    v->t_out = t_out;
    return near_passes(t_in, t_out);
}

static inline float larger(float a, float b) {
    return a > b ? a : b;
}

static inline near_form near_form_of(const near_cell *c, const float samples[8], double iso) {
    float f[8], size[8], e = 3.0f;
    for (int i = 0; i < 8; i += VD_N)
        d_store_floats(f + i, d_of_floats(samples + i) - d_set(iso));
    for (int i = 0; i < 8; i++)
        size[i] = fabsf(f[i]);
    const float largest = larger(larger(larger(size[0], size[1]), larger(size[2], size[3])),
                                 larger(larger(size[4], size[5]), larger(size[6], size[7])));
    for (int a = 0; a < 3; a++)
        e += larger(fabsf(c->lo[a]), fabsf(c->hi[a])) * c->inv[a];
    const float x0 = f[1] - f[0], x1 = f[3] - f[2], x2 = f[5] - f[4], x3 = f[7] - f[6];
    const float y0 = f[2] - f[0], xy0 = x1 - x0;
    return (near_form){
        {f[0], x0, y0, f[4] - f[0], xy0, (f[6] - f[4]) - y0, x2 - x0, (x3 - x2) - xy0},
        largest * ((2048.0f + 32.0f * e) * UNIT) + 0x1p-130f};
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
SIMD unsigned may_cross(const vf in[3], const vf way[3], const vf c[8], vf bound) {
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

/* The rays of a window that may cross any of the surfaces. */
SIMD unsigned may_cross_any(const tile_rays *rays, unsigned at, const near_cell *c,
                            const near_visit *v, const near_form forms[], int count) {
    vf in[3], way[3];
    const vf zero = f_set(0.0f), one = f_set(1.0f);
    for (int a = 0; a < 3; a++) {
        const vf d = window_load(rays->near_d[a] + at), lo = f_set(c->lo[a]),
                 inv = f_set(c->inv[a]);
        in[a] = f_min(f_max((v->t_in * d - lo) * inv, zero), one);
        way[a] = f_min(f_max((v->t_out * d - lo) * inv, zero), one) - in[a];
    }
    unsigned crossing = 0;
    for (int i = 0; i < count; i++) {
        vf form[8];
        for (int k = 0; k < 8; k++)
            form[k] = f_set(forms[i].c[k]);
        crossing |= may_cross(in, way, form, f_set(forms[i].bound));
    }
    return crossing;
}

/* The open rays of a window that lie in the rectangle. */
SIMD unsigned window_open(const tile_walk *w, unsigned x, unsigned y, tile_rect r) {
    unsigned bits = 0;
    for (unsigned row = 0; row < WINDOW_Y; row++)
        if (y + row <= r.y1)
            bits |= (w->s.open[y + row] & row_mask(r)) >> x << (4 * row) & 15u << (4 * row);
    return bits;
}

SIMD unsigned window_pending(const tile_walk *w, unsigned x, unsigned y) {
    unsigned bits = 0;
    for (unsigned row = 0; row < WINDOW_Y; row++)
        bits |= (w->pending[y + row] >> x & 15u) << (4 * row);
    return bits;
}

/* The rays of a window that visit a cell: filter those and add the rest to the batch. */
SIMD void add_visitors(tile_walk *w, active_cell *c, const near_visit *v, unsigned x, unsigned y,
                       tile_rect r, unsigned bits) {
    const walk_scene *scene = scene_of(w);
    w->s.counters->cells += (unsigned)__builtin_popcount(bits);
    LANE_COUNT(visitors, bits);
    if (!c->has_samples)
        walk_cell_samples(scene, c->at, c->cell, c->samples);
    c->has_samples = true;
    if (w->filter) {
        for (int i = 0; i < scene->count && !c->has_forms; i++)
            c->forms[i] = near_form_of(&c->near, c->samples, scene->isovalues[i]);
        c->has_forms = true;
        bits &= may_cross_any(&w->s.rays, STRIDE * y + x, &c->near, v, c->forms, scene->count);
    }
    LANE_COUNT(survivors, bits);
    if (bits & window_pending(w, x, y)) {
        flush(w);
        bits &= window_open(w, x, y, r);
    }
    for (; bits; bits &= bits - 1) {
        const unsigned lane = (unsigned)__builtin_ctz(bits);
        add_to_batch(w, c->at, c->cell, c->samples,
                     TILE * (y + lane / WINDOW_X) + x + lane % WINDOW_X);
    }
    if (w->s.f->kernels->by_cell)
        flush(w);
}

static void cell_begin(active_cell *c, const resident_grid *at,
                       const plane_projection *const planes[3], const uint32_t cell[3]) {
    c->at = at;
    c->has_samples = c->has_forms = false;
    for (int a = 0; a < 3; a++) {
        c->cell[a] = cell[a];
        c->near.lo[a] = planes[a][cell[a]].from_eye;
        c->near.hi[a] = planes[a][cell[a] + 1].from_eye;
        c->near.inv[a] = planes[a][cell[a]].inverse;
    }
}

/* ---- Ray-cells, one a lane ---- */

/* near_form_of(), and which of the lanes may cross any of the surfaces. */
SIMD unsigned queue_may_cross(const near_queue *q, const double isovalues[], int count) {
    const vf zero = f_set(0.0f), one = f_set(1.0f);
    vf in[3], way[3], e = f_set(3.0f);
    for (int a = 0; a < 3; a++) {
        const vf d = f_load(q->d[a]), lo = f_load(q->lo[a]), inv = f_load(q->inv[a]);
        in[a] = f_min(f_max((f_load(q->t_in) * d - lo) * inv, zero), one);
        way[a] = f_min(f_max((f_load(q->t_out) * d - lo) * inv, zero), one) - in[a];
        e = e + f_max(f_abs(lo), f_abs(f_load(q->hi[a]))) * inv;
    }
    unsigned crossing = 0;
    for (int i = 0; i < count; i++) {
        vf f[8], largest = zero;
        for (int s = 0; s < 8; s++) {
            double difference[VF_N];
            for (int k = 0; k < VF_N; k += VD_N)
                d_store(difference + k, d_of_floats(q->samples[s] + k) - d_set(isovalues[i]));
            f[s] = f_of_doubles(difference);
            largest = f_max(largest, f_abs(f[s]));
        }
        const vf x0 = f[1] - f[0], x1 = f[3] - f[2], x2 = f[5] - f[4], x3 = f[7] - f[6];
        const vf y0 = f[2] - f[0], xy0 = x1 - x0;
        const vf form[8] = {f[0],           x0, y0, f[4] - f[0], xy0, (f[6] - f[4]) - y0, x2 - x0,
                            (x3 - x2) - xy0};
        const vf bound = largest * ((f_set(2048.0f) + f_set(32.0f) * e) * f_set(UNIT));
        crossing |= may_cross(in, way, form, bound + f_set(0x1p-130f));
    }
    return crossing;
}

/* Filter what has been queued, and add the rest to the batch. */
static void queue_flush(tile_walk *w) {
    const walk_scene *scene = scene_of(w);
    near_queue *q = &w->queue;
    unsigned left = (1u << q->count) - 1u;
    float samples[VF_N][8];
    if (q->count == 0)
        return;
    for (unsigned k = 0; k < q->count; k++) {
        walk_cell_samples(scene, q->at[k], q->cell[k], samples[k]);
        for (int s = 0; s < 8; s++)
            q->samples[s][k] = samples[k][s];
    }
    LANE_COUNT(queue, left);
    if (w->filter)
        left &= queue_may_cross(q, scene->isovalues, scene->count);
    LANE_COUNT(queue_survivors, left);
    q->count = 0;
    for (; left; left &= left - 1) {
        const unsigned k = (unsigned)__builtin_ctz(left), i = q->ray[k];
        if (w->pending[i / TILE] >> i % TILE & 1u)
            flush(w);
        if (is_open(w, i))
            add_to_batch(w, q->at[k], q->cell[k], samples[k], i);
        if (w->s.f->kernels->by_cell)
            flush(w);
    }
}

/* One active cell and the rays of its rectangle. Inlined, its loops are short of registers: frames
 * of large cells take x 1.2. */
static __attribute__((noinline)) void walk_cell(tile_walk *w, const resident_grid *at,
                                                const uint32_t cell[3], tile_rect r) {
    active_cell c;
    cell_begin(&c, at, w->place.p->at[at->level], cell);
    queue_flush(w); /* its cells are nearer */
    for (unsigned y = r.y0; y <= r.y1; y += WINDOW_Y) {
        for (unsigned x = r.x0; x <= r.x1; x += WINDOW_X) {
            near_visit v;
            unsigned bits = window_open(w, x, y, r);
            LANE_COUNT(windows, bits);
            if (bits)
                bits &= visits(&w->s.rays, STRIDE * y + x, &c.near, &v);
            if (bits)
                add_visitors(w, &c, &v, x, y, r, bits);
        }
    }
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

/* Which cells of a group a ray may visit; see visits(). */
SIMD unsigned group_visits(const tile_rays *rays, unsigned at, const group_planes *g, float t_in[],
                           float t_out[]) {
    vf in = f_set(rays->near_t0[at]), out = f_set(rays->near_t1[at]);
    for (int a = 0; a < 3; a++)
        near_slab(g->lo[a], g->hi[a], f_set(rays->reciprocal[a][at]), &in, &out);
    f_store(t_in, in);
    f_store(t_out, out);
    return near_passes(in, out) & ((1u << VF_N) - 1u);
}

SIMD void queue_add(tile_walk *w, const resident_grid *at, const plane_projection *const planes[3],
                    const uint32_t cell[3], unsigned i, float t_in, float t_out) {
    near_queue *q = &w->queue;
    const unsigned k = q->count++, padded = i / TILE * STRIDE + i % TILE;
    walk_cell_prefetch(scene_of(w), at, cell);
    for (int a = 0; a < 3; a++) {
        q->d[a][k] = w->s.rays.near_d[a][padded];
        q->lo[a][k] = planes[a][cell[a]].from_eye;
        q->hi[a][k] = planes[a][cell[a] + 1].from_eye;
        q->inv[a][k] = planes[a][cell[a]].inverse;
        q->cell[k][a] = cell[a];
    }
    q->t_in[k] = t_in;
    q->t_out[k] = t_out;
    q->at[k] = at;
    q->ray[k] = (uint8_t)i;
    w->s.counters->cells++;
    if (q->count == VF_N)
        queue_flush(w);
}

/* Where more rays look at a group, it is better seen cell by cell. */
enum { GROUP_RAYS_MAX = 8 };

/* A mask of octants o as one of places o ^ first in that order. */
static unsigned in_order(unsigned octants, unsigned first) {
    unsigned m = octants;
    m = first & 1u ? (m & 0x55u) << 1 | (m & 0xaau) >> 1 : m;
    m = first & 2u ? (m & 0x33u) << 2 | (m & 0xccu) >> 2 : m;
    return first & 4u ? (m & 0x0fu) << 4 | (m & 0xf0u) >> 4 : m;
}

/* The active cells of a group (octants), for the open rays of its rectangle one by one: few rays
 * visit the same cell there, and the lanes are better filled by its cells. */
static void walk_group(tile_walk *w, const resident_grid *at, const uint32_t first_cell[3],
                       unsigned active, unsigned first, tile_rect r) {
    enum { VECTORS_OF_8 = VF_N < 8 ? 8 / VF_N : 1 };
    const plane_projection *const *projected = w->place.p->at[at->level];
    group_planes planes[VECTORS_OF_8];
    for (unsigned v = 0; v < VECTORS_OF_8; v++)
        planes[v] = group_planes_of(projected, first_cell, v * VF_N);
    for (unsigned y = r.y0; y <= r.y1; y++) {
        for (unsigned left = w->s.open[y] & row_mask(r); left; left &= left - 1) {
            const unsigned x = (unsigned)__builtin_ctz(left);
            float t_in[VECTORS_OF_8 * VF_N], t_out[VECTORS_OF_8 * VF_N];
            unsigned visited = 0;
            for (unsigned v = 0; v < VECTORS_OF_8; v++)
                visited |= group_visits(&w->s.rays, STRIDE * y + x, &planes[v], t_in + v * VF_N,
                                        t_out + v * VF_N)
                           << v * VF_N;
            LANE_COUNT(groups, visited & active);
            for (unsigned places = in_order(visited & active, first); places;
                 places &= places - 1) {
                const unsigned o = (unsigned)__builtin_ctz(places) ^ first;
                const uint32_t cell[3] = {first_cell[0] + (o & 1u), first_cell[1] + (o >> 1 & 1u),
                                          first_cell[2] + (o >> 2)};
                queue_add(w, at, projected, cell, TILE * y + x, t_in[o], t_out[o]);
            }
        }
    }
}

/* ---- Nodes ---- */

/* The octant that the eye is in, or nearest to: children in the order first ^ 0, first ^ 1, ... are
 * front to back for any ray. */
static unsigned first_octant(const tile_walk *w, const level_planes *planes,
                             const uint32_t first[3], uint32_t half) {
    unsigned octant = 0;
    for (int a = 0; a < 3; a++)
        octant |= (unsigned)(planes->at[a][first[a] + half] <= w->place.p->eye[a]) << a;
    return octant;
}

static unsigned last_place(unsigned places) {
    return 31u - (unsigned)__builtin_clz(places);
}

/* Whether rays of the rectangle still look for a surface. When all that do have cells in the batch,
 * those are answered first. */
static bool wanted(tile_walk *w, tile_rect r) {
    unsigned open = 0, idle = 0;
    for (unsigned y = r.y0; y <= r.y1; y++) {
        open |= w->s.open[y];
        idle |= (unsigned)(w->s.open[y] & ~w->pending[y]);
    }
    if (!(open & row_mask(r)))
        return false;
    if (idle & row_mask(r))
        return true;
    flush(w);
    return any_of(w->s.open, r);
}

/* A node of a treelet's tree: a cube of 2^size cells. */
typedef struct tree_node {
    uint32_t cell[3];
    uint32_t morton;
    uint32_t size;
    tile_rect rect;
} tree_node;

enum { TREE_STACK_MAX = 8 * (LEAF_CELLS_LOG2_MAX + 1), DIRECTORY_STACK_MAX = 8 * LEAF_LEVELS_MAX };

static unsigned open_rays(const tile_walk *w, tile_rect r) {
    unsigned count = 0;
    for (unsigned y = r.y0; y <= r.y1; y++)
        count += (unsigned)__builtin_popcount(w->s.open[y] & row_mask(r));
    return count;
}

static void walk_tree(tile_walk *w, const resident_grid *at, tile_rect rect) {
    const level_planes *planes = &scene_of(w)->levels[at->level];
    const plane_projection *const *projected = w->place.p->at[at->level];
    tree_node stack[TREE_STACK_MAX];
    int top = 0;
    stack[top++] = (tree_node){{at->first_cell[0], at->first_cell[1], at->first_cell[2]},
                               0,
                               at->shape.node_levels + LEAF_BLOCK_LOG2,
                               rect};
    while (top > 0) {
        const tree_node node = stack[--top];
        if (!wanted(w, node.rect))
            continue;
        const uint32_t half = 1u << (node.size - 1);
        if (half == 1)
            tile_state_rays(&w->s);
        if (half == 1 && open_rays(w, node.rect) <= GROUP_RAYS_MAX) {
            const unsigned first = first_octant(w, planes, node.cell, 1);
            const unsigned active = walk_children(at, node.size, node.morton);
            w->s.counters->nodes++;
            walk_group(w, at, node.cell, active, first, node.rect);
            continue;
        }
        tile_rects rects;
        w->s.counters->nodes++;
        tile_rects_of(&w->place, projected, node.cell, half, &node.rect, &rects);
        const unsigned children = walk_children(at, node.size, node.morton) & rects.alive;
        const unsigned first = first_octant(w, planes, node.cell, half);
        unsigned places = in_order(children, first);
        if (half == 1) {
            for (; places; places &= places - 1) {
                const unsigned o = (unsigned)__builtin_ctz(places) ^ first;
                const uint32_t cell[3] = {node.cell[0] + (o & 1u), node.cell[1] + (o >> 1 & 1u),
                                          node.cell[2] + (o >> 2)};
                walk_cell(w, at, cell, rects.of[o]);
            }
            continue;
        }
        for (; places; places ^= 1u << last_place(places)) {
            const unsigned o = last_place(places) ^ first;
            stack[top++] =
                (tree_node){{node.cell[0] + (o & 1u) * half, node.cell[1] + (o >> 1 & 1u) * half,
                             node.cell[2] + (o >> 2) * half},
                            node.morton << 3 | o,
                            node.size - 1,
                            rects.of[o]};
        }
    }
}

/* The open rays of row y in the rectangle that pass treelet t: by their own intervals, since
 * rectangles are generous. A cell that the kernel lets a ray visit lies within. */
static unsigned rays_into(const tile_walk *w, uint32_t t, unsigned y, tile_rect r) {
    const leaf_layout *layout = w->s.f->tracer->layout;
    const level_planes *planes = &scene_of(w)->levels[layout->level_of[t]];
    unsigned passing = 0;
    for (unsigned left = w->s.open[y] & row_mask(r); left; left &= left - 1) {
        const unsigned x = (unsigned)__builtin_ctz(left), i = TILE * y + x;
        /* Behind what a ray has already, nothing is of use to it. */
        double t_in = w->s.rays.t0[i],
               t_out = w->s.t[i] < w->s.rays.t1[i] ? w->s.t[i] : w->s.rays.t1[i];
        for (int a = 0; a < 3; a++) {
            const double d = w->s.rays.d[a][i], eye = w->place.p->eye[a];
            /* The last treelet's cells end before it does. */
            const uint32_t first = layout->place[t][a] << layout->cells_log2;
            const uint32_t end = first + (1u << layout->cells_log2);
            const uint32_t last = end < planes->cells[a] ? end : planes->cells[a];
            ray_box_slab(planes->at[a][first], planes->at[a][last], eye, d, &t_in, &t_out);
        }
        passing |= (unsigned)(t_in <= t_out) << x;
    }
    return passing;
}

/* Remember that rays came into a treelet. */
static void touch(tile_walk *w, uint32_t t, tile_rect r) {
    atomic_uchar *touched = &w->s.f->tracer->touched[t];
    if (atomic_load_explicit(touched, memory_order_relaxed))
        return;
    tile_state_rays(&w->s);
    queue_flush(w);
    flush(w);
    for (unsigned y = r.y0; y <= r.y1; y++)
        if (rays_into(w, t, y, r)) {
            atomic_store_explicit(touched, 1, memory_order_relaxed);
            return;
        }
}

/* Rays that pass a treelet which is not there go no further. */
static void miss_treelet(tile_walk *w, uint32_t t, tile_rect r) {
    unsigned any = 0;
    tile_state_rays(&w->s);
    queue_flush(w);
    flush(w);
    for (unsigned y = r.y0; y <= r.y1; y++) {
        const unsigned passing = rays_into(w, t, y, r);
        w->s.out->waits[y] |= (tile_row)passing;
        w->s.open[y] &= ~(tile_row)passing;
        any |= passing;
    }
    if (any)
        tile_absent(w->s.out, t);
}

static void walk_drawn(tile_walk *w, uint32_t t, tile_rect r) {
    const loader *treelets = w->s.f->tracer->treelets;
    if (!treelets->own[t])
        return;
    const resident_grid *at = resident_grid_of(loader_lookup(treelets, t));
    if (!at) {
        miss_treelet(w, t, r);
        return;
    }
    touch(w, t, r);
    walk_tree(w, at, r);
}

typedef struct directory_node {
    uint32_t t;
    tile_rect rect;
} directory_node;

static void walk_directory(tile_walk *w, tile_rect rect) {
    const tracer *tr = w->s.f->tracer;
    const leaf_layout *layout = tr->layout;
    const uint32_t half = 1u << (layout->cells_log2 - 1);
    directory_node stack[DIRECTORY_STACK_MAX];
    int top = 0;
    stack[top++] = (directory_node){0, rect};
    while (top > 0) {
        const directory_node node = stack[--top];
        if (!wanted(w, node.rect))
            continue;
        const uint32_t level = layout->level_of[node.t];
        if (level == tr->target_level || (tr->stop && tr->stop[node.t])) {
            walk_drawn(w, node.t, node.rect);
            continue;
        }
        uint32_t first[3];
        for (int a = 0; a < 3; a++)
            first[a] = layout->place[node.t][a] << layout->cells_log2;
        tile_rects rects;
        w->s.counters->nodes++;
        tile_rects_of(&w->place, w->place.p->at[level], first, half, &node.rect, &rects);
        const unsigned children = tr->treelets->children[node.t] & rects.alive;
        const unsigned existing = leaf_layout_children(layout, node.t);
        const unsigned eye = first_octant(w, &scene_of(w)->levels[level], first, half);
        for (unsigned places = in_order(children, eye); places;
             places ^= 1u << last_place(places)) {
            const unsigned o = last_place(places) ^ eye;
            const uint32_t rank = (uint32_t)__builtin_popcount(existing & ((1u << o) - 1u));
            stack[top++] = (directory_node){layout->first_child[node.t] + rank, rects.of[o]};
        }
    }
    queue_flush(w);
    flush(w);
}

/* All of a tile's rays up to their first surfaces. */
static void tile_walk_run(tile_walk *w, const frame *f, uint32_t x0, uint32_t y0,
                          const tile_row asked[], tile_outcome *out, ray_counters *counters) {
    tile_state_begin(&w->s, f, x0, y0, asked, out, counters);
    w->place = tile_place_of(f, x0, y0);
    w->filter = scene_of(w)->intersector == LEAFCAST_MARMITT;
    w->waiting = 0;
    w->queue = (near_queue){.count = 0};
    for (unsigned y = 0; y < ROWS; y++)
        w->pending[y] = 0;
    const uint8_t packet = f->kernels->packet;
    for (uint8_t y = 0; y < TILE; y += packet)
        for (uint8_t x = 0; x < TILE; x += packet)
            walk_directory(w,
                           (tile_rect){x, (uint8_t)(x + packet - 1), y, (uint8_t)(y + packet - 1)});
}

#endif
#endif
