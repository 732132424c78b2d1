/* hex_tile_cells_template.h - rays of a tile, and a cell: where the rays of the pixels that it can
 * cover meet it; included by the units of an ISA (see formats/base/simd.h).
 */
#ifndef RENDER_CURVED_HEX_TILE_CELLS_TEMPLATE_H
#define RENDER_CURVED_HEX_TILE_CELLS_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "formats/curved/curved_normal_template.h"
#include "render/curved/curved_meet.h"
#include "render/curved/curved_meet_template.h"
#include "render/curved/hex_shade_template.h"
#include "render/tile/tile_boxes_template.h"

typedef struct hex_tile {
    tile_boxes b;
    const treelet *at; /* that is walked */
    /* Of each ray, as sheared_ray, once they are needed: */
    bool sheared;
    double slope[2][TILE_RAYS], along[TILE_RAYS];
    tile_row longest[3][TILE]; /* the rays whose longest axis is this */
    bool any[3];               /* some ray's is */
} hex_tile;

/* ---- Rays ---- */

SIMD vd by_axis(md x, md y, const vd of[3], unsigned shift) {
    return d_select(x, of[shift % 3], d_select(y, of[(shift + 1) % 3], of[(shift + 2) % 3]));
}

/* As sheared_ray_of(). */
static void shear_rays(hex_tile *w) {
    if (w->sheared)
        return;
    w->sheared = true;
    memset(w->longest, 0, sizeof w->longest);
    w->any[0] = w->any[1] = w->any[2] = false;
    for (unsigned i = 0; i < TILE_RAYS; i += VD_N) {
        vd d[3];
        for (int a = 0; a < 3; a++)
            d[a] = d_load(w->b.s.rays.d[a] + i);
        const md y_more = d_gt(d_abs(d[1]), d_abs(d[0]));
        const md z = d_gt(d_abs(d[2]), d_select(y_more, d_abs(d[1]), d_abs(d[0])));
        const md y = md_and_not(y_more, z), x = md_and_not(md_of_bits(~0u), md_or(y, z));
        const unsigned bits[3] = {md_bits(x), md_bits(y), md_bits(z)};
        const vd along = by_axis(x, y, d, 0);
        d_store(w->along + i, along);
        d_store(w->slope[0] + i, by_axis(x, y, d, 1) / along);
        d_store(w->slope[1] + i, by_axis(x, y, d, 2) / along);
        for (int a = 0; a < 3; a++) {
            const unsigned of = bits[a] & ((1u << VD_N) - 1u);
            w->longest[a][i / TILE] |= (tile_row)of << i % TILE;
            w->any[a] = w->any[a] || of;
        }
    }
}

/* ---- Hits ---- */

/* A cell, and the pixels that it can cover. */
typedef struct near_cell {
    uint32_t number; /* in the treelet */
    tile_rect rect;
    float depth; /* no point of it is nearer */
    curved_cell cell;
} near_cell;

/* Whether ray i looks as far as t, and no farther than its surfaces. */
SIMD bool looks_at(const hex_tile *w, unsigned i, double t) {
    const tile_rays *rays = &w->b.s.rays;
    return t >= rays->t0[i] && t <= rays->t1[i] && t <= w->b.s.reach[i];
}

static void take_root(hex_tile *w, unsigned i, const tile_surface *found) {
    if (!tile_state_take(&w->b.s, i, *found))
        return;
    if (w->b.s.reach[i] < (double)INFINITY)
        look_as_far(&w->b, i);
    w->b.s.counters->roots++;
}

/* Decide by the cell's faces what the vectors leave in doubt. */
static void take_crossed(hex_tile *w, const near_cell *c, unsigned i, int32_t iso) {
    const ray r = tile_ray(&w->b.s, i);
    const sheared_ray sheared = sheared_ray_of(r.o, r.d);
    path_root roots[PATH_ROOTS];
    const int count =
        curved_meet_crossed(&c->cell, &sheared, w->b.s.f->tracer->isos.isovalues[iso], roots, NULL);
    for (int n = 0; n < count; n++) {
        const double *at = roots[n].at;
        double gradient[3];
        tile_surface found = {
            roots[n].t, w->at, c->number, iso, roots[n].entering, {at[0], at[1], at[2]}, {0.0f}};
        if (!looks_at(w, i, found.t))
            continue;
        curved_cell_gradient(&c->cell, at, gradient, found.normal);
        take_root(w, i, &found);
    }
}

/* ---- Rays and a cell ---- */

/* Rays that may meet the cell's isosurface. */
typedef struct near_rays {
    unsigned count;
    uint16_t of[TILE_RAYS + VD_N];
} near_rays;

/* Vectors of rays are windows of D_ROW pixels a row. */
enum { WINDOW = VD_N / D_ROW };

/* Returns the rays of a window, its first pixel (x, y), that look at the cell; of the columns
 * `columns`. */
SIMD unsigned rays_in_window(const hex_tile *w, const near_cell *c, int axis, unsigned x,
                             unsigned y, tile_row columns) {
    unsigned bits = 0;
    for (unsigned k = 0; k < WINDOW; k++)
        if (y + k >= c->rect.y0 && y + k <= c->rect.y1)
            bits |= ((columns & w->b.s.open[y + k] & w->longest[axis][y + k]) >> x &
                     ((1u << D_ROW) - 1u))
                    << D_ROW * k;
    if (!bits)
        return 0;
    const vd reach = d_load_rows(w->b.s.reach + TILE * y + x, TILE);
    return bits & md_bits(d_ge(reach, d_set((double)c->depth)));
}

/* List the rays of the cell's pixels whose longest axis is this, and that may meet the isosurface.
 */
SIMD void list_rays(const hex_tile *w, const near_cell *c, const curved_sight *sight, int terms,
                    curved_rays *rays, double isovalue, near_rays *out) {
    out->count = 0;
    for (unsigned y = c->rect.y0 & ~(WINDOW - 1u); y <= c->rect.y1; y += WINDOW)
        for (unsigned from = c->rect.x0; from <= c->rect.x1; from += D_ROW) {
            /* The last window of a row may begin before the first pixel that is new to it. */
            const unsigned x = from < TILE - D_ROW ? from : TILE - D_ROW, i = TILE * y + x;
            unsigned bits =
                rays_in_window(w, c, rays->axis[2], x, y, row_mask(c->rect) & ~((1u << from) - 1u));
            if (!bits)
                continue;
            for (int k = 0; k < 2; k++)
                rays->slope[k] = d_load_rows(w->slope[k] + i, TILE);
            for (bits &= md_bits(curved_may_meet(sight, terms, rays, isovalue)); bits;
                 bits &= bits - 1) {
                const unsigned k = (unsigned)__builtin_ctz(bits);
                out->of[out->count++] = (uint16_t)(i + TILE * (k / D_ROW) + k % D_ROW);
            }
        }
}

SIMD void meet_rays(hex_tile *w, const near_cell *c, const curved_sight *sight, int terms,
                    curved_rays *rays, int32_t iso, const uint16_t of[VD_N], unsigned lanes) {
    curved_forms forms;
    curved_met met;
    vd gradient[3], unit[3];
    double t[VD_N], at[3][VD_N];
    float normal[3][VD_N];
    for (int k = 0; k < 2; k++)
        rays->slope[k] = d_load_at(w->slope[k], of);
    rays->d = d_load_at(w->along, of);
    curved_forms_of(sight, terms, rays, w->b.s.f->tracer->isos.isovalues[iso], &forms);
    curved_meet_lanes(sight, terms, rays, &forms, md_of_bits(lanes), &met);
    for (unsigned left = md_bits(met.unknown) & lanes; left; left &= left - 1)
        take_crossed(w, c, of[__builtin_ctz(left)], iso);
    unsigned left = md_bits(met.once) & lanes;
    if (!left)
        return;
    const unsigned enters = c->cell.sense > 0 ? md_bits(met.enters) : ~md_bits(met.enters);
    if (terms == TRILINEAR)
        (void)hex_gradient(&c->cell.hexahedron, met.at, gradient);
    else
        (void)quadratic_gradient(&c->cell.tet, met.at, gradient);
    curved_normal(gradient, unit);
    d_store(t, met.t);
    for (int a = 0; a < 3; a++) {
        d_store(at[a], met.at[a]);
        d_store_floats(normal[a], unit[a]);
    }
    for (; left; left &= left - 1) {
        const unsigned k = (unsigned)__builtin_ctz(left);
        const tile_surface found = {t[k],
                                    w->at,
                                    c->number,
                                    iso,
                                    enters >> k & 1u,
                                    {at[0][k], at[1][k], at[2][k]},
                                    {normal[0][k], normal[1][k], normal[2][k]}};
        if (looks_at(w, of[k], t[k]))
            take_root(w, of[k], &found);
    }
}

SIMD void meet_isosurface(hex_tile *w, const near_cell *c, const curved_sight *sight, int terms,
                          int32_t iso) {
    for (int axis = 0; axis < 3; axis++) {
        curved_rays rays = {.axis = {(axis + 1) % 3, (axis + 2) % 3, axis}};
        near_rays near;
        if (!w->any[axis])
            continue;
        list_rays(w, c, sight, terms, &rays, w->b.s.f->tracer->isos.isovalues[iso], &near);
        for (unsigned n = 0; n < VD_N; n++)
            near.of[near.count + n] = near.of[0];
        for (unsigned n = 0; n < near.count; n += VD_N) {
            const unsigned left = near.count - n;
            meet_rays(w, c, sight, terms, &rays, iso, near.of + n,
                      left < VD_N ? (1u << left) - 1u : (1u << VD_N) - 1u);
        }
    }
}

static void meet_hexahedron(hex_tile *w, const near_cell *c, const curved_sight *sight,
                            int32_t iso) {
    meet_isosurface(w, c, sight, TRILINEAR, iso);
}

static void meet_tet(hex_tile *w, const near_cell *c, const curved_sight *sight, int32_t iso) {
    meet_isosurface(w, c, sight, FORM_TERMS, iso);
}

/* A folded cell: all its pixels' rays cross its faces. */
static void meet_crossed(hex_tile *w, const near_cell *c, const curved_sight *sight, int32_t iso) {
    (void)sight;
    for (unsigned y = c->rect.y0; y <= c->rect.y1; y++)
        for (tile_row left = row_mask(c->rect) & w->b.s.open[y]; left; left &= left - 1)
            take_crossed(w, c, TILE * y + (unsigned)__builtin_ctz(left), iso);
}

static void walk_cell(hex_tile *w, near_cell *c) {
    const isovalue_list *isos = &w->b.s.f->tracer->isos;
    void (*meet)(hex_tile *, const near_cell *, const curved_sight *, int32_t) = meet_crossed;
    double range[2];
    curved_sight sight;
    w->b.s.counters->cells++;
    c->cell = hex_tile_cell(w->at, c->number);
    curved_cell_range(&c->cell, range);
    if (c->cell.sense && c->cell.quadratic) {
        curved_sight_of_tet(&c->cell.tet, w->b.eye, &sight);
        meet = meet_tet;
    } else if (c->cell.sense) {
        curved_sight_of_hexahedron(&c->cell.hexahedron, w->b.eye, &sight);
        meet = meet_hexahedron;
    }
    for (int32_t iso = 0; iso < isos->count; iso++)
        if (range[0] < isos->isovalues[iso] && isos->isovalues[iso] <= range[1])
            meet(w, c, &sight, iso);
}

#endif
#endif
