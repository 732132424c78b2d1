/* mesh_tile_template.h - mesh_tile_X() of mesh_tile.h; included by the units of an ISA (see
 * formats/base/simd.h). */
#ifndef RENDER_MESH_MESH_TILE_TEMPLATE_H
#define RENDER_MESH_MESH_TILE_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/mesh/mesh_tile_tets_template.h"

void SIMD_NAME(mesh_tile)(const frame *f, uint32_t x0, uint32_t y0, const tile_row asked[],
                          tile_outcome *out, ray_counters *counters);

/* What is kept in the outcome's scratch. */
typedef struct mesh_work {
    mesh_tile tile;
    mesh_shading shading;
} mesh_work;
_Static_assert(sizeof(mesh_work) <= MESH_TILE_SCRATCH, "a tile has room in its scratch");

/* ---- Nodes ---- */

enum { TREELET_STACK_MAX = MESH_DEPTH_MAX * (MESH_CHILDREN - 1) + 1 };

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
        const float corner = (float)((double)lo - w->b.eye[a]);
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
        rects_of_planes(&w->b, lo, hi, lane, parent, out);
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
    tile_pending stack[TREELET_STACK_MAX];
    near_leaves leaves = {.count = 0};
    int top = 0;
    stack[top++] = (tile_pending){0, 0, rect, near2};
    while (top > 0) {
        const tile_pending p = stack[--top];
        if (!in_sight(&w->b, p.rect, p.near2))
            continue;
        if (p.i & MESH_LEAF) {
            const uint32_t leaf = p.i & ~(uint32_t)MESH_LEAF;
            put_leaf(w, at, &p.rect, first[leaf], first[leaf + 1], &leaves);
            continue;
        }
        box_rects boxes;
        w->b.s.counters->nodes++;
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

static void visit_treelet(void *work, const tile_pending *p) {
    mesh_tile *w = work;
    const resident_mesh *at = resident_mesh_of(treelet_in_sight(&w->b, p));
    if (at)
        walk_treelet_of_mesh(w, at, p->rect, p->near2);
}

static void queue_treelet(void *work, uint32_t t) {
    const mesh_tile *w = work;
    loader_prefetch(w->b.s.f->tracer->treelets, t);
}

/* Treelet t is probably walked next. Prefetch its first nodes, leaves and masks. */
static void expect_treelet(void *work, uint32_t t) {
    const mesh_tile *w = work;
    const resident_mesh *at = resident_mesh_of(loader_peek(w->b.s.f->tracer->treelets, t));
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

static const tile_visitor mesh_visitor = {visit_treelet, queue_treelet, expect_treelet};

void SIMD_NAME(mesh_tile)(const frame *f, uint32_t x0, uint32_t y0, const tile_row asked[],
                          tile_outcome *out, ray_counters *counters) {
    mesh_work *work = out->scratch;
    mesh_tile *w = &work->tile;
    tile_boxes_begin(&w->b, f, &mesh_order, x0, y0, asked, out, counters);
    w->lanes[0].count = w->lanes[1].count = w->filling = 0;
    memset(&w->queue.tets, 0, sizeof w->queue.tets);
    w->queue.count = w->queue.pixels = 0;
    mesh_shade_begin(&work->shading, &w->b.s);
    do {
        walk_tree(&w->b, f->tracer->treelets->tree, tile_boxes_again(&w->b), 0.0f, &mesh_visitor,
                  w);
        mesh_shade(&work->shading);
    } while (tile_state_again(&w->b.s, TILE_LAYERS, work->shading.pixels.rgba[3]));
    mesh_shade_end(&work->shading);
}

#endif
#endif
