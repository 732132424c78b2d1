/* mesh_tile_template.h - mesh_tile_X() of mesh_tile.h; included by the units of an ISA (see
 * formats/base/simd.h). */
#ifndef RENDER_MESH_TILE_TEMPLATE_H
#define RENDER_MESH_TILE_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/edge_sign.h"
#include "render/mesh_tile.h"
#include "render/mesh_walk.h"
#include "render/tile_rects_template.h"
#include "render/tile_shade_template.h"

void SIMD_NAME(mesh_tile)(const frame *f, uint32_t x0, uint32_t y0, const uint16_t asked[TILE],
                          tile_outcome *out, frame_counters *counters);

typedef struct mesh_tile {
    tile_state s;
    tile_place place;
    double eye[3];
    uint32_t tet[TILE_RAYS]; /* of what has been found: its place in its treelet */
} mesh_tile;

/* ---- Who is behind what ---- */

static unsigned pixels_of(tile_rect r) {
    return (2u << r.x1) - (1u << r.x0);
}

/* Distances are compared as squares: less than a float's rounding of both is given away. */
static const float SURELY = 1.0f - 0x1p-20f;

/* Whether an open ray of the rectangle has nothing in front of a distance (squared). */
SIMD bool seen(const mesh_tile *w, tile_rect r, float near2) {
    const unsigned columns = pixels_of(r);
    const vd at = d_set(near2 > 0.0f ? sqrt((double)(near2 * SURELY)) : 0.0);
    for (unsigned y = r.y0; y <= r.y1; y++) {
        const unsigned open = w->s.open[y] & columns;
        if (!open)
            continue;
        for (unsigned x = r.x0 & ~(VD_N - 1u); x <= r.x1; x += VD_N) {
            const unsigned behind = md_bits(d_ge(d_load(w->s.t + TILE * y + x), at));
            if (behind & open >> x)
                return true;
        }
    }
    return false;
}

/* ---- Boxes ---- */

/* Up to eight boxes, their planes as seen from the eye. */
typedef struct near_boxes {
    _Alignas(64) float lo[3][16], hi[3][16];
} near_boxes;

typedef struct box_rects {
    tile_rects rects;
    _Alignas(64) float near2[16]; /* squares of their distances */
} box_rects;

/* planes: as float, of which the eye's coordinates are taken in double. */
SIMD void from_eye(float planes[16], double eye) {
    for (int k = 0; k < 8; k += VD_N)
        d_store_floats(planes + k, d_of_floats(planes + k) - d_set(eye));
}

SIMD void rects_of_boxes(const mesh_tile *w, near_boxes *b, const tile_rect *parent,
                         box_rects *out) {
    const projection *p = w->place.p;
    out->rects.alive = 0;
    for (int a = 0; a < 3; a++) {
        from_eye(b->lo[a], w->eye[a]);
        from_eye(b->hi[a], w->eye[a]);
    }
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
        tile_rects_of_entries(&w->place, &c, lane, parent, &out->rects);
    }
    out->rects.alive &= 255u;
}

/* The children in `left`, the farthest first. */
SIMD unsigned by_distance(const float near2[16], unsigned left, uint8_t order[8]) {
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

/* An isopolygon as the eye sees it. Its edges' functions of a ray's direction are d . n, erring by
 * at most EDGE_BOUND |d| . m + EDGE_SMALLEST: edge_near() with what no ray changes taken out. Edges
 * are (1, 2), (2, 0), (0, 1), (2, 3), (3, 0). */
typedef struct seen_polygon {
    isopolygon g;
    double a[4][3]; /* its points from the eye */
    double n[5][3], m[5][3];
    const treelet *at;
    uint32_t tet;
    int32_t iso;
} seen_polygon;

static const uint8_t ends_of_edge[5][2] = {{1, 2}, {2, 0}, {0, 1}, {2, 3}, {3, 0}};

/* As weight_of() of the kernel: from the lower tet edge to the higher. */
static void see_edge(seen_polygon *s, int k) {
    const int i = ends_of_edge[k][0], j = ends_of_edge[k][1];
    const bool swap = s->g.edge[i] > s->g.edge[j];
    const double *p = s->g.p[swap ? j : i], *q = s->g.p[swap ? i : j];
    const double *a = s->a[swap ? j : i];
    const double e[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]};
    for (int c = 0; c < 3; c++) {
        const int c1 = (c + 1) % 3, c2 = (c + 2) % 3;
        const double plus = a[c1] * e[c2], minus = a[c2] * e[c1];
        s->n[k][c] = swap ? -(plus - minus) : plus - minus;
        s->m[k][c] = fabs(plus) + fabs(minus);
    }
}

typedef float four_floats __attribute__((vector_size(16)));

static float least_of(four_floats v) {
    const float a = v[0] < v[1] ? v[0] : v[1], b = v[2] < v[3] ? v[2] : v[3];
    return a < b ? a : b;
}

/* The pixels of r whose centres the polygon can cover; false: none. */
static bool cover_of(const mesh_tile *w, const seen_polygon *s, tile_rect *r) {
    const projection *p = w->place.p;
    four_floats x = {0}, y = {0}, z = {0}, far = {0};
    for (int c = 0; c < 3; c++) {
        const four_floats at = {(float)s->a[0][c], (float)s->a[1][c], (float)s->a[2][c],
                                (float)s->a[3][c]};
        const four_floats size = {fabsf(at[0]), fabsf(at[1]), fabsf(at[2]), fabsf(at[3])};
        x += p->axis[c][0] * at;
        y += p->axis[c][1] * at;
        z += p->axis[c][2] * at;
        far += p->axis[c][3] * size;
    }
    /* Behind the eye or beside it: its box has said what it can cover. */
    if (!(least_of(z - projection_depth_share * far) > 0.0f))
        return true;
    const four_floats px = x / z - w->place.x, py = y / z - w->place.y;
    const float x0 = ceilf(least_of(px) - p->margin), x1 = floorf(-least_of(-px) + p->margin);
    const float y0 = ceilf(least_of(py) - p->margin), y1 = floorf(-least_of(-py) + p->margin);
    if (!(x0 <= (float)r->x1 && x1 >= (float)r->x0 && y0 <= (float)r->y1 && y1 >= (float)r->y0 &&
          x0 <= x1 && y0 <= y1))
        return false;
    r->x0 = x0 > (float)r->x0 ? (uint8_t)x0 : r->x0;
    r->x1 = x1 < (float)r->x1 ? (uint8_t)x1 : r->x1;
    r->y0 = y0 > (float)r->y0 ? (uint8_t)y0 : r->y0;
    r->y1 = y1 < (float)r->y1 ? (uint8_t)y1 : r->y1;
    return true;
}

/* ---- Rays and polygons ---- */

SIMD vd dot_d(const vd a[3], const double b[3]) {
    return a[0] * d_set(b[0]) + a[1] * d_set(b[1]) + a[2] * d_set(b[2]);
}

/* What is sure about VD_N rays and a polygon or triangle. */
typedef struct sure_hits {
    vd t;
    unsigned hit, entering, doubtful;
} sure_hits;

/* The weight that an edge gives to the corner opposite. */
typedef struct near_weight {
    vd value;
    md above, below;
} near_weight;

SIMD near_weight weight_of_edge(const seen_polygon *s, int k, const vd d[3], const vd size[3],
                                bool turned) {
    const vd value = dot_d(d, s->n[k]);
    const vd bound = d_set(EDGE_BOUND) * dot_d(size, s->m[k]) + d_set(EDGE_SMALLEST);
    const md above = d_gt(value, bound), below = d_lt(value, d_set(-0.0) - bound);
    if (turned)
        return (near_weight){d_set(-0.0) - value, below, above};
    return (near_weight){value, above, below};
}

/* cross_triangle() of the kernel, VD_N rays at a time: corners c, the edges opposite; the last of
 * the second triangle is the first one's diagonal, turned. */
SIMD sure_hits cross_surely(const seen_polygon *s, int triangle, const vd d[3], const vd size[3],
                            vd squared) {
    static const uint8_t corners[2][3] = {{0, 1, 2}, {0, 2, 3}};
    static const uint8_t opposite[2][3] = {{0, 1, 2}, {3, 4, 1}};
    near_weight w[3];
    vd t[3];
    for (int k = 0; k < 3; k++) {
        w[k] = weight_of_edge(s, opposite[triangle][k], d, size, triangle == 1 && k == 2);
        t[k] = dot_d(d, s->a[corners[triangle][k]]) / squared;
    }
    const unsigned above = md_bits(md_and(w[0].above, md_and(w[1].above, w[2].above)));
    const unsigned below = md_bits(md_and(w[0].below, md_and(w[1].below, w[2].below)));
    const unsigned any_above = md_bits(md_or(w[0].above, md_or(w[1].above, w[2].above)));
    const unsigned any_below = md_bits(md_or(w[0].below, md_or(w[1].below, w[2].below)));
    const unsigned lanes = (1u << VD_N) - 1u;
    sure_hits out = {.hit = above | below,
                     .entering = above,
                     .doubtful = ~(above | below) & ~(any_above & any_below) & lanes};
    const vd v0 = d_abs(w[0].value), v1 = d_abs(w[1].value), v2 = d_abs(w[2].value);
    const vd lo = d_min(t[0], d_min(t[1], t[2])), hi = d_max(t[0], d_max(t[1], t[2]));
    const vd beyond = v1 * (t[1] - t[0]) + v2 * (t[2] - t[0]);
    out.t = d_max(lo, d_min(t[0] + beyond / (v0 + v1 + v2), hi));
    return out;
}

/* A hit of ray i: before what it has? */
static void take_surface(mesh_tile *w, const seen_polygon *s, unsigned i, double t, bool entering) {
    tile_state *f = &w->s;
    if (f->t[i] <= t) {
        const hit known = {f->t[i], f->at[i] ? f->at[i]->first_tet + w->tet[i] : 0, f->iso[i],
                           f->entering[i]};
        const hit found = {t, s->at->first_tet + s->tet, s->iso, entering};
        if (!mesh_walk_less(&found, &known))
            return;
    }
    f->t[i] = t;
    f->iso[i] = s->iso;
    f->entering[i] = entering;
    f->at[i] = s->at;
    w->tet[i] = s->tet;
    f->counters->walk.roots++;
}

/* What the vectors leave in doubt. */
static void take_scalar(mesh_tile *w, const seen_polygon *s, unsigned i) {
    const hit before = hit_before_all();
    ray r = {.t0 = w->s.rays.t0[i], .t1 = w->s.rays.t1[i]};
    hit found;
    for (int a = 0; a < 3; a++) {
        r.o[a] = r.held[a] = w->eye[a];
        r.d[a] = w->s.rays.d[a][i];
    }
    if (isopolygon_hit(&s->g, &r, s->at->first_tet + s->tet, s->iso, &before, &found))
        take_surface(w, s, i, found.t, found.entering);
}

/* VD_N rays of a row, from ray i on; lanes: which of them. */
SIMD void meet_polygon(mesh_tile *w, const seen_polygon *s, unsigned i, unsigned lanes) {
    const tile_rays *rays = &w->s.rays;
    const vd d[3] = {d_load(rays->d[0] + i), d_load(rays->d[1] + i), d_load(rays->d[2] + i)};
    const vd size[3] = {d_abs(d[0]), d_abs(d[1]), d_abs(d[2])};
    const vd squared = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    const vd t0 = d_load(rays->t0 + i), t1 = d_load(rays->t1 + i);
    sure_hits first = cross_surely(s, 0, d, size, squared);
    unsigned doubtful = first.doubtful;
    first.hit &= md_bits(md_and(d_ge(first.t, t0), d_le(first.t, t1)));
    if (s->g.count == 4) {
        const sure_hits second = cross_surely(s, 1, d, size, squared);
        const unsigned also = second.hit & md_bits(md_and(d_ge(second.t, t0), d_le(second.t, t1)));
        /* In (t, triangle) order. */
        const unsigned takes = also & (~first.hit | md_bits(d_lt(second.t, first.t)));
        first.t = d_select(md_of_bits(takes), second.t, first.t);
        first.entering = (first.entering & ~takes) | (second.entering & takes);
        first.hit |= takes;
        doubtful |= second.doubtful;
    }
    unsigned sure = first.hit & ~doubtful & lanes & md_bits(d_le(first.t, d_load(w->s.t + i)));
    double t[VD_N];
    d_store(t, first.t);
    for (; sure; sure &= sure - 1) {
        const unsigned k = (unsigned)__builtin_ctz(sure);
        take_surface(w, s, i + k, t[k], first.entering >> k & 1u);
    }
    for (unsigned left = doubtful & lanes; left; left &= left - 1)
        take_scalar(w, s, i + (unsigned)__builtin_ctz(left));
}

static void walk_polygon(mesh_tile *w, seen_polygon *s, tile_rect r) {
    const unsigned columns = pixels_of(r);
    for (unsigned y = r.y0; y <= r.y1; y++) {
        const unsigned open = w->s.open[y] & columns;
        for (unsigned x = r.x0 & ~(VD_N - 1u); x <= r.x1; x += VD_N) {
            const unsigned lanes = open >> x & ((1u << VD_N) - 1u);
            if (lanes)
                meet_polygon(w, s, TILE * y + x, lanes);
        }
    }
}

/* ---- Leaves ---- */

static void walk_tet(mesh_tile *w, const treelet *at, uint32_t place, tile_rect r) {
    const walk_scene *scene = &w->s.f->tracer->scene;
    const tet x = mesh_walk_tet(at, place);
    w->s.counters->walk.cells++;
    for (int i = 0; i < scene->count; i++) {
        seen_polygon s;
        if (!isopolygon_of(&x, scene->isovalues[i], &s.g))
            continue;
        tile_rect covered = r;
        for (int k = 0; k < 4; k++)
            for (int c = 0; c < 3; c++)
                s.a[k][c] = s.g.p[k][c] - w->eye[c];
        if (!cover_of(w, &s, &covered))
            continue;
        s.at = at;
        s.tet = place;
        s.iso = i;
        for (int k = 0; k < (s.g.count == 3 ? 3 : 5); k++)
            see_edge(&s, k);
        walk_polygon(w, &s, covered);
    }
}

static void walk_leaf(mesh_tile *w, const treelet *at, uint32_t first, uint32_t end, tile_rect r) {
    for (uint32_t word = first / 64; word * 64 < end; word++) {
        uint64_t bits = at->active->tets[word];
        if (word == first / 64)
            bits &= UINT64_MAX << first % 64;
        if (end - word * 64 < 64)
            bits &= (UINT64_C(1) << (end - word * 64)) - 1;
        for (; bits; bits &= bits - 1)
            walk_tet(w, at, word * 64 + (uint32_t)__builtin_ctzll(bits), r);
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

/* Unused lanes repeat what there is: nothing out of the ordinary comes in. */
SIMD void boxes_of_node(const mesh_frame *planes, const mesh_node *node, near_boxes *b) {
    for (int a = 0; a < 3; a++) {
        for (int c = 0; c < MESH_CHILDREN; c++) {
            b->lo[a][c] = planes->lo[a] + (float)node->lo[a][c] * planes->step[a];
            b->hi[a][c] = planes->lo[a] + (float)node->hi[a][c] * planes->step[a];
        }
    }
}

static void walk_treelet_of_mesh(mesh_tile *w, const treelet *at, tile_rect rect, float near2) {
    const mesh_frame planes = mesh_leaf_frame(at->bounds);
    const mesh_node *nodes = mesh_leaf_nodes(at->payload);
    const uint16_t *first = mesh_leaf_first(&at->mesh, at->payload);
    mesh_pending stack[TREELET_STACK_MAX];
    int top = 0;
    stack[top++] = (mesh_pending){0, 0, rect, near2};
    while (top > 0) {
        const mesh_pending p = stack[--top];
        if (!seen(w, p.rect, p.near2))
            continue;
        if (p.i & MESH_LEAF) {
            const uint32_t leaf = p.i & ~(uint32_t)MESH_LEAF;
            walk_leaf(w, at, first[leaf], first[leaf + 1], p.rect);
            continue;
        }
        near_boxes b = {{{0}}, {{0}}};
        box_rects boxes;
        w->s.counters->walk.nodes++;
        boxes_of_node(&planes, &nodes[p.i], &b);
        rects_of_boxes(w, &b, &p.rect, &boxes);
        const int bottom = top;
        top = push_boxes(&boxes, boxes.rects.alive & at->active->children[p.i], stack, top);
        for (int k = bottom; k < top; k++)
            stack[k].i = nodes[p.i].child[stack[k].i];
    }
}

/* ---- Treelets ---- */

/* The open rays of row y in the rectangle that pass a treelet before what they have found. */
static unsigned rays_through(const mesh_tile *w, uint32_t t, unsigned y, tile_rect r) {
    const float *bounds = w->s.f->tracer->tree->bounds[0][t];
    double lo[3], hi[3];
    unsigned passing = 0;
    for (int a = 0; a < 3; a++) {
        lo[a] = (double)bounds[a];
        hi[a] = (double)bounds[a + 3];
    }
    for (unsigned left = w->s.open[y] & pixels_of(r); left; left &= left - 1) {
        const unsigned x = (unsigned)__builtin_ctz(left), i = TILE * y + x;
        ray look = {.t0 = w->s.rays.t0[i], .t1 = w->s.rays.t1[i]};
        mesh_interval in;
        for (int a = 0; a < 3; a++) {
            look.o[a] = w->eye[a];
            look.d[a] = w->s.rays.d[a][i];
        }
        if (mesh_interval_of(&look, lo, hi, &in) && in.t_in <= w->s.t[i])
            passing |= 1u << x;
    }
    return passing;
}

/* Remember that rays came into a treelet. */
static void touch_treelet(mesh_tile *w, uint32_t t, tile_rect r) {
    atomic_uchar *touched = &w->s.f->tracer->touched[t];
    if (atomic_load_explicit(touched, memory_order_relaxed))
        return;
    for (unsigned y = r.y0; y <= r.y1; y++) {
        if (rays_through(w, t, y, r)) {
            atomic_store_explicit(touched, 1, memory_order_relaxed);
            return;
        }
    }
}

/* Rays that pass a treelet which is not there go no further. */
static void wait_for_treelet(mesh_tile *w, uint32_t t, tile_rect r) {
    tile_outcome *out = w->s.out;
    unsigned any = 0;
    for (unsigned y = r.y0; y <= r.y1; y++) {
        const unsigned passing = rays_through(w, t, y, r);
        out->waits[y] |= (uint16_t)passing;
        w->s.open[y] &= (uint16_t)~passing;
        any |= passing;
    }
    if (any && out->absent_count < TILE_ABSENT_MAX)
        out->absent[out->absent_count++] = t;
}

static void walk_resident_treelet(mesh_tile *w, const mesh_pending *p) {
    tile_state_rays(&w->s);
    const treelet *at = loader_lookup(w->s.f->tracer->treelets, p->i);
    if (!at) {
        wait_for_treelet(w, p->i, p->rect);
        return;
    }
    touch_treelet(w, p->i, p->rect);
    walk_treelet_of_mesh(w, at, p->rect, p->near2);
}

/* The tree over the treelets, from its root on. */
static void walk_mesh(mesh_tile *w, tile_rect rect) {
    const treelet_tree *tree = w->s.f->tracer->tree;
    mesh_pending stack[TREE_STACK_MAX];
    int top = 0;
    if (tree->active[tree->levels - 1][0])
        stack[top++] = (mesh_pending){tree->levels - 1, 0, rect, 0.0f};
    while (top > 0) {
        const mesh_pending p = stack[--top];
        if (!seen(w, p.rect, p.near2))
            continue;
        if (p.level == 0) {
            walk_resident_treelet(w, &p);
            continue;
        }
        uint32_t count, first = treelet_tree_children(tree, p.level, p.i, &count);
        near_boxes b = {{{0}}, {{0}}};
        box_rects boxes;
        unsigned active = 0;
        for (uint32_t c = 0; c < count; c++) {
            const float *bounds = tree->bounds[p.level - 1][first + c];
            active |= (unsigned)tree->active[p.level - 1][first + c] << c;
            for (int a = 0; a < 3; a++) {
                b.lo[a][c] = bounds[a];
                b.hi[a][c] = bounds[a + 3];
            }
        }
        w->s.counters->walk.nodes++;
        rects_of_boxes(w, &b, &p.rect, &boxes);
        const int bottom = top;
        top = push_boxes(&boxes, boxes.rects.alive & active, stack, top);
        for (int k = bottom; k < top; k++) {
            stack[k].i += first;
            stack[k].level = p.level - 1;
        }
    }
}

/* ---- Pixels ---- */

/* Neighbouring rays hit the same tets. */
enum { KNOWN_TETS = 64 };

typedef struct known_tet {
    const treelet *at;
    uint32_t tet;
    int32_t iso;
    float normal[3];
} known_tet;

static void normals_of_tets(const mesh_tile *w, tile_pixels *p) {
    const walk_scene *scene = &w->s.f->tracer->scene;
    known_tet known[KNOWN_TETS];
    for (int k = 0; k < KNOWN_TETS; k++)
        known[k].at = NULL;
    for (unsigned i = 0; i < TILE_RAYS; i++) {
        if (!(w->s.t[i] < INFINITY))
            continue;
        known_tet *k = &known[(w->tet[i] + (unsigned)w->s.iso[i]) % KNOWN_TETS];
        if (k->at != w->s.at[i] || k->tet != w->tet[i] || k->iso != w->s.iso[i]) {
            const tet x = mesh_walk_tet(w->s.at[i], w->tet[i]);
            isopolygon g;
            k->at = w->s.at[i];
            k->tet = w->tet[i];
            k->iso = w->s.iso[i];
            if (isopolygon_of(&x, scene->isovalues[k->iso], &g))
                tet_normal(&x, &g, k->normal);
        }
        for (int a = 0; a < 3; a++)
            p->normal[a][i] = k->normal[a];
    }
}

void SIMD_NAME(mesh_tile)(const frame *f, uint32_t x0, uint32_t y0, const uint16_t asked[TILE],
                          tile_outcome *out, frame_counters *counters) {
    mesh_tile w;
    tile_pixels pixels;
    tile_state_begin(&w.s, f, x0, y0, asked, out, counters);
    w.place = tile_place_of(f, x0, y0);
    for (int a = 0; a < 3; a++)
        w.eye[a] = f->projection->eye[a];
    walk_mesh(&w, (tile_rect){0, TILE - 1, 0, TILE - 1});
    clear_pixels(f, &pixels);
    const bool together = shaded_together(f);
    if (together) {
        normals_of_tets(&w, &pixels);
        shade_tile(&w.s, &pixels);
    }
    write_tile(&w.s, together, &pixels);
    for (unsigned i = 0; i < TILE_RAYS && !together; i++)
        if (out->found[i / TILE] >> i % TILE & 1u)
            out->hits[i].cell = w.s.at[i]->first_tet + w.tet[i];
}

#endif
#endif
