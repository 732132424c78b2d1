/* grid_walk_template.h - walks the rays of a tile through a grid, to their surfaces; included by
 * the units of an ISA (see formats/base/simd.h). */
#ifndef RENDER_GRID_GRID_WALK_TEMPLATE_H
#define RENDER_GRID_GRID_WALK_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/grid/cell_batch.h"
#include "render/grid/directory_start.h"
#include "render/grid/grid_near_template.h"
#include "render/grid/octant_order.h"
#include "render/grid/walk.h"
#include "render/ray/lane_counts.h"
#include "render/ray/ray_box.h"
#include "render/ray/ray_kernels.h"
#include "render/tile/tile_rects_template.h"
#include "render/tile/tile_state_template.h"

typedef struct tile_walk {
    tile_state s;
    tile_view view;
    cpu_isa isa;            /* of the cell kernel */
    tile_row pending[ROWS]; /* rays of s.open that look for one surface and have a cell that waits
                               in the batch */
    bool several;           /* more than the first surface counts */
    near_queue queue;
    cell_stage stage;
    /* Ray-cells on their way to the cell kernel. */
    cell_batch batch;
    unsigned waiting;
    uint16_t ray_of[CELL_BATCH];
    uint32_t cell_of[CELL_BATCH][3];
    const resident_grid *treelet_of[CELL_BATCH];
    directory_start start;
} tile_walk;

SIMD const walk_scene *scene_of(const tile_walk *w) {
    return w->s.f->tracer->own;
}

/* ---- The batch ---- */

/* A cell's local number: ten bits an axis. */
static uint32_t local_of(const resident_grid *at, const uint32_t cell[3]) {
    return (cell[0] - at->first_cell[0]) | (cell[1] - at->first_cell[1]) << 10 |
           (cell[2] - at->first_cell[2]) << 20;
}

static void cell_of_local(const resident_grid *at, uint32_t local, uint32_t cell[3]) {
    for (int a = 0; a < 3; a++)
        cell[a] = at->first_cell[a] + (local >> 10 * a & 1023u);
}

static uint64_t grid_cell_of(const frame *f, const tile_surface *s) {
    const walk_scene *scene = f->tracer->own;
    const resident_grid *at = resident_grid_of(s->at);
    uint32_t cell[3];
    cell_of_local(at, s->local, cell);
    return walk_cell_index(&scene->levels[at->level], cell);
}

/* Returns whether two hits at one t are the same hit. A ray that only touches the surface has two
 * roots there, which count once. */
static bool grid_same(const hit *a, const hit *b) {
    return a->cell == b->cell && a->iso == b->iso;
}

static const tile_order grid_order = {grid_cell_of, hit_less, grid_same};

/* Take a hit of ray-cell k. Once the ray has all surfaces that it needs, close it: later cells lie
 * behind them. But if the last surface lies at the cell's exit, only cut the ray there: the next
 * cell may have a hit at the same t. */
static void take_hit(tile_walk *w, unsigned k, double t, int32_t iso, bool entering, bool at_exit) {
    const unsigned i = w->ray_of[k];
    const resident_grid *at = w->treelet_of[k];
    const tile_surface found = {t, &at->head, local_of(at, w->cell_of[k]), iso, entering};
    if (!tile_state_take(&w->s, i, found) || !(w->s.reach[i] < (double)INFINITY))
        return;
    if (!at_exit && w->s.reach[i] <= t)
        w->s.open[i / TILE] &= ~((tile_row)1 << i % TILE);
    else
        w->s.rays.near_t1[i / TILE * STRIDE + i % TILE] =
            (float)(w->s.reach[i] * w->s.f->projection->unscale);
}

static void flush_first(tile_walk *w) {
    const walk_scene *scene = scene_of(w);
    cell_batch_hits hits;
    cell_batch_kernels[w->isa](&w->batch, (int)w->waiting, scene->isovalues, scene->count, &hits);
    for (uint32_t left = hits.found; left; left &= left - 1) {
        const unsigned k = (unsigned)__builtin_ctz(left);
        take_hit(w, k, hits.t[k], hits.iso[k], hits.entering >> k & 1u, hits.at_exit >> k & 1u);
    }
    w->s.counters->roots += (unsigned)__builtin_popcount(hits.found);
    LANE_COUNT(roots, hits.found);
}

static void flush_all(tile_walk *w) {
    const walk_scene *scene = scene_of(w);
    cell_batch_roots roots;
    for (int32_t iso = 0; iso < scene->count; iso++) {
        cell_roots_kernels[w->isa](&w->batch, (int)w->waiting, scene->isovalues[iso], &roots);
        for (int n = 0; n < CELL_ROOTS_MAX; n++) {
            for (uint32_t left = roots.found[n]; left; left &= left - 1) {
                const unsigned k = (unsigned)__builtin_ctz(left);
                take_hit(w, k, roots.t[n][k], iso, roots.entering[n] >> k & 1u,
                         roots.at_exit[n] >> k & 1u);
            }
            w->s.counters->roots += (unsigned)__builtin_popcount(roots.found[n]);
            LANE_COUNT(roots, roots.found[n]);
        }
    }
}

/* Compute the waiting ray-cells with the cell kernel, and take their hits. */
static void flush(tile_walk *w) {
    if (w->waiting == 0)
        return;
    LANE_COUNT(batches, (1u << w->waiting) - 1u);
    if (w->several)
        flush_all(w);
    else
        flush_first(w);
    w->waiting = 0;
    for (unsigned y = 0; y < TILE; y++)
        w->pending[y] = 0;
}

static bool is_open(const tile_walk *w, unsigned i) {
    return w->s.open[i / TILE] >> i % TILE & 1u;
}

/* Add ray i in a cell to the batch. Flush when the batch is full. */
static void add_to_batch(tile_walk *w, const resident_grid *at, const uint32_t cell[3],
                         const float samples[8], unsigned i) {
    const level_planes *planes = &scene_of(w)->levels[at->level];
    cell_batch *b = &w->batch;
    const unsigned k = w->waiting++;
    for (int a = 0; a < 3; a++) {
        b->d[a][k] = w->s.rays.d[a][i];
        b->lo[a][k] = planes->at[a][cell[a]] - w->view.p->eye[a];
        b->hi[a][k] = planes->at[a][cell[a] + 1] - w->view.p->eye[a];
        b->inv[a][k] = planes->inverse[a][cell[a]];
        w->cell_of[k][a] = cell[a];
    }
    b->t0[k] = w->s.rays.t0[i];
    b->t1[k] = w->s.rays.t1[i];
    for (int s = 0; s < 8; s++)
        b->samples[s][k] = samples[s];
    w->ray_of[k] = (uint16_t)i;
    w->treelet_of[k] = at;
    if (!w->several)
        w->pending[i / TILE] |= (tile_row)1 << i % TILE;
    if (w->waiting == CELL_BATCH)
        flush(w);
}

/* ---- Cells ---- */

/* Returns the open rays of a window that lie in the rectangle. */
SIMD unsigned window_open(const tile_walk *w, unsigned x, unsigned y, tile_rect r) {
    const unsigned mask = row_mask(r), below = r.y1 - y; /* rows that follow y */
    unsigned bits = 0;
    for (unsigned row = 0; row < WINDOW_Y; row++)
        bits |= ((w->s.open[y + row] & mask) >> x & 15u) << (4 * row);
    return below < WINDOW_Y ? bits & ((16u << (4 * below)) - 1u) : bits;
}

SIMD unsigned window_pending(const tile_walk *w, unsigned x, unsigned y) {
    unsigned bits = 0;
    for (unsigned row = 0; row < WINDOW_Y; row++)
        bits |= (w->pending[y + row] >> x & 15u) << (4 * row);
    return bits;
}

/* ---- Ray-cells, one a lane ---- */

/* Filter the queued ray-cells, and add those that pass to the batch. There are some. */
static __attribute__((noinline)) void queue_filter(tile_walk *w) {
    const walk_scene *scene = scene_of(w);
    near_queue *q = &w->queue;
    unsigned left = (1u << q->count) - 1u;
    float samples[VF_N][8];
    for (unsigned k = 0; k < q->count; k++) {
        walk_cell_samples(scene, q->at[k], q->cell[k], samples[k]);
        for (int s = 0; s < 8; s++)
            q->samples[s][k] = samples[k][s];
    }
    LANE_COUNT(queue, left);
    left &= queue_may_cross(q, scene->isovalues, scene->count);
    LANE_COUNT(queue_survivors, left);
    q->count = 0;
    for (; left; left &= left - 1) {
        const unsigned k = (unsigned)__builtin_ctz(left), i = q->ray[k];
        if (w->pending[i / TILE] >> i % TILE & 1u)
            flush(w);
        if (is_open(w, i))
            add_to_batch(w, q->at[k], q->cell[k], samples[k], i);
        if (scene_of(w)->by_cell)
            flush(w);
    }
}

/* Flush the queue. Mostly it is empty. */
SIMD void queue_flush(tile_walk *w) {
    if (w->queue.count > 0)
        queue_filter(w);
}

/* ---- Cells and windows ---- */

/* Read the samples of the staged cells one after the other, so that memory accesses overlap. */
static void stage_samples(tile_walk *w) {
    cell_stage *s = &w->stage;
    const walk_scene *scene = scene_of(w);
    for (unsigned k = 0; k < s->cells; k++)
        walk_cell_samples(scene, s->at[k], s->cell[k], s->samples[k]);
}

static void stage_filter(tile_walk *w) {
    const walk_scene *scene = scene_of(w);
    cell_stage *s = &w->stage;
    for (unsigned n = 0; n < s->windows; n++)
        s->crossing[n] = 0;
    for (int i = 0; i < scene->count; i++) {
        stage_forms(s, scene->isovalues[i]);
        for (unsigned n = 0; n < s->windows; n++)
            s->crossing[n] |= (uint16_t)window_crosses(s, &w->s.rays, n);
    }
    for (unsigned n = 0; n < s->windows; n++)
        s->visitors[n] &= s->crossing[n];
}

/* Add the rays of window n that passed the filter to the batch. */
SIMD void window_to_batch(tile_walk *w, unsigned n) {
    static const tile_rect all = {0, TILE - 1, 0, TILE - 1};
    const cell_stage *s = &w->stage;
    const unsigned x = s->x[n], y = s->y[n], k = s->of[n];
    LANE_COUNT(survivors, s->visitors[n]);
    if (s->visitors[n] & window_pending(w, x, y))
        flush(w);
    for (unsigned bits = s->visitors[n] & window_open(w, x, y, all); bits; bits &= bits - 1) {
        const unsigned lane = (unsigned)__builtin_ctz(bits);
        add_to_batch(w, s->at[k], s->cell[k], s->samples[k],
                     TILE * (y + lane / WINDOW_X) + x + lane % WINDOW_X);
    }
    if (scene_of(w)->by_cell)
        flush(w);
}

/* Filter the staged windows, and add the rays that pass to the batch. */
static void stage_flush(tile_walk *w) {
    cell_stage *s = &w->stage;
    if (s->windows > 0) {
        stage_samples(w);
        stage_filter(w);
        for (unsigned n = 0; n < s->windows; n++)
            if (s->visitors[n])
                window_to_batch(w, n);
    }
    s->cells = s->windows = 0;
}

/* Flush all that waits for the filter. Queue and stage never hold cells at the same time. */
static void near_flush(tile_walk *w) {
    stage_flush(w);
    queue_flush(w);
}

/* Put a window of the stage's last cell on the stage. Returns the open rays that visit the cell. */
SIMD unsigned stage_window(tile_walk *w, unsigned x, unsigned y, unsigned open) {
    cell_stage *s = &w->stage;
    const tile_rays *rays = &w->s.rays;
    const unsigned k = s->cells, n = s->windows, at = STRIDE * y + x;
    vf t_in = window_load(rays->near_t0 + at), t_out = window_load(rays->near_t1 + at);
    for (int a = 0; a < 3; a++)
        near_slab(f_set(s->lo[a][k]), f_set(s->hi[a][k]), window_load(rays->reciprocal[a] + at),
                  &t_in, &t_out);
    const unsigned visitors = open & near_passes(t_in, t_out);
    f_store(s->t_in[n], t_in);
    f_store(s->t_out[n], t_out);
    s->of[n] = (uint8_t)k;
    s->x[n] = (uint8_t)x;
    s->y[n] = (uint8_t)y;
    s->visitors[n] = (uint16_t)visitors;
    s->windows += visitors != 0;
    return visitors;
}

/* Stage one active cell and the rays of its rectangle. Not inlined: its loops would be short of
 * registers, and frames of large cells take 1.2 times as long. */
static __attribute__((noinline)) void walk_cell(tile_walk *w, const resident_grid *at,
                                                const uint32_t cell[3], tile_rect r) {
    cell_stage *s = &w->stage;
    const plane_projection *const *planes = w->view.p->at[at->level];
    unsigned visited = 0;
    queue_flush(w); /* its cells are nearer */
    if (s->cells == STAGE_CELLS)
        stage_flush(w);
    stage_cell(s, at, planes, cell);
    for (unsigned y = r.y0; y <= r.y1; y += WINDOW_Y) {
        for (unsigned x = r.x0; x <= r.x1; x += WINDOW_X) {
            if (s->windows == STAGE_WINDOWS) {
                s->cells += visited != 0;
                stage_flush(w);
                stage_cell(s, at, planes, cell);
                visited = 0;
            }
            const unsigned open = window_open(w, x, y, r);
            if (open) {
                const unsigned visitors = stage_window(w, x, y, open);
                LANE_COUNT(windows, open);
                LANE_COUNT(visitors, visitors);
                w->s.counters->cells += (unsigned)__builtin_popcount(visitors);
                visited |= visitors;
            }
        }
    }
    s->cells += visited != 0;
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
    q->ray[k] = (uint16_t)i;
    w->s.counters->cells++;
    if (q->count == VF_N)
        queue_flush(w);
}

/* With more rays at a group, it is faster to walk it cell by cell. */
enum { GROUP_RAYS_MAX = 8 };

/* Queue the active cells of a group of 2^3, ray by ray, for the open rays of its rectangle. active:
 * a bit per octant. Few rays visit the same cell there, so a lane per cell fills vectors better
 * than a lane per ray. */
static void walk_group(tile_walk *w, const resident_grid *at, const uint32_t first_cell[3],
                       unsigned active, unsigned first, tile_rect r) {
    enum { VECTORS_OF_8 = VF_N < 8 ? 8 / VF_N : 1 };
    const plane_projection *const *projected = w->view.p->at[at->level];
    group_planes planes[VECTORS_OF_8];
    stage_flush(w); /* its cells are nearer */
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
            for (unsigned order = octants_in_order(visited & active, first); order;
                 order &= order - 1) {
                const unsigned o = (unsigned)__builtin_ctz(order) ^ first;
                const uint32_t cell[3] = {first_cell[0] + (o & 1u), first_cell[1] + (o >> 1 & 1u),
                                          first_cell[2] + (o >> 2)};
                queue_add(w, at, projected, cell, TILE * y + x, t_in[o], t_out[o]);
            }
        }
    }
}

/* ---- Nodes ---- */

/* Rays of a rectangle. open: they still look for a surface. idle: open, and they have no cell in
 * the batch. VF_N rows make a vector; the vectors are ORed together. */
typedef struct rect_rays {
    vi open, idle;
} rect_rays;

SIMD rect_rays rect_rays_of(const tile_walk *w, tile_rect r) {
    static const int32_t numbers[16] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
    rect_rays rays = {{0}, {0}};
    vi number, open, pending;
    memcpy(&number, numbers, sizeof number);
    for (int y = r.y0; y <= r.y1; y += VF_N) {
        const int from = y < ROWS - VF_N ? y : ROWS - VF_N;
        memcpy(&open, w->s.open + from, sizeof open);
        memcpy(&pending, w->pending + from, sizeof pending);
        open &= (number >= y - from) & (number <= r.y1 - from);
        rays.open |= open;
        rays.idle |= open & ~pending;
    }
    rays.open &= (int32_t)row_mask(r);
    rays.idle &= (int32_t)row_mask(r);
    return rays;
}

/* Returns whether rays of the rectangle still look for a surface. If each such ray has a cell in
 * the batch, flush the batch first: it may close them all. */
static bool wanted(tile_walk *w, tile_rect r) {
    const rect_rays rays = rect_rays_of(w, r);
    if (!i_any(rays.open))
        return false;
    if (i_any(rays.idle))
        return true;
    flush(w);
    return i_any(rect_rays_of(w, r).open);
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
    const plane_projection *const *projected = w->view.p->at[at->level];
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
            const unsigned first = octant_of_eye(planes, node.cell, 1, w->view.p->eye);
            const unsigned active = walk_children(at, node.size, node.morton);
            w->s.counters->nodes++;
            walk_group(w, at, node.cell, active, first, node.rect);
            continue;
        }
        tile_rects rects;
        w->s.counters->nodes++;
        tile_rects_of(&w->view, projected, node.cell, half, &node.rect, &rects);
        const unsigned children = walk_children(at, node.size, node.morton) & rects.alive;
        const unsigned first = octant_of_eye(planes, node.cell, half, w->view.p->eye);
        unsigned order = octants_in_order(children, first);
        if (half == 1) {
            for (; order; order &= order - 1) {
                const unsigned o = (unsigned)__builtin_ctz(order) ^ first;
                const uint32_t cell[3] = {node.cell[0] + (o & 1u), node.cell[1] + (o >> 1 & 1u),
                                          node.cell[2] + (o >> 2)};
                walk_cell(w, at, cell, rects.of[o]);
            }
            continue;
        }
        for (; order; order ^= 1u << octants_last(order)) {
            const unsigned o = octants_last(order) ^ first;
            stack[top++] =
                (tree_node){{node.cell[0] + (o & 1u) * half, node.cell[1] + (o >> 1 & 1u) * half,
                             node.cell[2] + (o >> 2) * half},
                            node.morton << 3 | o,
                            node.size - 1,
                            rects.of[o]};
        }
    }
}

/* Returns the open rays of row y in the rectangle that pass treelet t. Rectangles also hold rays
 * that miss it, so each ray's interval in the treelet decides. Each cell that the kernel lets a ray
 * visit lies within that interval. */
static unsigned rays_into(const tile_walk *w, uint32_t t, unsigned y, tile_rect r) {
    const leaf_layout *layout = w->s.f->tracer->layout;
    const level_planes *planes = &scene_of(w)->levels[layout->level_of[t]];
    unsigned passing = 0;
    for (unsigned left = w->s.open[y] & row_mask(r); left; left &= left - 1) {
        const unsigned x = (unsigned)__builtin_ctz(left), i = TILE * y + x;
        /* Leave out what is in front of the last surface of earlier walks, or beyond the reach. */
        double t_in = w->s.before > 0 && w->s.after[i].t > w->s.rays.t0[i] ? w->s.after[i].t
                                                                           : w->s.rays.t0[i],
               t_out = w->s.reach[i] < w->s.rays.t1[i] ? w->s.reach[i] : w->s.rays.t1[i];
        for (int a = 0; a < 3; a++) {
            const double d = w->s.rays.d[a][i], eye = w->view.p->eye[a];
            /* End where the grid ends: the last treelet of a row may have fewer cells. */
            const uint32_t first = layout->place[t][a] << layout->cells_log2;
            const uint32_t end = first + (1u << layout->cells_log2);
            const uint32_t last = end < planes->cells[a] ? end : planes->cells[a];
            ray_box_slab(planes->at[a][first], planes->at[a][last], eye, d, &t_in, &t_out);
        }
        passing |= (unsigned)(t_in <= t_out) << x;
    }
    return passing;
}

/* Mark a treelet as touched if a ray passes it. */
static void touch(tile_walk *w, uint32_t t, tile_rect r) {
    atomic_uchar *touched = &w->s.f->tracer->touched[t];
    if (atomic_load_explicit(touched, memory_order_relaxed))
        return;
    tile_state_rays(&w->s);
    near_flush(w);
    flush(w);
    for (unsigned y = r.y0; y <= r.y1; y++)
        if (rays_into(w, t, y, r)) {
            atomic_store_explicit(touched, 1, memory_order_relaxed);
            return;
        }
}

/* Suspend the rays that pass an absent treelet. */
static void miss_treelet(tile_walk *w, uint32_t t, tile_rect r) {
    unsigned any = 0;
    tile_state_rays(&w->s);
    near_flush(w);
    flush(w);
    for (unsigned y = r.y0; y <= r.y1; y++) {
        const unsigned passing = rays_into(w, t, y, r);
        w->s.out->waits[y] |= (tile_row)passing;
        w->s.open[y] &= ~(tile_row)passing;
        any |= passing;
    }
    if (!any)
        return;
    tile_absent(w->s.out, t, 0);
    directory_start_note(&w->start, t);
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
        tile_rects_of(&w->view, w->view.p->at[level], first, half, &node.rect, &rects);
        const unsigned children = tr->treelets->children[node.t] & rects.alive;
        const unsigned existing = leaf_layout_children(layout, node.t);
        const unsigned eye =
            octant_of_eye(&scene_of(w)->levels[level], first, half, w->view.p->eye);
        unsigned order = octants_in_order(children, eye);
        if (node.t == w->start.path[level])
            order &= directory_start_order(&w->start, level, eye);
        for (; order; order ^= 1u << octants_last(order)) {
            const unsigned o = octants_last(order) ^ eye;
            const uint32_t rank = (uint32_t)__builtin_popcount(existing & ((1u << o) - 1u));
            stack[top++] = (directory_node){layout->first_child[node.t] + rank, rects.of[o]};
        }
    }
    near_flush(w);
    flush(w);
}

/* Begin with the rays of a tile that are asked for. */
static void tile_walk_begin(tile_walk *w, const frame *f, uint32_t x0, uint32_t y0,
                            const tile_row asked[], tile_outcome *out, ray_counters *counters) {
    tile_state_begin(&w->s, f, &grid_order, TILE_LAYERS, x0, y0, asked, out, counters);
    w->view = tile_view_of(f, x0, y0);
    w->isa = w->s.f->tracer->kernels->isa;
    w->several = w->s.layers != 1;
    w->waiting = 0;
    w->queue.count = w->stage.cells = w->stage.windows = 0;
    directory_start_begin(&w->start, f->tracer->layout, scene_of(w)->levels, w->view.p->eye,
                          out->first);
    for (unsigned y = 0; y < ROWS; y++)
        w->pending[y] = 0;
}

/* Walk all packets of the tile, until each ray has all surfaces that it needs, or leaves. */
static void tile_walk_run(tile_walk *w) {
    const uint8_t packet = scene_of(w)->packet;
    for (uint8_t y = 0; y < TILE; y += packet)
        for (uint8_t x = 0; x < TILE; x += packet)
            walk_directory(w,
                           (tile_rect){x, (uint8_t)(x + packet - 1), y, (uint8_t)(y + packet - 1)});
}

/* Where the next walk of the rays that wait begins. Those that have met a surface, and wait for
 * what lies behind it or lights it, begin at the root: the surface is found again. */
static uint32_t tile_walk_next(const tile_walk *w) {
    bool met = w->s.before > 0;
    for (unsigned y = 0; y < TILE && !met; y++)
        for (unsigned left = w->s.out->waits[y]; left && !met; left &= left - 1)
            met = w->s.count[TILE * y + (unsigned)__builtin_ctz(left)] > 0;
    return met ? 0 : directory_start_next(&w->start);
}

/* Prepare to walk behind the surfaces that rays have. Returns false if no ray wants more. */
static bool tile_walk_again(tile_walk *w, const float alpha[]) {
    if (!tile_state_again(&w->s, TILE_LAYERS, alpha))
        return false;
    const double unscale = w->s.f->projection->unscale;
    for (unsigned i = 0; i < TILE_RAYS; i++) {
        const unsigned padded = i / TILE * STRIDE + i % TILE;
        if (!is_open(w, i))
            continue;
        w->s.rays.near_t0[padded] = (float)(w->s.after[i].t * unscale);
        w->s.rays.near_t1[padded] = (float)(w->s.rays.t1[i] * unscale);
    }
    return true;
}

#endif
#endif
