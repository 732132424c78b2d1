/* mesh_tile_template.h - mesh_tile_X() of mesh_tile.h; included by the units of an ISA (see
 * formats/base/simd.h). */
#ifndef RENDER_MESH_MESH_TILE_TEMPLATE_H
#define RENDER_MESH_MESH_TILE_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/mesh/mesh_box_template.h"
#include "render/mesh/mesh_tile_tets_template.h"

void SIMD_NAME(mesh_tile)(const frame *f, uint32_t x0, uint32_t y0, const tile_row asked[],
                          tile_outcome *out, ray_counters *counters);

/* What is kept in the outcome's scratch. */
typedef struct mesh_work {
    mesh_tile tile;
    mesh_shading shading;
} mesh_work;
_Static_assert(sizeof(mesh_work) <= MESH_TILE_SCRATCH, "a tile has room in its scratch");

/* ---- Boxes ---- */

/* Eight boxes, their planes relative to the eye. AVX-512 has idle lanes. */
enum { BOX_LANES = VF_N > 8 ? VF_N : 8 };

typedef struct near_boxes {
    _Alignas(64) float lo[3][BOX_LANES], hi[3][BOX_LANES];
} near_boxes;

typedef struct box_rects {
    tile_rects rects;
    _Alignas(64) float near2[BOX_LANES]; /* their squared distances from the eye */
} box_rects;

/* Fill lanes without a box with harmless numbers. */
SIMD void leave_idle(near_boxes *b, unsigned from) {
    for (int a = 0; a < 3; a++)
        for (unsigned c = from; c < BOX_LANES; c++)
            b->lo[a][c] = b->hi[a][c] = 0.0f;
}

/* Project VF_N boxes, from `lane` on. */
SIMD void rects_of_planes(const mesh_tile *w, const vf lo[3], const vf hi[3], unsigned lane,
                          const tile_rect *parent, box_rects *out) {
    const projection *p = w->view.p;
    const vf zero = f_set(0.0f);
    children_entries c = {.far = zero};
    vf near2 = zero;
    for (int a = 0; a < 3; a++) {
        const vf outside_of = f_max(f_max(lo[a], f_set(-0.0f) - hi[a]), zero);
        near2 = near2 + outside_of * outside_of;
        c.x.lo[a] = lo[a] * f_set(p->axis[a][0]);
        c.x.hi[a] = hi[a] * f_set(p->axis[a][0]);
        c.y.lo[a] = lo[a] * f_set(p->axis[a][1]);
        c.y.hi[a] = hi[a] * f_set(p->axis[a][1]);
        c.w.lo[a] = lo[a] * f_set(p->axis[a][2]);
        c.w.hi[a] = hi[a] * f_set(p->axis[a][2]);
        c.far = c.far + f_max(f_abs(lo[a]), f_abs(hi[a])) * f_set(p->axis[a][3]);
    }
    f_store(out->near2 + lane, near2);
    tile_rects_of_entries(&w->view, &c, lane, parent, &out->rects);
}

SIMD void rects_of_boxes(const mesh_tile *w, const near_boxes *b, const tile_rect *parent,
                         box_rects *out) {
    out->rects.alive = 0;
    for (unsigned lane = 0; lane < 8; lane += VF_N) {
        vf lo[3], hi[3];
        for (int a = 0; a < 3; a++) {
            lo[a] = f_load(b->lo[a] + lane);
            hi[a] = f_load(b->hi[a] + lane);
        }
        rects_of_planes(w, lo, hi, lane, parent, out);
    }
    out->rects.alive &= 255u;
}

/* Sort the children in `left`, the farthest first. */
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

/* ---- Nodes ---- */

typedef struct mesh_pending {
    uint32_t level, i; /* in the tree over the treelets; in a treelet i is the child */
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

/* Turns a treelet's codes into planes relative to the eye. */
typedef struct eye_frame {
    float lo[3], hi[3], step[3];
} eye_frame;

/* Errors, with u = 2^-24: a plane of mesh_leaf_plane() errs by u of its value. The treelet's corner
 * relative to the eye errs by u of its own, and so does the sum. Boxes are widened by twice as
 * much. */
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

/* Project a node's children. Lanes without a child come out empty. */
SIMD void rects_of_node(const mesh_tile *w, const eye_frame *f, const mesh_node *node,
                        const tile_rect *parent, box_rects *out) {
    out->rects.alive = 0;
    for (unsigned lane = 0; lane < MESH_CHILDREN; lane += VF_N) {
        vf lo[3], hi[3];
        for (int a = 0; a < 3; a++) {
            lo[a] = f_set(f->lo[a]) + f_of_bytes(node->lo[a] + lane) * f_set(f->step[a]);
            hi[a] = f_set(f->hi[a]) + f_of_bytes(node->hi[a] + lane) * f_set(f->step[a]);
        }
        rects_of_planes(w, lo, hi, lane, parent, out);
    }
    out->rects.alive &= 255u;
}

/* Leaves are queued, and walked a while later: by then their tets have been prefetched. */
enum { LEAVES_WAITING = 4 };

typedef struct near_leaves {
    struct {
        uint32_t first, end;
        tile_rect rect;
    } of[LEAVES_WAITING];
    unsigned count, next;
} near_leaves;

static void walk_next_leaf(mesh_tile *w, const resident_mesh *at, near_leaves *l) {
    const unsigned k = l->next++ % LEAVES_WAITING;
    walk_leaf(w, at, l->of[k].first, l->of[k].end, &l->of[k].rect);
}

static void put_leaf(mesh_tile *w, const resident_mesh *at, const tile_rect *r, uint32_t first,
                     uint32_t end, near_leaves *l) {
    const char *tets = (const char *)mesh_leaf_tets(&at->mesh, at->head.payload);
    if (l->count - l->next == LEAVES_WAITING)
        walk_next_leaf(w, at, l);
    const unsigned k = l->count++ % LEAVES_WAITING;
    for (uint32_t byte = 8 * first; byte < 8 * end; byte += 64)
        __builtin_prefetch(tets + byte);
    l->of[k].first = first;
    l->of[k].end = end;
    l->of[k].rect = *r;
}

/* Walk the tree of a treelet. A frame touches more memory than fits into the cache. So all that is
 * put on a stack or queue is prefetched: nodes, tets, vertices, treelets. This saves about a tenth
 * of the time at 11 million tets. */
static void walk_treelet_of_mesh(mesh_tile *w, const resident_mesh *at, tile_rect rect,
                                 float near2) {
    const eye_frame planes = eye_frame_of(w, at);
    const mesh_node *nodes = at->nodes;
    const uint16_t *first = mesh_leaf_first(&at->mesh, at->head.payload);
    mesh_pending stack[TREELET_STACK_MAX];
    near_leaves leaves = {.count = 0};
    int top = 0;
    stack[top++] = (mesh_pending){0, 0, rect, near2};
    while (top > 0) {
        const mesh_pending p = stack[--top];
        if (!in_sight(w, p.rect, p.near2))
            continue;
        if (p.i & MESH_LEAF) {
            const uint32_t leaf = p.i & ~(uint32_t)MESH_LEAF;
            put_leaf(w, at, &p.rect, first[leaf], first[leaf + 1], &leaves);
            continue;
        }
        box_rects boxes;
        w->s.counters->nodes++;
        rects_of_node(w, &planes, &nodes[p.i], &p.rect, &boxes);
        const int bottom = top;
        top = push_boxes(&boxes, boxes.rects.alive & at->active->children[p.i], stack, top);
        for (int k = bottom; k < top; k++) {
            const uint32_t child = stack[k].i = nodes[p.i].child[stack[k].i];
            const uint32_t leaf = child & ~(uint32_t)MESH_LEAF;
            if (child & MESH_LEAF)
                __builtin_prefetch(&first[leaf]);
            else
                __builtin_prefetch(&nodes[child]);
        }
    }
    while (leaves.next < leaves.count)
        walk_next_leaf(w, at, &leaves);
    for (int of = 0; of < 2; of++)
        walk_waiting(w, at);
    /* Walk the queue now: its hits may hide other treelets, which need not be loaded then. */
    if (w->queue.count > 0)
        walk_queue(w);
}

/* ---- Treelets ---- */

/* Returns which of VD_N rays pass through a box before their nearest hit so far. */
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

/* Suspend rays that pass an absent treelet. */
static void wait_for_treelet(mesh_tile *w, uint32_t t, tile_rect r) {
    const float *bounds = w->s.f->tracer->treelets->tree->bounds[0][t];
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
    tracer_touch(w->s.f->tracer, p->i); /* judged by rectangles alone */
    walk_treelet_of_mesh(w, at, p->rect, p->near2);
}

/* Treelet t is probably walked next. Prefetch its first nodes, leaves and masks. */
static void expect_treelet(const mesh_tile *w, uint32_t t) {
    const resident_mesh *at = resident_mesh_of(loader_peek(w->s.f->tracer->treelets, t));
    if (!at)
        return;
    const char *first = (const char *)mesh_leaf_first(&at->mesh, at->head.payload);
    const uint32_t words = (at->mesh.tets + 63) / 64;
    __builtin_prefetch(at->active->children);
    for (uint32_t byte = 0; byte < 256 && byte < 64 * at->mesh.nodes; byte += 64)
        __builtin_prefetch((const char *)at->nodes + byte);
    for (uint32_t byte = 0; byte < 2 * at->mesh.leaves; byte += 64)
        __builtin_prefetch(first + byte);
    for (uint32_t word = 0; word < words; word += 8)
        __builtin_prefetch(at->active->tets + word);
}

/* Walk the tree over the treelets, from its root. */
static void walk_mesh(mesh_tile *w, tile_rect rect) {
    const treelet_tree *tree = w->s.f->tracer->treelets->tree;
    mesh_pending stack[TREE_STACK_MAX];
    int top = 0;
    if (tree->active[tree->levels - 1][0])
        stack[top++] = (mesh_pending){tree->levels - 1, 0, rect, 0.0f};
    while (top > 0) {
        const mesh_pending p = stack[--top];
        if (!in_sight(w, p.rect, p.near2))
            continue;
        if (p.level == 0) {
            if (top > 0 && stack[top - 1].level == 0)
                expect_treelet(w, stack[top - 1].i);
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
    w->lanes[0].count = w->lanes[1].count = w->filling = 0;
    memset(&w->queue.tets, 0, sizeof w->queue.tets);
    w->queue.count = w->queue.pixels = 0;
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
