/* mesh_tile_tets_template.h - active tets of a treelet as seen by a tile, a vector at a time, in
 * single precision: finds which pixels their isopolygons can cover; included by the units of an ISA
 * (see formats/base/simd.h). */
#ifndef RENDER_MESH_MESH_TILE_TETS_TEMPLATE_H
#define RENDER_MESH_MESH_TILE_TETS_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/mesh/mesh_tile_polygons_template.h"
#include "stream/interest.h"

/* Tets as seen from the eye, a lane each: homogeneous pixel coordinates of their vertices, and
 * their values. */
typedef struct tets_in_view {
    vf x[4], y[4], w[4], f[4];
    vf far; /* bound of all vertices' distances */
    mf odd; /* lanes with values too large for sums and quotients of floats */
} tets_in_view;

/* Positions, and the eye's in double, are relative to the treelet's lower corner. So the error is a
 * few units of 2^-24 of the distance and of the treelet's size. */
SIMD void view_tets(const mesh_tile *w, const resident_mesh *at, const tet_lanes *l,
                    tets_in_view *v) {
    const projection *p = w->b.view.p;
    const float *positions = at->positions[0];
    const float *values = mesh_leaf_values(&at->mesh, at->values);
    float size = 0.0f;
    for (int a = 0; a < 3; a++)
        size += p->axis[a][3] * (at->bounds[a + 3] - at->bounds[a]);
    v->far = f_set(0.0f);
    v->odd = mf_of_bits(0);
    for (int k = 0; k < 4; k++) {
        _Alignas(64) float f[VF_N];
        vf at_corner[3], away = f_set(size);
        f_load_triples(positions, l->vertex[k], at_corner);
        v->x[k] = v->y[k] = v->w[k] = f_set(0.0f);
        for (int a = 0; a < 3; a++) {
            const float lo = at->bounds[a];
            const vf q = (at_corner[a] - f_set(lo)) - f_set((float)(w->b.eye[a] - (double)lo));
            v->x[k] = v->x[k] + f_set(p->axis[a][0]) * q;
            v->y[k] = v->y[k] + f_set(p->axis[a][1]) * q;
            v->w[k] = v->w[k] + f_set(p->axis[a][2]) * q;
            away = away + f_set(p->axis[a][3]) * f_abs(q);
        }
        v->far = f_max(v->far, away);
        for (unsigned i = 0; i < VF_N; i++)
            f[i] = values[l->vertex[k][i]];
        v->f[k] = f_load(f);
        v->odd = mf_or(v->odd, f_gt(f_abs(v->f[k]), f_set(0x1p125f)));
    }
}

/* Where the isosurface cuts tets' edges, in the picture. x and y are undefined for edges that it
 * does not cut. */
typedef struct cut_points {
    vf x[TET_EDGES], y[TET_EDGES];
    mf cut[TET_EDGES];
} cut_points;

/* Bound the isopolygons of tets in the picture, by the points where they cut the tets' edges. Such
 * a point is at the share s of its edge. s errs by six units of 2^-24 of itself, for numerator,
 * denominator and quotient. So the point errs by less than the error allowed for boxes' corners. */
SIMD children_extent extent_of_polygons(const tets_in_view *v, double iso, cut_points *c) {
    const vf most = f_set(INFINITY), least = f_set(-INFINITY), zero = f_set(0.0f);
    const vf threshold = f_set(value_limits_threshold(iso));
    const vf near = f_set((float)iso), rest = f_set((float)(iso - (double)(float)iso));
    children_extent e = {most, least, most, least, most, least};
    unsigned edge = 0;
    vf up[4];
    mf in[4];
    for (int k = 0; k < 4; k++) {
        in[k] = f_ge(v->f[k], threshold);
        up[k] = (near - v->f[k]) + rest;
    }
    for (int i = 0; i < 3; i++) {
        for (int j = i + 1; j < 4; j++, edge++) {
            const mf cut = mf_and_not(mf_or(in[i], in[j]), mf_and(in[i], in[j]));
            const vf s = f_max(zero, f_min(up[i] / (v->f[j] - v->f[i]), f_set(1.0f)));
            const vf w = v->w[i] + s * (v->w[j] - v->w[i]), r = f_reciprocal(w);
            const vf x = (v->x[i] + s * (v->x[j] - v->x[i])) * r;
            const vf y = (v->y[i] + s * (v->y[j] - v->y[i])) * r;
            e.x0 = f_min(e.x0, f_select(cut, x, most));
            e.x1 = f_max(e.x1, f_select(cut, x, least));
            e.y0 = f_min(e.y0, f_select(cut, y, most));
            e.y1 = f_max(e.y1, f_select(cut, y, least));
            e.w0 = f_min(e.w0, f_select(cut, w, most));
            c->x[edge] = x;
            c->y[edge] = y;
            c->cut[edge] = cut;
        }
    }
    return e;
}

/* Take pairs of edges without a common vertex (01 23, 02 13, 03 12). A triangle has a corner on one
 * edge of each pair. A quadrilateral has opposite corners on both edges of two of these pairs. */
SIMD flat_polygons flatten(const tile_view *tile, const void *points) {
    const cut_points *c = points;
    enum { E01, E02, E03, E12, E13, E23 };
    const mf both = mf_and(c->cut[E01], c->cut[E23]), any = mf_or(c->cut[E01], c->cut[E23]);
    const mf triangle = mf_and_not(any, both);
    flat_polygons p;
    for (int axis = 0; axis < 2; axis++) {
        const vf *of = axis ? c->y : c->x;
        vf *to = axis ? p.y : p.x;
        const vf origin = f_set(axis ? tile->y : tile->x);
        to[0] = f_select(c->cut[E01], of[E01], f_select(c->cut[E23], of[E23], of[E02]));
        to[1] = f_select(triangle, f_select(c->cut[E02], of[E02], of[E13]),
                         f_select(c->cut[E03], of[E03], of[E02]));
        to[2] = f_select(triangle, f_select(c->cut[E03], of[E03], of[E12]),
                         f_select(c->cut[E23], of[E23], of[E13]));
        to[3] = f_select(triangle, to[2], f_select(c->cut[E03], of[E12], of[E13]));
        for (int i = 0; i < 4; i++)
            to[i] = to[i] - origin;
        to[4] = to[0];
    }
    return p;
}

/* Find which part of their leaves' rectangles the isopolygons can cover. Returns the lanes that
 * cover anything. An isopolygon nearer than a sixteenth of the bound on distances counts as
 * covering the whole rectangle. */
SIMD unsigned covers_of(const mesh_tile *w, const tet_lanes *l, const tets_in_view *v, double iso,
                        flat_covers *out) {
    const unsigned lanes = (1u << l->count) - 1u;
    const rect_lanes within = rect_lanes_load(l->within);
    cut_points c;
    const children_extent e = extent_of_polygons(v, iso, &c);
    const mf whole = mf_or(v->odd, f_lt(e.w0, v->far * f_set(projection_depth_share)));
    mf alive;
    const vi packed =
        rects_of_extent(&w->b.view, &e, 2.0f * w->b.view.p->margin, whole, within, &alive);
    memcpy(out->rect, &packed, sizeof packed);
    f_store(out->depth, f_select(whole, f_set(0.0f), e.w0 - f_set(0x1p-19f) * v->far));
    alive = mf_and(alive, mf_of_bits(lanes));
    LANE_COUNT(covers, mf_bits(alive));
    const mf none =
        cover_no_centre(&w->b.view, flatten, &c, &e, v->far, mf_and_not(alive, whole), out);
    LANE_COUNT(covering, mf_bits(mf_and_not(alive, none)));
    return mf_bits(mf_and_not(alive, none));
}

static void walk_lanes(mesh_tile *w, const resident_mesh *at, tet_lanes *l) {
    const isovalue_list *isos = &w->b.s.f->tracer->isos;
    tets_in_view view;
    for (unsigned k = l->count; k < VF_N; k++)
        for (int v = 0; v < 4; v++)
            l->vertex[v][k] = l->vertex[v][0];
    view_tets(w, at, l, &view);
    LANE_COUNT(tets, (1u << l->count) - 1u);
    for (int32_t i = 0; i < isos->count; i++) {
        flat_covers covers;
        for (unsigned left = covers_of(w, l, &view, isos->isovalues[i], &covers); left;
             left &= left - 1) {
            const unsigned k = (unsigned)__builtin_ctz(left);
            const float near2 = covers.depth[k] * covers.depth[k];
            const tile_rect rect = covers.rect[k];
            const uint32_t centres = centres_in_sight(w, rect, covers.centres[k], near2);
            if (centres || (!covers.centres[k] && in_sight(&w->b, rect, near2)))
                put_tet(w, at, l, k, i, rect, centres);
        }
    }
    w->b.s.counters->cells += l->count;
    l->count = 0;
}

/* Walk the waiting vector, if there is one. Then the vector that was filling waits. */
static void walk_waiting(mesh_tile *w, const resident_mesh *at) {
    w->filling ^= 1u;
    if (w->lanes[w->filling].count > 0)
        walk_lanes(w, at, &w->lanes[w->filling]);
}

/* A vector is walked when the next one is full. Its vertices are prefetched when its tets are
 * added, so they are there by then. */
static void add_lane(mesh_tile *w, const resident_mesh *at, uint32_t local, const tile_rect *r) {
    const uint16_t *v = mesh_leaf_tets(&at->mesh, at->head.payload)[local];
    const float *values = mesh_leaf_values(&at->mesh, at->values);
    tet_lanes *l = &w->lanes[w->filling];
    for (int k = 0; k < 4; k++) {
        __builtin_prefetch(at->positions[v[k]]);
        __builtin_prefetch(values + v[k]);
        l->vertex[k][l->count] = v[k];
    }
    l->within[l->count] = *r;
    l->local[l->count++] = local;
    if (l->count == VF_N)
        walk_waiting(w, at);
}

static void walk_leaf(mesh_tile *w, const resident_mesh *at, uint32_t first, uint32_t end,
                      const tile_rect *r) {
    for (uint32_t word = first / 64; word * 64 < end; word++) {
        uint64_t bits = mesh_active_word(at->active, word, first, end);
        for (; bits; bits &= bits - 1)
            add_lane(w, at, word * 64 + (uint32_t)__builtin_ctzll(bits), r);
    }
}

#endif
#endif
