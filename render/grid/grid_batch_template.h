/* grid_batch_template.h - grid_batch_trace_X() of grid_batch.h; included by the units of an ISA
 * (see formats/base/simd.h). */
#ifndef RENDER_GRID_GRID_BATCH_TEMPLATE_H
#define RENDER_GRID_GRID_BATCH_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/grid/cell_batch.h"
#include "render/grid/grid_batch.h"
#include "render/grid/grid_block_cells_template.h"
#include "render/grid/grid_legs_template.h"
#include "render/grid/grid_start_template.h"
#include "render/grid/grid_tracer.h"
#include "render/grid/octant_order.h"
#include "render/grid/walk.h"
#include "render/ray/ray_box.h"
#include "render/ray/ray_kernels.h"

void SIMD_NAME(grid_batch_trace)(const tracer *tr, ray_batch *b, void *scratch,
                                 ray_counters *counters);

/* A subtree of the directory, from treelet t down, and the rays that meet it. */
typedef struct directory_node {
    ray_set rays;
    uint32_t t;
} directory_node;

/* A node of a treelet's tree, a cube of 2^size cells, and the rays that meet it. */
typedef struct tree_node {
    ray_set rays;
    uint32_t cell[3];
    uint32_t morton, size;
} tree_node;

enum { TREE_STACK_MAX = 8 * (LEAF_CELLS_LOG2_MAX + 1), DIRECTORY_STACK_MAX = 8 * LEAF_LEVELS_MAX };

typedef struct batch_walk {
    const tracer *tr;
    const walk_scene *scene;
    ray_batch *b;
    ray_counters *counters;
    grid_extent extent;
    grid_legs legs;
    grid_rays rays;
    ray_set open;    /* still look for a surface */
    ray_set pending; /* open rays with a cell that waits in the batch */
    ray_set single;  /* met an absent treelet */
    ray_set level;   /* have a direction component of 0 */
    hit best[RAY_BATCH];
    const resident_grid *at[RAY_BATCH]; /* treelet of best; NULL: best is the state's */
    block_cells block;
    /* Ray-cells on their way to the cell kernel. */
    cell_batch batch;
    unsigned waiting;
    unsigned starts;          /* lanes whose ray has a hit to be behind, */
    double after[CELL_BATCH]; /* and the t of that hit; else -INFINITY */
    uint8_t ray_of[CELL_BATCH];
    uint32_t cell_of[CELL_BATCH][3];
    const resident_grid *treelet_of[CELL_BATCH];
    directory_node directory[DIRECTORY_STACK_MAX];
    tree_node tree[TREE_STACK_MAX];
} batch_walk;
_Static_assert(sizeof(batch_walk) <= GRID_BATCH_SCRATCH, "a batch has room in its scratch");

/* ---- Hits ---- */

SIMD const ray *ray_at(const batch_walk *w, unsigned i) {
    return &w->b->rays[w->rays.ray[i]];
}

SIMD trace_state *state_at(const batch_walk *w, unsigned i) {
    return &w->b->states[w->rays.ray[i]];
}

/* Take a hit of ray i, and close the ray: later cells lie behind it. But if the hit lies at the
 * cell's exit, only cut the ray there: the next cell may have a hit at the same t. One flush may
 * compute several cells of a ray, in any order: keep the least hit. */
static void take_hit(batch_walk *w, unsigned i, const resident_grid *at, const hit *h,
                     bool at_exit) {
    if (hit_less(h, &w->best[i])) {
        w->best[i] = *h;
        w->at[i] = at;
    }
    if (!at_exit)
        ray_set_drop(&w->open, i);
    else
        w->rays.slabs.t1[i] = w->rays.span_of[i][1] =
            (float)(w->best[i].t - w->rays.t_in[i]) * (1.0f + 4.0f * UNIT);
}

/* Take ray i's first hit in a cell strictly behind state->after, by the scalar kernel. */
static void take_scalar_hit(batch_walk *w, unsigned i, const resident_grid *at,
                            const uint32_t cell[3], const float samples[8]) {
    const walk_scene *scene = w->scene;
    const level_planes *planes = &scene->levels[at->level];
    const uint64_t index = walk_cell_index(planes, cell);
    const cell_box box = walk_cell_box(planes, cell);
    cell_visit visit;
    if (!cell_visit_of(ray_at(w, i), &box, &visit))
        return;
    for (int iso = 0; iso < scene->count; iso++) {
        hit h;
        if (cell_next_hit(ray_at(w, i), &visit, samples, scene->isovalues[iso], iso, index,
                          &state_at(w, i)->after, &h))
            take_hit(w, i, at, &h, h.t == visit.t_out);
    }
}

/* ---- The batch ---- */

/* Drop the lanes that have no hit behind the surface on which their ray starts. */
SIMD void drop_starts(batch_walk *w) {
    const walk_scene *scene = w->scene;
    cell_batch *b = &w->batch;
    for (int at = 0; w->starts >> at; at += VD_N) {
        unsigned none = (1u << VD_N) - 1;
        if (!(w->starts >> at & none))
            continue;
        const start_visit v = start_visit_of(b, at);
        for (int i = 0; i < scene->count && none; i++) {
            vd f[8];
            for (int s = 0; s < 8; s++)
                f[s] = d_of_floats(b->samples[s] + at) - d_set(scene->isovalues[i]);
            none &= start_clears(&v, f, d_load(w->after + at));
        }
        /* A ray that ends before it begins visits nothing. */
        for (none &= w->starts >> at; none; none &= none - 1)
            b->t1[at + __builtin_ctz(none)] = -INFINITY;
    }
    w->starts = 0;
}

/* Take lane k's first root of this isosurface that is behind state->after. */
static void take_later_root(batch_walk *w, unsigned k, int32_t iso, const cell_batch_roots *roots) {
    const unsigned i = w->ray_of[k];
    const resident_grid *at = w->treelet_of[k];
    const uint64_t index = walk_cell_index(&w->scene->levels[at->level], w->cell_of[k]);
    for (int n = 0; n < CELL_ROOTS_MAX && (roots->found[n] >> k & 1u); n++) {
        const hit h = {roots->t[n][k], index, iso, roots->entering[n] >> k & 1u};
        if (!hit_less(&state_at(w, i)->after, &h))
            continue;
        take_hit(w, i, at, &h, roots->at_exit[n] >> k & 1u);
        return;
    }
}

/* The first hit of these lanes is not behind state->after. Compute all roots of their cells, and
 * take the first one behind it. */
static void take_later_hits(batch_walk *w, unsigned lanes) {
    const walk_scene *scene = w->scene;
    cell_batch_roots roots;
    for (int32_t iso = 0; iso < scene->count && lanes; iso++) {
        cell_roots_kernels[w->tr->kernels->isa](&w->batch, (int)w->waiting, scene->isovalues[iso],
                                                &roots);
        for (unsigned left = lanes; left; left &= left - 1)
            take_later_root(w, (unsigned)__builtin_ctz(left), iso, &roots);
    }
}

/* Compute the waiting ray-cells with the cell kernel, and take their hits. */
static void flush(batch_walk *w) {
    const walk_scene *scene = w->scene;
    cell_batch_hits hits;
    unsigned later = 0;
    if (w->waiting == 0)
        return;
    drop_starts(w);
    cell_batch_kernels[w->tr->kernels->isa](&w->batch, (int)w->waiting, scene->isovalues,
                                            scene->count, &hits);
    for (uint32_t left = hits.found; left; left &= left - 1) {
        const unsigned k = (unsigned)__builtin_ctz(left), i = w->ray_of[k];
        const resident_grid *at = w->treelet_of[k];
        const uint64_t index = walk_cell_index(&scene->levels[at->level], w->cell_of[k]);
        const hit h = {hits.t[k], index, hits.iso[k], hits.entering >> k & 1u};
        if (hit_less(&state_at(w, i)->after, &h))
            take_hit(w, i, at, &h, hits.at_exit >> k & 1u);
        else
            later |= 1u << k;
    }
    take_later_hits(w, later);
    w->counters->roots += (unsigned)__builtin_popcount(hits.found);
    w->waiting = 0;
    w->pending = (ray_set){{0}};
}

/* Add ray i in a cell to the batch. Flush when the batch is full. */
static void add_to_batch(batch_walk *w, const resident_grid *at, const uint32_t cell[3],
                         const float samples[8], unsigned i) {
    const unsigned k = w->waiting++;
    cell_batch_put(&w->batch, k, &w->scene->levels[at->level], ray_at(w, i), cell, samples);
    for (int a = 0; a < 3; a++)
        w->cell_of[k][a] = cell[a];
    w->ray_of[k] = (uint8_t)i;
    w->after[k] = state_at(w, i)->after.t;
    w->starts |= (unsigned)(w->after[k] > -INFINITY) << k;
    w->treelet_of[k] = at;
    ray_set_add(&w->pending, i);
    if (w->waiting == CELL_BATCH)
        flush(w);
}

static bool goes_along(const batch_walk *w, const resident_grid *at, const uint32_t cell[3],
                       unsigned i) {
    return cell_batch_along(&w->scene->levels[at->level], ray_at(w, i), cell, w->rays.t_in[i],
                            w->rays.t_out[i]);
}

/* ---- Blocks ---- */

/* block_may_cross(), not inlined: the loop around it would be short of registers. */
static __attribute__((noinline)) unsigned block_crossing(const batch_walk *w, unsigned from) {
    return block_may_cross(&w->block, &w->rays, from, w->scene);
}

/* Add ray-cell k of the block to the batch, or take its hit where no batch can. */
static void block_to_batch(batch_walk *w, unsigned k) {
    const block_cells *b = &w->block;
    const unsigned i = b->ray[k];
    const float *samples = b->samples[b->cell[k]];
    uint32_t cell[3];
    if (!ray_set_has(&w->open, i))
        return;
    block_cell_at(b, b->cell[k], cell);
    if (ray_set_has(&w->level, i) && !goes_along(w, b->at, cell, i))
        take_scalar_hit(w, i, b->at, cell, samples);
    else
        add_to_batch(w, b->at, cell, samples, i);
}

/* Filter the ray-cells of a block, and add those that pass to the batch. There are some. Not
 * inlined: seldom called from the loop over cells. */
static __attribute__((noinline)) void block_filter(batch_walk *w) {
    block_cells *b = &w->block;
    block_cells_complete(b, w->scene);
    for (unsigned from = 0; from < b->count; from += VF_N) {
        const unsigned n = b->count - from < VF_N ? b->count - from : VF_N;
        unsigned left = block_crossing(w, from) & ((1u << n) - 1u);
        for (; left; left &= left - 1)
            block_to_batch(w, from + (unsigned)__builtin_ctz(left));
    }
    w->counters->cells += b->count;
    b->count = 0;
    b->met = 0;
}

SIMD void block_flush(batch_walk *w) {
    if (w->block.count > 0)
        block_filter(w);
}

/* Collect the active cells that the VF_N rays from `at` on meet. in: a bit per ray that counts. */
SIMD void walk_cells(batch_walk *w, uint64_t active, unsigned at, unsigned in) {
    block_cells *b = &w->block;
    const block_met m = block_met_of(&w->rays.slabs, at, &b->planes);
    const unsigned flip = block_flip(w->rays.back);
    for (; active; active &= active - 1) {
        const uint32_t number = (uint32_t)__builtin_ctzll(active) ^ flip;
        block_cells_put(b, number, at, block_cell_met(&m, number) & in);
        if (b->count >= RAY_CELLS)
            block_flush(w);
    }
}

/* Walk the active cells of a block for the rays that meet it. */
static void walk_block(batch_walk *w, const resident_grid *at, const uint32_t first[3],
                       uint64_t cells, const ray_set *rays) {
    const uint64_t active = block_in_order(cells, w->rays.back), all = (UINT64_C(1) << VF_N) - 1;
    block_cells_begin(&w->block, &w->rays, &w->scene->levels[at->level], at, first);
    for (unsigned word = 0; word < w->rays.words; word++) {
        for (uint64_t left = rays->of[word]; left;) {
            const unsigned shift = (unsigned)__builtin_ctzll(left) & ~(VF_N - 1u);
            walk_cells(w, active, 64 * word + shift, (unsigned)(left >> shift & all));
            left &= ~(all << shift);
        }
    }
    block_flush(w);
}

/* ---- Nodes ---- */

/* Drop the rays of the set that no longer look for a surface. Returns whether any is left. If each
 * of these has a cell in the batch, flush the batch first: it may close them all. */
static bool wanted(batch_walk *w, ray_set *rays) {
    uint64_t open = 0, idle = 0;
    for (unsigned k = 0; k < w->rays.words; k++) {
        rays->of[k] &= w->open.of[k];
        open |= rays->of[k];
        idle |= rays->of[k] & ~w->pending.of[k];
    }
    if (idle || !open)
        return open != 0;
    flush(w);
    for (unsigned k = 0; k < w->rays.words; k++)
        rays->of[k] &= w->open.of[k];
    return !ray_set_is_empty(rays, w->rays.words);
}

static void walk_tree(batch_walk *w, const resident_grid *at, const ray_set *rays) {
    const level_planes *planes = &w->scene->levels[at->level];
    const unsigned back = w->rays.back;
    tree_node *stack = w->tree;
    int top = 0;
    stack[top++] = (tree_node){*rays,
                               {at->first_cell[0], at->first_cell[1], at->first_cell[2]},
                               0,
                               at->shape.node_levels + LEAF_BLOCK_LOG2};
    while (top > 0) {
        tree_node node = stack[--top];
        if (!wanted(w, &node.rays))
            continue;
        w->counters->nodes++;
        if (node.size == LEAF_BLOCK_LOG2) {
            walk_block(w, at, node.cell, at->masks->cells[node.morton], &node.rays);
            continue;
        }
        const uint32_t half = 1u << (node.size - 1);
        const node_planes n = node_planes_of(&w->rays, planes, node.cell, half);
        ray_set met[8];
        children_met(&w->rays, &n, &node.rays, met);
        for (unsigned order = octants_in_order(walk_children(at, node.size, node.morton), back);
             order; order ^= 1u << octants_last(order)) {
            const unsigned nth = octants_last(order), o = nth ^ back;
            if (ray_set_is_empty(&met[nth], w->rays.words))
                continue;
            stack[top++] =
                (tree_node){met[nth],
                            {node.cell[0] + (o & 1u) * half, node.cell[1] + (o >> 1 & 1u) * half,
                             node.cell[2] + (o >> 2) * half},
                            node.morton << 3 | o,
                            node.size - 1};
        }
    }
}

/* ---- Treelets ---- */

/* Up to so many rays walk through a treelet one by one. */
enum { ALONE_MAX = 4 };

/* Returns whether ray i passes treelet t, and where. The sets of nodes also hold rays that miss, so
 * the ray's interval in the treelet decides. Each cell that the kernel lets the ray visit lies
 * within that interval. */
static bool passes(const batch_walk *w, uint32_t t, unsigned i, double *from, double *to) {
    const leaf_layout *layout = w->tr->layout;
    const level_planes *planes = &w->scene->levels[layout->level_of[t]];
    const ray *r = ray_at(w, i);
    /* The ray needs nothing behind its best hit. */
    double t_in = w->rays.t_in[i];
    double t_out = w->best[i].t < w->rays.t_out[i] ? w->best[i].t : w->rays.t_out[i];
    for (int a = 0; a < 3; a++) {
        /* End where the grid ends: the last treelet of a row may have fewer cells. */
        const uint32_t first = layout->place[t][a] << layout->cells_log2;
        const uint32_t end = first + (1u << layout->cells_log2);
        const uint32_t last = end < planes->cells[a] ? end : planes->cells[a];
        const double lo = planes->at[a][first], hi = planes->at[a][last];
        if (r->d[a] != 0.0)
            ray_box_slab(lo, hi, r->o[a], r->d[a], &t_in, &t_out);
        else if (r->held[a] < lo || r->held[a] >= hi)
            return false;
    }
    *from = t_in;
    *to = t_out;
    return t_in <= t_out;
}

static ray_set passing(batch_walk *w, uint32_t t, const ray_set *rays) {
    ray_set some = {{0}};
    double from, to;
    flush(w);
    for (unsigned k = 0; k < w->rays.words; k++)
        for (uint64_t left = rays->of[k] & w->open.of[k]; left; left &= left - 1)
            if (passes(w, t, 64 * k + (unsigned)__builtin_ctzll(left), &from, &to))
                some.of[k] |= left & (~left + 1);
    return some;
}

/* Mark a treelet as touched if a ray passes it. */
static void touch(batch_walk *w, uint32_t t, const ray_set *rays) {
    if (atomic_load_explicit(&w->tr->touched[t], memory_order_relaxed))
        return;
    const ray_set some = passing(w, t, rays);
    if (!ray_set_is_empty(&some, w->rays.words))
        tracer_touch(w->tr, t);
}

/* Take the rays that pass an absent treelet out of the batch. They begin anew as single rays. */
static void miss_treelet(batch_walk *w, uint32_t t, const ray_set *rays) {
    const ray_set some = passing(w, t, rays);
    for (unsigned k = 0; k < w->rays.words; k++) {
        w->single.of[k] |= some.of[k];
        w->open.of[k] &= ~some.of[k];
    }
}

/* Flush the batch if a cell of these rays waits in it. */
static void answer(batch_walk *w, const ray_set *rays) {
    uint64_t waiting = 0;
    for (unsigned k = 0; k < w->rays.words; k++)
        waiting |= rays->of[k] & w->pending.of[k];
    if (waiting)
        flush(w);
}

/* Walk rays one by one. A few rays do not fill vectors, and a single ray stops at its first hit. */
static void walk_alone(batch_walk *w, uint32_t t, const resident_grid *at, const ray_set *rays) {
    answer(w, rays);
    for (unsigned k = 0; k < w->rays.words; k++) {
        for (uint64_t left = rays->of[k] & w->open.of[k]; left; left &= left - 1) {
            const unsigned i = 64 * k + (unsigned)__builtin_ctzll(left);
            double t_in, t_out;
            hit h = w->best[i];
            if (passes(w, t, i, &t_in, &t_out) &&
                w->scene->walk(w->scene, at, ray_at(w, i), t_in, t_out, 255u,
                               &state_at(w, i)->after, &h, w->counters))
                take_hit(w, i, at, &h, h.t >= t_out);
        }
    }
}

static void walk_drawn(batch_walk *w, uint32_t t, const ray_set *rays) {
    const loader *treelets = w->tr->treelets;
    if (!treelets->own[t])
        return;
    const resident_grid *at = resident_grid_of(loader_lookup(w->tr->treelets, t));
    if (!at) {
        miss_treelet(w, t, rays);
        return;
    }
    touch(w, t, rays);
    if (ray_set_count(rays, w->rays.words) <= ALONE_MAX)
        walk_alone(w, t, at, rays);
    else
        walk_tree(w, at, rays);
}

static void walk_directory(batch_walk *w) {
    const tracer *tr = w->tr;
    const leaf_layout *layout = tr->layout;
    const uint32_t half = 1u << (layout->cells_log2 - 1);
    const unsigned back = w->rays.back;
    directory_node *stack = w->directory;
    int top = 0;
    stack[top++] = (directory_node){w->open, 0};
    while (top > 0) {
        directory_node node = stack[--top];
        if (!wanted(w, &node.rays))
            continue;
        const uint32_t level = layout->level_of[node.t];
        if (level == tr->target_level || (tr->stop && tr->stop[node.t])) {
            walk_drawn(w, node.t, &node.rays);
            continue;
        }
        uint32_t first[3];
        for (int a = 0; a < 3; a++)
            first[a] = layout->place[node.t][a] << layout->cells_log2;
        const node_planes n = node_planes_of(&w->rays, &w->scene->levels[level], first, half);
        ray_set met[8];
        w->counters->nodes++;
        children_met(&w->rays, &n, &node.rays, met);
        const unsigned existing = leaf_layout_children(layout, node.t);
        for (unsigned order = octants_in_order(tr->treelets->children[node.t], back); order;
             order ^= 1u << octants_last(order)) {
            const unsigned nth = octants_last(order), o = nth ^ back;
            const uint32_t rank = (uint32_t)__builtin_popcount(existing & ((1u << o) - 1u));
            if (!ray_set_is_empty(&met[nth], w->rays.words))
                stack[top++] = (directory_node){met[nth], layout->first_child[node.t] + rank};
        }
    }
    flush(w);
}

/* ---- Rays ---- */

/* Write the results. Rays that met absent treelets begin anew as single rays. */
static void deliver(batch_walk *w) {
    const tracer *tr = w->tr;
    for (unsigned i = 0; i < w->rays.count; i++) {
        trace_state *state = state_at(w, i);
        if (ray_set_has(&w->single, i)) {
            ray_batch_single(tr, w->b, w->rays.ray[i], w->counters);
            continue;
        }
        state->best = w->best[i];
        if (w->at[i] && !state->any)
            state->point = grid_tracer_surface(tr, &w->at[i]->head, ray_at(w, i), &state->best);
        w->b->results[w->rays.ray[i]] = hit_exists(&state->best) ? TRACE_HIT : TRACE_MISS;
    }
}

/* Walk all rays of w->legs, whose directions lie in one octant. */
static void walk_octant(batch_walk *w) {
    grid_rays_make(&w->rays, &w->legs, w->extent.middle, w->extent.size);
    w->open = w->pending = w->single = w->level = (ray_set){{0}};
    w->waiting = w->starts = 0;
    for (unsigned i = 0; i < w->rays.count; i++) {
        const double *d = ray_at(w, i)->d;
        ray_set_add(&w->open, i);
        if (d[0] == 0.0 || d[1] == 0.0 || d[2] == 0.0)
            ray_set_add(&w->level, i);
        w->best[i] = state_at(w, i)->best;
        w->at[i] = NULL;
    }
    walk_directory(w);
    deliver(w);
}

enum { DONE = 8, ALONE };

/* Returns the octant with whose rays ray i is walked; ALONE: as a single ray; DONE: the ray misses
 * the volume's box between state->after and its best hit so far. */
static uint8_t begin_ray(const batch_walk *w, unsigned i, grid_approach *way) {
    const ray *r = &w->b->rays[i];
    const trace_state *state = &w->b->states[i];
    if (state->blocked != LEAF_NO_TREELET || !grid_way_ordinary(&w->extent, r, way))
        return ALONE;
    way->t_in = r->t0 > state->after.t ? r->t0 : state->after.t;
    way->t_out = r->t1 < state->best.t ? r->t1 : state->best.t;
    if (grid_way_meets_box(w->tr, r, way))
        return (uint8_t)way->octant;
    w->b->results[i] = hit_exists(&state->best) ? TRACE_HIT : TRACE_MISS;
    return DONE;
}

void SIMD_NAME(grid_batch_trace)(const tracer *tr, ray_batch *b, void *scratch,
                                 ray_counters *counters) {
    batch_walk *w = scratch;
    grid_approach ways[RAY_BATCH];
    uint8_t goes[RAY_BATCH];
    unsigned octants = 0;
    w->tr = tr;
    w->scene = tr->own;
    w->b = b;
    w->counters = counters;
    const bool usable = grid_extent_of(&w->extent, tr) && !tr->preview && !tr->lenient;
    for (unsigned i = 0; i < b->count; i++) {
        goes[i] = usable ? begin_ray(w, i, &ways[i]) : (uint8_t)ALONE;
        octants |= 1u << goes[i];
        if (goes[i] == ALONE)
            ray_batch_single(tr, b, i, counters);
    }
    for (octants &= 255u; octants; octants &= octants - 1) {
        const unsigned octant = (unsigned)__builtin_ctz(octants);
        w->legs.count = 0;
        for (unsigned i = 0; i < b->count; i++)
            if (goes[i] == octant)
                grid_legs_add(&w->legs, b->rays, i, &ways[i]);
        walk_octant(w);
    }
}

#endif
#endif
