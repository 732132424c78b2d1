/* mesh_tile_template.h - mesh_tile_X() of mesh_tile.h; included by the units of an ISA (see
 * formats/base/simd.h). */
#ifndef RENDER_MESH_MESH_TILE_TEMPLATE_H
#define RENDER_MESH_MESH_TILE_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include <float.h>

#include "render/lane_counts.h"
#include "render/mesh/isopolygon_cache.h"
#include "render/mesh/mesh_box_template.h"
#include "render/mesh/mesh_shade_template.h"
#include "render/mesh/mesh_tile.h"
#include "render/mesh/mesh_tracer.h"
#include "render/mesh/tet_sight_template.h"
#include "render/tile_rects_template.h"
#include "stream/interest.h"

void SIMD_NAME(mesh_tile)(const frame *f, uint32_t x0, uint32_t y0, const tile_row asked[],
                          tile_outcome *out, ray_counters *counters);

/* Active tets of a treelet, a lane each, on their way to covers_of(). */
typedef struct tet_lanes {
    uint32_t vertex[4][VF_N]; /* in the treelet */
    tile_rect within[VF_N];   /* those of their leaves */
    uint32_t local[VF_N];
    unsigned count;
} tet_lanes;

typedef struct mesh_tile {
    tile_state s;
    tile_view view;
    double eye[3];
    tet_lanes lanes;
    float far2[TILE_RAYS + VF_N]; /* squares of how far rays look; below 0: they do not */
} mesh_tile;

/* What lies in the outcome's scratch. */
typedef struct mesh_work {
    mesh_tile tile;
    mesh_shading shading;
} mesh_work;
_Static_assert(sizeof(mesh_work) <= MESH_TILE_SCRATCH, "a tile has room in its scratch");

/* ---- Who is behind what ---- */

/* What is given away on distances (squared) of single precision: more than their rounding. */
static const float SURELY = 1.0f - 0x1p-20f;

/* How far ray i looks. */
SIMD void look_as_far(mesh_tile *w, unsigned i) {
    const double t = w->s.reach[i];
    w->far2[i] = (float)(t * t) + FLT_MIN;
}

/* Look no more with rays that are not open. */
static void look_with_open(mesh_tile *w) {
    for (unsigned y = 0; y < TILE; y++)
        for (unsigned left = row_full & ~w->s.open[y]; left; left &= left - 1)
            w->far2[TILE * y + (unsigned)__builtin_ctz(left)] = -1.0f;
}

/* Nothing has been found. */
static void look_at_all(mesh_tile *w) {
    for (unsigned i = 0; i < TILE_RAYS + VF_N; i += VF_N)
        f_store(w->far2 + i, f_set(INFINITY));
    look_with_open(w);
}

/* Whether an open ray of the rectangle has nothing in front of a distance (squared); a distance
 * that is no number is in sight. */
SIMD bool in_sight(const mesh_tile *w, tile_rect r, float near2) {
    enum { LANES = (1u << VF_N) - 1 };
    const vf at = f_set(near2 * SURELY);
    const unsigned columns = row_mask(r);
    for (unsigned y = r.y0; y <= r.y1; y++)
        for (unsigned x = r.x0; x <= r.x1; x += VF_N)
            if (~mf_bits(f_lt(f_load(w->far2 + TILE * y + x), at)) & columns >> x & LANES)
                return true;
    return false;
}

/* ---- Boxes ---- */

/* Eight boxes, their planes as seen from the eye. AVX-512 has lanes that are idle. */
enum { BOX_LANES = VF_N > 8 ? VF_N : 8 };

typedef struct near_boxes {
    _Alignas(64) float lo[3][BOX_LANES], hi[3][BOX_LANES];
} near_boxes;

typedef struct box_rects {
    tile_rects rects;
    _Alignas(64) float near2[BOX_LANES]; /* squares of their distances */
} box_rects;

/* Lanes without a box: nothing out of the ordinary comes in. */
SIMD void leave_idle(near_boxes *b, unsigned from) {
    for (int a = 0; a < 3; a++)
        for (unsigned c = from; c < BOX_LANES; c++)
            b->lo[a][c] = b->hi[a][c] = 0.0f;
}

SIMD void rects_of_boxes(const mesh_tile *w, const near_boxes *b, const tile_rect *parent,
                         box_rects *out) {
    const projection *p = w->view.p;
    out->rects.alive = 0;
    for (unsigned lane = 0; lane < 8; lane += VF_N) {
        const vf zero = f_set(0.0f);
        children_entries c = {.far = zero};
        vf near2 = zero;
        for (int a = 0; a < 3; a++) {
            const vf lo = f_load(b->lo[a] + lane), hi = f_load(b->hi[a] + lane);
            const vf outside_of = f_max(f_max(lo, f_set(-0.0f) - hi), zero);
            near2 = near2 + outside_of * outside_of;
            c.x.lo[a] = lo * f_set(p->axis[a][0]);
            c.x.hi[a] = hi * f_set(p->axis[a][0]);
            c.y.lo[a] = lo * f_set(p->axis[a][1]);
            c.y.hi[a] = hi * f_set(p->axis[a][1]);
            c.w.lo[a] = lo * f_set(p->axis[a][2]);
            c.w.hi[a] = hi * f_set(p->axis[a][2]);
            c.far = c.far + f_max(f_abs(lo), f_abs(hi)) * f_set(p->axis[a][3]);
        }
        f_store(out->near2 + lane, near2);
        tile_rects_of_entries(&w->view, &c, lane, parent, &out->rects);
    }
    out->rects.alive &= 255u;
}

/* The children in `left`, the farthest first. */
SIMD unsigned by_distance(const float near2[BOX_LANES], unsigned left, uint8_t order[8]) {
    unsigned count = 0;
    for (; left; left &= left - 1) {
        const unsigned c = (unsigned)__builtin_ctz(left);
        unsigned at = count++;
        for (; at > 0 && near2[order[at - 1]] < near2[c]; at--)
            order[at] = order[at - 1];
        order[at] = (uint8_t)c;
    }
    return count;
}

/* ---- Isopolygons ---- */

typedef struct seen_polygon {
    isopolygon g;
    /* Its near_polygon, for vectors of rays. */
    vd a[4][3], normal[EDGES][3], error[EDGES];
    const resident_mesh *at;
    uint32_t tet;
    int32_t iso;
} seen_polygon;

/* ---- Rays and polygons ---- */

/* A hit of ray i: before what it has? */
static void take_surface(mesh_tile *w, const seen_polygon *s, unsigned i, double t, bool entering) {
    const tile_surface found = {t, &s->at->head, s->tet, s->iso, entering};
    if (!tile_state_take(&w->s, i, &found))
        return;
    if (w->s.reach[i] < (double)INFINITY)
        look_as_far(w, i);
    w->s.counters->roots++;
}

/* What the vectors leave in doubt: a bent quadrilateral has two hits. */
static void take_scalar(mesh_tile *w, const seen_polygon *s, unsigned i) {
    const uint64_t cell = s->at->first_tet + s->tet;
    hit before = hit_before_all(), found;
    ray r = {.t0 = w->s.rays.t0[i], .t1 = w->s.rays.t1[i]};
    for (int a = 0; a < 3; a++) {
        r.o[a] = r.held[a] = w->eye[a];
        r.d[a] = w->s.rays.d[a][i];
    }
    for (; isopolygon_hit(&s->g, &r, cell, s->iso, &before, &found); before = found)
        take_surface(w, s, i, found.t, found.entering);
}

/* Hits that are sure, and before what the rays have; enters: along the normal. */
SIMD void take_sure(mesh_tile *w, const seen_polygon *s, unsigned i, unsigned hits, unsigned enters,
                    vd t) {
    const tile_rays *rays = &w->s.rays;
    const md after = d_ge(t, d_load(rays->t0 + i)), before = d_le(t, d_load(rays->t1 + i));
    const md nearer = d_le(t, d_load(w->s.reach + i));
    double ts[VD_N];
    d_store(ts, t);
    for (hits &= md_bits(md_and(nearer, md_and(after, before))); hits; hits &= hits - 1) {
        const unsigned k = (unsigned)__builtin_ctz(hits);
        take_surface(w, s, i + k, ts[k], enters >> k & 1u);
    }
}

/* VD_N rays of a row, from ray i on; lanes: which of them. */
SIMD void meet_polygon(mesh_tile *w, const seen_polygon *s, unsigned i, unsigned lanes) {
    const tile_rays *rays = &w->s.rays;
    const vd d[3] = {d_load(rays->d[0] + i), d_load(rays->d[1] + i), d_load(rays->d[2] + i)};
    const weights w12 = weigh(d, s->normal[EDGE_12], s->error[EDGE_12]);
    const weights w20 = weigh(d, s->normal[EDGE_20], s->error[EDGE_20]);
    const weights w01 = weigh(d, s->normal[EDGE_01], s->error[EDGE_01]);
    const verdict v = judge(w12, w20, w01);
    const unsigned hits = md_bits(md_or(v.enters, v.leaves)) & lanes;
    LANE_COUNT(rays, lanes);
    LANE_COUNT(centres, hits);
    unsigned doubtful = md_bits(v.doubtful);
    if (s->g.count == 4) {
        const weights w23 = weigh(d, s->normal[EDGE_23], s->error[EDGE_23]);
        const weights w30 = weigh(d, s->normal[EDGE_30], s->error[EDGE_30]), w02 = against(w20);
        const verdict v2 = judge(w23, w30, w02);
        const unsigned hits2 = md_bits(md_or(v2.enters, v2.leaves)) & lanes;
        LANE_COUNT(centres, hits2);
        /* A quadrilateral that is hit twice is bent: not here. */
        doubtful |= md_bits(v2.doubtful) | (hits & hits2);
        if (hits2 & ~doubtful)
            take_sure(w, s, i, hits2 & ~doubtful, md_bits(v2.enters),
                      cross_at(d, s->a[0], s->a[2], s->a[3], w23, w30, w02));
    }
    if (hits & ~doubtful)
        take_sure(w, s, i, hits & ~doubtful, md_bits(v.enters),
                  cross_at(d, s->a[0], s->a[1], s->a[2], w12, w20, w01));
    for (unsigned left = doubtful & lanes; left; left &= left - 1)
        take_scalar(w, s, i + (unsigned)__builtin_ctz(left));
}

static void walk_polygon(mesh_tile *w, seen_polygon *s, tile_rect r) {
    enum { LANES = (1u << VD_N) - 1 };
    const unsigned columns = row_mask(r);
    for (unsigned y = r.y0; y <= r.y1; y++) {
        for (unsigned left = w->s.open[y] & columns; left;) {
            const unsigned first = (unsigned)__builtin_ctz(left);
            const unsigned x = first < TILE - VD_N ? first : TILE - VD_N;
            meet_polygon(w, s, TILE * y + x, left >> x & LANES);
            left &= ~((unsigned)LANES << x);
        }
    }
}

/* ---- Leaves ---- */

/* The tet of a lane. */
SIMD near_tet lane_tet(const tet_lanes *l, const resident_mesh *at, unsigned lane) {
    const float *values = mesh_leaf_values(&at->mesh, at->values);
    near_tet x;
    for (int k = 0; k < 4; k++) {
        const uint32_t v = l->vertex[k][lane];
        x.v[k] = point4_of_triple(at->positions[v]);
        x.v[k][3] = (double)values[v];
    }
    return x;
}

/* Made, or kept with the treelet; false: none. */
SIMD bool polygon_of(const mesh_tile *w, const resident_mesh *at, unsigned lane, int32_t iso,
                     isopolygon *out) {
    const double isovalue = w->s.f->tracer->isos.isovalues[iso];
    const uint32_t local = w->lanes.local[lane];
    if (!at->derived) {
        const near_tet x = lane_tet(&w->lanes, at, lane);
        const polygon_sight sight = isopolygon_near(&x, isovalue, out);
        if (sight != DOUBTFUL_POLYGON)
            return sight == SURE_POLYGON;
        const tet exact = mesh_walk_tet(at, local);
        return isopolygon_of(&exact, isovalue, out);
    }
    const isopolygon *g = isopolygon_cache_find(at, local, isovalue, out);
    if (g && g != out)
        *out = *g;
    return g;
}

static void see_polygon(const mesh_tile *w, seen_polygon *s) {
    near_polygon near;
    see_near(&s->g, (point4){w->eye[0], w->eye[1], w->eye[2], 0.0}, &near);
    for (int i = 0; i < s->g.count; i++)
        spread(&near.a[i], s->a[i]);
    for (int k = 0; k < (s->g.count == 4 ? EDGES : EDGE_23); k++) {
        spread(&near.edge[k].normal, s->normal[k]);
        s->error[k] = d_set(near.edge[k].error);
    }
}

static void walk_tet(mesh_tile *w, const resident_mesh *at, unsigned lane, int32_t iso,
                     tile_rect r) {
    seen_polygon s; /* large */
    s.at = at;
    s.tet = w->lanes.local[lane];
    s.iso = iso;
    LANE_COUNT(looked_at, 1u);
    if (!polygon_of(w, at, lane, iso, &s.g))
        return;
    LANE_COUNT(polygons, 1u);
    see_polygon(w, &s);
    walk_polygon(w, &s, r);
    LANE_COUNT(polygons_hit, LANE_MORE(centres));
}

/* Tets as the eye sees them, a lane each: homogeneous pixel coordinates of their vertices, and
 * their values. */
typedef struct tets_in_view {
    vf x[4], y[4], w[4], f[4];
    vf far; /* bounds any of the vertices' distances */
    mf odd; /* values that sums and quotients of floats cannot be trusted with */
} tets_in_view;

/* Positions are taken from the treelet's lower corner, and so is the eye's, in double: what errs is
 * a few units of 2^-24 of the distance and of the treelet's size. */
SIMD void view_tets(const mesh_tile *w, const resident_mesh *at, tets_in_view *v) {
    const tet_lanes *l = &w->lanes;
    const projection *p = w->view.p;
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
            const vf q = (at_corner[a] - f_set(lo)) - f_set((float)(w->eye[a] - (double)lo));
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

typedef struct tet_covers {
    tile_rect rect[VF_N];
    _Alignas(64) float depth[VF_N]; /* none of their points is nearer */
} tet_covers;

/* Where the isopolygons of tets can be: the points on their edges between vertices on either side,
 * in the picture. An edge's share s errs by six units of 2^-24 of itself: numerator, denominator
 * and quotient; so its point by less than what boxes' corners may err by. */
SIMD children_extent extent_of_polygons(const tets_in_view *v, double iso) {
    const vf most = f_set(INFINITY), least = f_set(-INFINITY), zero = f_set(0.0f);
    const vf threshold = f_set(interest_threshold(iso));
    const vf near = f_set((float)iso), rest = f_set((float)(iso - (double)(float)iso));
    children_extent e = {most, least, most, least, most, least};
    vf up[4];
    mf in[4];
    for (int k = 0; k < 4; k++) {
        in[k] = f_ge(v->f[k], threshold);
        up[k] = (near - v->f[k]) + rest;
    }
    for (int i = 0; i < 3; i++) {
        for (int j = i + 1; j < 4; j++) {
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
        }
    }
    return e;
}

/* What the isopolygons can cover of their leaves' rectangles: lanes of those that cover anything.
 * Those nearer than a sixteenth of what positions are relative to cover all of it. */
SIMD unsigned covers_of(const mesh_tile *w, const tets_in_view *v, double iso, tet_covers *out) {
    const tet_lanes *l = &w->lanes;
    const rect_lanes within = rect_lanes_load(l->within);
    const children_extent e = extent_of_polygons(v, iso);
    const mf whole = mf_or(v->odd, f_lt(e.w0, v->far * f_set(projection_depth_share)));
    mf alive;
    const vi packed =
        rects_of_extent(&w->view, &e, 2.0f * w->view.p->margin, whole, within, &alive);
    memcpy(out->rect, &packed, sizeof packed);
    f_store(out->depth, f_select(whole, f_set(0.0f), e.w0 - f_set(0x1p-19f) * v->far));
    LANE_COUNT(covers, mf_bits(alive) & ((1u << l->count) - 1u));
    return mf_bits(alive) & ((1u << l->count) - 1u);
}

static void walk_lanes(mesh_tile *w, const resident_mesh *at) {
    const isovalue_list *isos = &w->s.f->tracer->isos;
    tet_lanes *l = &w->lanes;
    tets_in_view view;
    for (unsigned k = l->count; k < VF_N; k++)
        for (int v = 0; v < 4; v++)
            l->vertex[v][k] = l->vertex[v][0];
    view_tets(w, at, &view);
    LANE_COUNT(tets, (1u << l->count) - 1u);
    for (int32_t i = 0; i < isos->count; i++) {
        tet_covers covers;
        for (unsigned left = covers_of(w, &view, isos->isovalues[i], &covers); left;
             left &= left - 1) {
            const unsigned k = (unsigned)__builtin_ctz(left);
            if (in_sight(w, covers.rect[k], covers.depth[k] * covers.depth[k]))
                walk_tet(w, at, k, i, covers.rect[k]);
        }
    }
    w->s.counters->cells += l->count;
    l->count = 0;
}

static void add_lane(mesh_tile *w, const resident_mesh *at, uint32_t local, const tile_rect *r) {
    const uint16_t *v = mesh_leaf_tets(&at->mesh, at->head.payload)[local];
    const float *values = mesh_leaf_values(&at->mesh, at->values);
    tet_lanes *l = &w->lanes;
    for (int k = 0; k < 4; k++) {
        __builtin_prefetch(at->positions[v[k]]);
        __builtin_prefetch(values + v[k]);
        l->vertex[k][l->count] = v[k];
    }
    l->within[l->count] = *r;
    l->local[l->count++] = local;
    if (l->count == VF_N)
        walk_lanes(w, at);
}

static void walk_leaf(mesh_tile *w, const resident_mesh *at, uint32_t first, uint32_t end,
                      const tile_rect *r) {
    for (uint32_t word = first / 64; word * 64 < end; word++) {
        uint64_t bits = at->active->tets[word];
        if (word == first / 64)
            bits &= UINT64_MAX << first % 64;
        if (end - word * 64 < 64)
            bits &= (UINT64_C(1) << (end - word * 64)) - 1;
        for (; bits; bits &= bits - 1)
            add_lane(w, at, word * 64 + (uint32_t)__builtin_ctzll(bits), r);
    }
}

/* ---- Nodes ---- */

typedef struct mesh_pending {
    uint32_t level, i; /* of the tree over the treelets; in a treelet: the child */
    tile_rect rect;
    float near2;
} mesh_pending;

enum {
    TREELET_STACK_MAX = MESH_DEPTH_MAX * (MESH_CHILDREN - 1) + 1,
    TREE_STACK_MAX = TREELET_TREE_LEVELS_MAX * TREELET_TREE_ARITY
};

SIMD int push_boxes(const box_rects *boxes, unsigned left, mesh_pending *stack, int top) {
    uint8_t order[8];
    const unsigned count = by_distance(boxes->near2, left, order);
    for (unsigned k = 0; k < count; k++) {
        stack[top].i = order[k];
        stack[top].rect = boxes->rects.of[order[k]];
        stack[top++].near2 = boxes->near2[order[k]];
    }
    return top;
}

/* What turns a treelet's codes into planes as seen from the eye. */
typedef struct eye_frame {
    float lo[3], hi[3], step[3];
} eye_frame;

/* A plane of mesh_leaf_plane() errs by a unit u = 2^-24 of itself, the treelet's corner as seen
 * from the eye by one of that, and the sum by one of itself. Boxes are larger by twice as much. */
SIMD eye_frame eye_frame_of(const mesh_tile *w, const resident_mesh *at) {
    eye_frame f;
    for (int a = 0; a < 3; a++) {
        const float lo = at->planes.lo[a], size = 256.0f * at->planes.step[a];
        const float corner = (float)((double)lo - w->eye[a]);
        const float slack = 0x1p-23f * (fabsf(lo) + 2.0f * (fabsf(corner) + size));
        f.lo[a] = corner - slack;
        f.hi[a] = corner + slack;
        f.step[a] = at->planes.step[a];
    }
    return f;
}

SIMD void boxes_of_node(const eye_frame *f, const mesh_node *node, near_boxes *b) {
    for (int a = 0; a < 3; a++) {
        for (int c = 0; c < MESH_CHILDREN; c++) {
            b->lo[a][c] = f->lo[a] + (float)node->lo[a][c] * f->step[a];
            b->hi[a][c] = f->hi[a] + (float)node->hi[a][c] * f->step[a];
        }
    }
    leave_idle(b, MESH_CHILDREN);
}

/* A frame touches more memory than there is cache, so all that is put off is asked for in advance:
 * nodes, tets, vertices, treelets (about a tenth of the time at 11 million tets). */
static void walk_treelet_of_mesh(mesh_tile *w, const resident_mesh *at, tile_rect rect,
                                 float near2) {
    const eye_frame planes = eye_frame_of(w, at);
    const mesh_node *nodes = at->nodes;
    const uint16_t *first = mesh_leaf_first(&at->mesh, at->head.payload);
    const uint16_t(*tets)[4] = mesh_leaf_tets(&at->mesh, at->head.payload);
    mesh_pending stack[TREELET_STACK_MAX];
    int top = 0;
    stack[top++] = (mesh_pending){0, 0, rect, near2};
    while (top > 0) {
        const mesh_pending p = stack[--top];
        if (!in_sight(w, p.rect, p.near2))
            continue;
        if (p.i & MESH_LEAF) {
            const uint32_t leaf = p.i & ~(uint32_t)MESH_LEAF;
            walk_leaf(w, at, first[leaf], first[leaf + 1], &p.rect);
            continue;
        }
        near_boxes b;
        box_rects boxes;
        w->s.counters->nodes++;
        boxes_of_node(&planes, &nodes[p.i], &b);
        rects_of_boxes(w, &b, &p.rect, &boxes);
        const int bottom = top;
        top = push_boxes(&boxes, boxes.rects.alive & at->active->children[p.i], stack, top);
        for (int k = bottom; k < top; k++) {
            const uint32_t child = stack[k].i = nodes[p.i].child[stack[k].i];
            const uint32_t leaf = child & ~(uint32_t)MESH_LEAF;
            if (child & MESH_LEAF)
                __builtin_prefetch(tets[first[leaf]]);
            else
                __builtin_prefetch(&nodes[child]);
        }
    }
    if (w->lanes.count > 0)
        walk_lanes(w, at);
}

/* ---- Treelets ---- */

/* Which of VD_N rays pass a box before what they have found. */
SIMD unsigned rays_through(const mesh_tile *w, const double lo[3], const double hi[3], unsigned i) {
    const tile_rays *rays = &w->s.rays;
    const vd d[3] = {d_load(rays->d[0] + i), d_load(rays->d[1] + i), d_load(rays->d[2] + i)};
    double from_eye[2][3];
    for (int a = 0; a < 3; a++) {
        from_eye[0][a] = lo[a] - w->eye[a];
        from_eye[1][a] = hi[a] - w->eye[a];
    }
    return mesh_box_meets(d, from_eye[0], from_eye[1], d_load(rays->t0 + i),
                          d_min(d_load(rays->t1 + i), d_load(w->s.reach + i)));
}

/* Rays that pass a treelet which is not there go no further. */
static void wait_for_treelet(mesh_tile *w, uint32_t t, tile_rect r) {
    const float *bounds = mesh_rays_of(w->s.f->tracer)->tree->bounds[0][t];
    const double lo[3] = {bounds[0], bounds[1], bounds[2]};
    const double hi[3] = {bounds[3], bounds[4], bounds[5]};
    tile_outcome *out = w->s.out;
    unsigned any = 0;
    for (unsigned y = r.y0; y <= r.y1; y++) {
        unsigned passing = 0;
        for (unsigned x = r.x0 & ~(VD_N - 1u); x <= r.x1; x += VD_N)
            passing |= (rays_through(w, lo, hi, TILE * y + x) & ((1u << VD_N) - 1u)) << x;
        passing &= w->s.open[y] & row_mask(r);
        out->waits[y] |= (tile_row)passing;
        w->s.open[y] &= ~(tile_row)passing;
        any |= passing;
    }
    if (any)
        look_with_open(w);
    if (any)
        tile_absent(out, t, 0);
}

static void walk_resident_treelet(mesh_tile *w, const mesh_pending *p) {
    if (!w->s.has_rays) {
        tile_state_rays(&w->s);
        look_with_open(w);
    }
    const resident_mesh *at = resident_mesh_of(loader_lookup(w->s.f->tracer->treelets, p->i));
    if (!at) {
        wait_for_treelet(w, p->i, p->rect);
        return;
    }
    tracer_touch(w->s.f->tracer, p->i); /* as far as rectangles tell */
    walk_treelet_of_mesh(w, at, p->rect, p->near2);
}

/* The tree over the treelets, from its root on. */
static void walk_mesh(mesh_tile *w, tile_rect rect) {
    const treelet_tree *tree = mesh_rays_of(w->s.f->tracer)->tree;
    mesh_pending stack[TREE_STACK_MAX];
    int top = 0;
    if (tree->active[tree->levels - 1][0])
        stack[top++] = (mesh_pending){tree->levels - 1, 0, rect, 0.0f};
    while (top > 0) {
        const mesh_pending p = stack[--top];
        if (!in_sight(w, p.rect, p.near2))
            continue;
        if (p.level == 0) {
            walk_resident_treelet(w, &p);
            continue;
        }
        uint32_t count, first = treelet_tree_children(tree, p.level, p.i, &count);
        near_boxes b;
        box_rects boxes;
        unsigned active = 0;
        for (uint32_t c = 0; c < count; c++) {
            const float *bounds = tree->bounds[p.level - 1][first + c];
            active |= (unsigned)tree->active[p.level - 1][first + c] << c;
            for (int a = 0; a < 3; a++) {
                b.lo[a][c] = (float)((double)bounds[a] - w->eye[a]);
                b.hi[a][c] = (float)((double)bounds[a + 3] - w->eye[a]);
            }
        }
        leave_idle(&b, count);
        w->s.counters->nodes++;
        rects_of_boxes(w, &b, &p.rect, &boxes);
        const int bottom = top;
        top = push_boxes(&boxes, boxes.rects.alive & active, stack, top);
        for (int k = bottom; k < top; k++) {
            stack[k].i += first;
            stack[k].level = p.level - 1;
            if (p.level == 1)
                loader_prefetch(w->s.f->tracer->treelets, stack[k].i);
        }
    }
}

void SIMD_NAME(mesh_tile)(const frame *f, uint32_t x0, uint32_t y0, const tile_row asked[],
                          tile_outcome *out, ray_counters *counters) {
    mesh_work *work = out->scratch;
    mesh_tile *w = &work->tile;
    tile_state_begin(&w->s, f, &mesh_order, TILE_LAYERS, x0, y0, asked, out, counters);
    w->view = tile_view_of(f, x0, y0);
    w->lanes = (tet_lanes){.count = 0};
    for (int a = 0; a < 3; a++)
        w->eye[a] = f->projection->eye[a];
    mesh_shade_begin(&work->shading, &w->s);
    do {
        look_at_all(w);
        walk_mesh(w, (tile_rect){0, TILE - 1, 0, TILE - 1});
        mesh_shade(&work->shading);
    } while (tile_state_again(&w->s, TILE_LAYERS, work->shading.pixels.rgba[3]));
    mesh_shade_end(&work->shading);
}

#endif
#endif
