/* grid_extreme_batch_template.h - grid_extreme_batch.h for the ISA of the translation unit that
 * includes it. */
#ifndef RENDER_GRID_GRID_EXTREME_BATCH_TEMPLATE_H
#define RENDER_GRID_GRID_EXTREME_BATCH_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "formats/base/heap.h"
#include "render/grid/grid_block_planes_template.h"
#include "render/grid/grid_block_template.h"
#include "render/grid/grid_extreme_batch.h"
#include "render/grid/grid_extreme_cells_template.h"
#include "render/grid/grid_legs_template.h"
#include "render/grid/octant_order.h"
#include "render/ray/ray_box.h"

void SIMD_NAME(grid_extreme_batch)(const tracer *tr, extreme_batch *b, void *scratch,
                                   ray_counters *counters);

/* A subtree of the directory, and the rays to which it matters. */
typedef struct extreme_tree {
    ray_set rays;
    float bound;  /* no score in it is greater */
    int32_t rank; /* orders trees of one bound: rises along all rays */
    uint32_t t;
    bool drawn; /* search the treelet itself, not its children */
} extreme_tree;

static inline bool peak_tree_before(const extreme_tree *a, const extreme_tree *b) {
    if (a->bound != b->bound)
        return a->bound > b->bound;
    return a->rank != b->rank ? a->rank < b->rank : a->drawn < b->drawn;
}

HEAP_RISE(peak_trees, extreme_tree, peak_tree_before)
HEAP_SINK(peak_trees, extreme_tree, peak_tree_before)

/* A node of a treelet's tree, a cube of 2^size cells. */
typedef struct extreme_node {
    ray_set rays;
    uint32_t cell[3];
    uint32_t morton, size;
    float bound;
} extreme_node;

enum { PEAK_TREES_MAX = 768, PEAK_NODES_MAX = 8 * (LEAF_CELLS_LOG2_MAX + 1) };

/* How a code gives a bound of scores: base + code * step + slack, but at most `most`. */
typedef struct peak_codes {
    float base, step, slack, most;
} peak_codes;

/* The rays that meet a block, packed into slots: a copy of their data in grid_rays. What they have
 * found is in extreme_cells. */
typedef struct block_rays {
    ray_slabs slabs;
    uint8_t place[RAY_BATCH];
    unsigned count;
} block_rays;

typedef struct extreme_walk {
    block_rays block;
    const tracer *tr;
    ray_counters *counters;
    grid_extent extent;
    grid_legs legs;
    extreme_cells cells;
    ray_set open;    /* still search */
    ray_set resumed; /* have seen treelets before */
    ray_set single;  /* the list of trees had no room for them */
    unsigned tree_count;
    extreme_tree trees[PEAK_TREES_MAX];
    extreme_node nodes[PEAK_NODES_MAX];
} extreme_walk;
_Static_assert(sizeof(extreme_walk) <= GRID_EXTREME_BATCH_SCRATCH,
               "a search has room in its scratch");

/* ---- Sets of rays ---- */

/* Keep the rays of the set to which scores up to `bound` may matter, at any t. Returns false if
 * none is left. */
static bool keep_searching(const extreme_walk *w, float bound, ray_set *rays) {
    const uint64_t all = (UINT64_C(1) << VF_N) - 1;
    uint64_t any = 0;
    for (unsigned k = 0; k < w->cells.rays.words; k++) {
        uint64_t matter = 0;
        rays->of[k] &= w->open.of[k];
        for (uint64_t left = rays->of[k]; left;) {
            const unsigned shift = (unsigned)__builtin_ctzll(left) & ~(VF_N - 1u);
            matter |= (uint64_t)mf_bits(
                          may_improve(&w->cells.found, 64 * k + shift, f_set(bound), f_set(0.0f)))
                      << shift;
            left &= ~(all << shift);
        }
        any |= rays->of[k] &= matter;
    }
    return any != 0;
}

/* For each child k of a node, set met[k] to the rays that meet it and to which scores up to
 * bound[k] matter there. Children, bounds and sets are in the rays' order of octants. */
SIMD void children_matter(const extreme_walk *w, const node_planes *n, const ray_set *in,
                          unsigned children, const float bound[8], ray_set met[8]) {
    const grid_rays *g = &w->cells.rays;
    const uint64_t all = (UINT64_C(1) << VF_N) - 1;
    for (unsigned k = 0; k < 8; k++)
        met[k] = (ray_set){{0}};
    for (unsigned word = 0; word < g->words; word++) {
        for (uint64_t left = in->of[word]; left;) {
            const unsigned shift = (unsigned)__builtin_ctzll(left) & ~(VF_N - 1u);
            const unsigned at = 64 * word + shift;
            const uint64_t here = left & all << shift;
            const halves_met m = halves_met_of(g, n, at);
            for (unsigned some = children; some; some &= some - 1) {
                const unsigned k = (unsigned)__builtin_ctz(some);
                const vf near = child_near(&m, k);
                const mf meet = f_le(near, child_far(&m, k));
                const mf matter = may_improve(&w->cells.found, at, f_set(bound[k]), near);
                met[k].of[word] |= (uint64_t)mf_bits(mf_and(meet, matter)) << shift & here;
            }
            left ^= here;
        }
    }
}

/* ---- Blocks ---- */

/* Put the rays of a set into slots; block_rays_leave() takes them out again. */
static void block_rays_gather(extreme_walk *w, const ray_set *rays) {
    const grid_rays *g = &w->cells.rays;
    block_rays *b = &w->block;
    const ray_slabs *from = &g->slabs;
    ray_slabs *slabs = &b->slabs;
    b->count = 0;
    for (unsigned k = 0; k < g->words; k++) {
        for (uint64_t left = rays->of[k]; left; left &= left - 1) {
            const unsigned i = 64 * k + (unsigned)__builtin_ctzll(left), to = b->count++;
            for (int a = 0; a < 3; a++) {
                slabs->near_o[a][to] = from->near_o[a][i];
                slabs->far_o[a][to] = from->far_o[a][i];
                slabs->reciprocal[a][to] = from->reciprocal[a][i];
            }
            slabs->t1[to] = from->t1[i];
            b->place[to] = (uint8_t)i;
            peak_cells_enter(&w->cells, i, to);
        }
    }
}

static void block_rays_leave(extreme_walk *w) {
    for (unsigned k = 0; k < w->block.count; k++)
        peak_cells_leave(&w->cells, w->block.place[k]);
}

/* Convert a mask of cells from Morton order to numbers x + 4 y + 16 z. */
static uint64_t cells_in_rows(uint64_t along_z) {
    static const uint8_t place[BLOCK_SIDE] = {0, 1, 8, 9};
    uint64_t cells = 0;
    if (along_z == UINT64_MAX)
        return along_z;
    for (unsigned c = 0; c < 64; c++)
        cells |= (along_z >> (place[c & 3u] + 2 * place[c >> 2 & 3u] + 4 * place[c >> 4]) & 1u)
                 << c;
    return cells;
}

/* A block to be searched. */
typedef struct extreme_block {
    const resident_grid *at;
    uint32_t first[3];
    uint64_t cells; /* the active ones: bit x + 4 y + 16 z */
    block_planes planes;
    block_scores scores;
    float group[8];   /* the greatest score of each group of 2^3 cells, */
    uint8_t order[8]; /* and the groups, the best first */
} extreme_block;

/* Add a cell of the block for some rays: bit k of `rays` is slot `from` + k. */
static void add_cell(extreme_walk *w, const extreme_block *b, const unsigned in_block[3],
                     unsigned from, unsigned rays) {
    float planes[3][3], scores[8];
    uint32_t cell[3];
    for (int a = 0; a < 3; a++) {
        cell[a] = b->first[a] + in_block[a];
        planes[a][0] = b->planes.lo[a][in_block[a]];
        planes[a][1] = b->planes.hi[a][in_block[a]];
        planes[a][2] = b->planes.inverse[a][in_block[a]];
    }
    block_cell(&b->scores, block_place(in_block[0], in_block[1], in_block[2]), scores);
    w->counters->cells += (unsigned)__builtin_popcount(rays);
    peak_cells_add(&w->cells, b->at, cell, planes, scores, w->block.place + from, rays);
}

/* Returns the rays from slot `at` on that meet the cells from `first` to `last`, in the rays'
 * order, and to which scores up to `most` matter there. */
SIMD unsigned rays_matter(const extreme_walk *w, const block_met *m, unsigned at,
                          const unsigned first[3], const unsigned last[3], float most) {
    const vf near = block_comes(m, first);
    return mf_bits(mf_and(f_le(near, block_leaves(m, last)),
                          may_improve(&w->cells.in_block, at, f_set(most), near)));
}

/* Search the cells of a group for VF_N rays. */
SIMD void search_group(extreme_walk *w, const extreme_block *b, const block_met *m, unsigned g,
                       unsigned at, unsigned rays) {
    const unsigned group[3] = {2 * (g & 1u), g & 2u, g >> 1 & 2u}, back = w->cells.rays.back;
    unsigned first[3], last[3];
    for (int a = 0; a < 3; a++) {
        first[a] = group[a] + (back >> a & 1u);
        last[a] = group[a] + 1 - (back >> a & 1u);
    }
    rays &= rays_matter(w, m, at, first, last, b->group[g]);
    for (unsigned o = 0; o < 8 && rays; o++) {
        const unsigned cell[3] = {group[0] + (o & 1u), group[1] + (o >> 1 & 1u),
                                  group[2] + (o >> 2)};
        const float most = b->scores.most[block_place(cell[0], cell[1], cell[2])];
        const unsigned some = rays & rays_matter(w, m, at, cell, cell, most);
        if (some && (b->cells >> (cell[0] + 4 * cell[1] + 16 * cell[2]) & 1u))
            add_cell(w, b, cell, at, some);
    }
}

static void sort_groups(extreme_block *b) {
    for (unsigned g = 0; g < 8; g++) {
        const float *of = b->scores.most + block_place(2 * (g & 1u), g & 2u, g >> 1 & 2u);
        float most = -INFINITY;
        for (unsigned o = 0; o < 8; o++) {
            const float m = of[block_place(o & 1u, o >> 1 & 1u, o >> 2)];
            most = m > most ? m : most;
        }
        b->group[g] = most;
        unsigned to = g;
        for (; to > 0 && b->group[b->order[to - 1]] < most; to--)
            b->order[to] = b->order[to - 1];
        b->order[to] = (uint8_t)g;
    }
}

static void search_block(extreme_walk *w, const resident_grid *at, const extreme_node *node) {
    const walk_scene *scene = w->tr->own;
    extreme_block b = {.at = at,
                       .planes =
                           block_planes_of(&w->cells.rays, &scene->levels[at->level], node->cell),
                       .first = {node->cell[0], node->cell[1], node->cell[2]},
                       .cells = cells_in_rows(at->masks->cells[node->morton])};
    block_load(scene, at, node->cell, w->cells.sign, &b.scores);
    block_maxima(&b.scores);
    sort_groups(&b);
    w->counters->nodes++;
    block_rays_gather(w, &node->rays);
    for (unsigned from = 0; from < w->block.count; from += VF_N) {
        const unsigned left = w->block.count - from;
        const block_met m = block_met_of(&w->block.slabs, from, &b.planes);
        for (unsigned k = 0; k < 8; k++)
            search_group(w, &b, &m, b.order[k], from,
                         left < VF_N ? (1u << left) - 1u : (unsigned)((UINT64_C(1) << VF_N) - 1));
    }
    block_rays_leave(w);
}

/* ---- Nodes ---- */

/* Returns how a treelet's codes give bounds of scores. Unless they are exact, the slack covers 4
 * roundings of the ends of its range. */
static peak_codes peak_codes_of(const extreme_walk *w, const resident_grid *at) {
    const uint32_t p = leaf_layout_samples(w->tr->layout, w->tr->set, at->head.id);
    const float *own = w->tr->treelets->file->own[p];
    const quantizer q = quantizer_of(own[0], own[1], w->tr->layout->type);
    const float sign = w->cells.sign, step = q.exact ? 1.0f : (float)((q.hi - q.lo) / 255.0);
    return (peak_codes){.base = sign * own[0],
                        .step = sign * step,
                        .slack = q.exact ? 0.0f
                                         : 8.0f * UNIT * fabsf(own[0]) +
                                               8.0f * UNIT * fabsf(own[1]) + 0x1p-140f,
                        .most = w->cells.least ? -own[0] : own[1]};
}

/* Compute the bounds of a node's children, in order. */
SIMD void bounds_of(const extreme_walk *w, const peak_codes *c, const resident_grid *at,
                    const extreme_node *node, float bound[8]) {
    const uint32_t k = at->shape.node_levels + LEAF_BLOCK_LOG2 - (node->size - 1);
    const uint8_t *codes =
        (const uint8_t *)at->head.payload + leaf_codes_at(k) + 8 * (size_t)node->morton;
    float of[16];
    codes += w->cells.least ? 0 : UINT32_C(1) << (3 * k);
    for (unsigned i = 0; i < 8; i += VF_N)
        f_store(of + i,
                f_min(f_of_bytes(codes + i) * f_set(c->step) + f_set(c->base) + f_set(c->slack),
                      f_set(c->most)));
    for (unsigned i = 0; i < 8; i++)
        bound[i] = of[i ^ w->cells.rays.back];
}

/* Push the children that matter. The best one comes last, and of equal ones the nearest. */
static unsigned push_children(extreme_walk *w, const peak_codes *codes, const resident_grid *at,
                              const extreme_node *node, unsigned count) {
    const walk_scene *scene = w->tr->own;
    const uint32_t half = 1u << (node->size - 1);
    const unsigned back = w->cells.rays.back, bottom = count;
    const node_planes n =
        node_planes_of(&w->cells.rays, &scene->levels[at->level], node->cell, half);
    unsigned children = octants_in_order(walk_children(at, node->size, node->morton), back);
    float bound[8];
    ray_set met[8];
    w->counters->nodes++;
    bounds_of(w, codes, at, node, bound);
    children_matter(w, &n, &node->rays, children, bound, met);
    for (; children; children ^= 1u << octants_last(children)) {
        const unsigned k = octants_last(children), o = k ^ back;
        if (ray_set_is_empty(&met[k], w->cells.rays.words))
            continue;
        unsigned to = count++;
        for (; to > bottom && w->nodes[to - 1].bound > bound[k]; to--)
            w->nodes[to] = w->nodes[to - 1];
        w->nodes[to] = (extreme_node){met[k], {0}, node->morton << 3 | o, node->size - 1, bound[k]};
        for (int a = 0; a < 3; a++)
            w->nodes[to].cell[a] = node->cell[a] + (o >> a & 1u) * half;
    }
    return count;
}

static void search_treelet(extreme_walk *w, const resident_grid *at, const extreme_tree *tree) {
    const peak_codes codes = peak_codes_of(w, at);
    unsigned count = 0;
    w->nodes[count++] = (extreme_node){tree->rays,
                                       {at->first_cell[0], at->first_cell[1], at->first_cell[2]},
                                       0,
                                       at->shape.node_levels + LEAF_BLOCK_LOG2,
                                       tree->bound};
    while (count > 0) {
        extreme_node node = w->nodes[--count];
        if (!keep_searching(w, node.bound, &node.rays))
            continue;
        if (node.size > LEAF_BLOCK_LOG2)
            count = push_children(w, &codes, at, &node, count);
        else
            search_block(w, at, &node);
    }
}

/* ---- Treelets ---- */

/* Returns whether ray i passes a treelet whose scores may matter to it. Sets *way to where it
 * passes, as grid_extreme_ways() finds it. */
static bool way_matters(const extreme_walk *w, const extreme_tree *tree, unsigned i,
                        extreme_way *way) {
    const tracer *tr = w->tr;
    const leaf_layout *layout = tr->layout;
    const walk_scene *scene = tr->own;
    const level_planes *planes = &scene->levels[layout->level_of[tree->t]];
    const ray *r = peak_ray(&w->cells, i);
    double t_in = r->t0, t_out = r->t1;
    bool inside = tracer_box(tr, r, &t_in, &t_out);
    for (int a = 0; a < 3; a++) {
        const uint32_t first = layout->place[tree->t][a] << layout->cells_log2;
        const uint32_t end = first + (1u << layout->cells_log2);
        const uint32_t last = end < planes->cells[a] ? end : planes->cells[a];
        const double lo = planes->at[a][first], hi = planes->at[a][last];
        if (r->d[a] != 0.0)
            ray_box_slab(lo, hi, r->o[a], r->d[a], &t_in, &t_out);
        else
            inside &= r->held[a] >= lo && r->held[a] < hi;
    }
    *way = (extreme_way){t_in, t_out, tree->bound, tree->t, 0};
    return inside && t_in < t_out &&
           extreme_matters(peak_state(&w->cells, i), (double)tree->bound, t_in);
}

/* Drop the rays that have seen this treelet before. */
static void drop_seen(const extreme_walk *w, extreme_tree *tree) {
    for (unsigned k = 0; k < w->cells.rays.words; k++) {
        for (uint64_t left = tree->rays.of[k] & w->resumed.of[k]; left; left &= left - 1) {
            const unsigned i = 64 * k + (unsigned)__builtin_ctzll(left);
            const extreme_way *next = &peak_state(&w->cells, i)->next;
            extreme_way way;
            if (tree->bound < next->bound ||
                (tree->bound == next->bound && way_matters(w, tree, i, &way) &&
                 !extreme_way_before(&way, next)))
                continue;
            ray_set_drop(&tree->rays, i);
        }
    }
}

/* Mark a treelet as touched if it matters to a ray. */
static void touch(extreme_walk *w, const extreme_tree *tree) {
    if (atomic_load_explicit(&w->tr->touched[tree->t], memory_order_relaxed))
        return;
    extreme_way way;
    for (unsigned k = 0; k < w->cells.rays.words; k++)
        for (uint64_t left = tree->rays.of[k]; left; left &= left - 1)
            if (way_matters(w, tree, 64 * k + (unsigned)__builtin_ctzll(left), &way)) {
                tracer_touch(w->tr, tree->t);
                return;
            }
}

/* Block the rays to which an absent treelet matters. */
static void miss_treelet(extreme_walk *w, const extreme_tree *tree) {
    for (unsigned k = 0; k < w->cells.rays.words; k++) {
        for (uint64_t left = tree->rays.of[k]; left; left &= left - 1) {
            const unsigned i = 64 * k + (unsigned)__builtin_ctzll(left);
            extreme_way way;
            if (!way_matters(w, tree, i, &way))
                continue;
            extreme_state *s = peak_state(&w->cells, i);
            s->next = way;
            s->blocked = tree->t;
            w->cells.b->result[w->cells.rays.ray[i]] = TRACE_BLOCKED;
            ray_set_drop(&w->open, i);
        }
    }
}

static void search_drawn(extreme_walk *w, extreme_tree *tree) {
    const loader *treelets = w->tr->treelets;
    if (!treelets->own[tree->t])
        return;
    peak_cells_flush(&w->cells);
    drop_seen(w, tree);
    if (!keep_searching(w, tree->bound, &tree->rays))
        return;
    const resident_grid *at = resident_grid_of(loader_lookup(treelets, tree->t));
    if (!at) {
        miss_treelet(w, tree);
        return;
    }
    touch(w, tree);
    search_treelet(w, at, tree);
}

/* ---- The directory ---- */

/* Returns the rank of a treelet: ranks rise along all rays of the octant. It is the sum of the
 * coordinates of the corner that the rays reach first, in their direction. */
static int32_t rank_of(const extreme_walk *w, uint32_t t) {
    const leaf_layout *layout = w->tr->layout;
    const uint32_t level = layout->level_of[t];
    int32_t rank = 0;
    for (int a = 0; a < 3; a++) {
        const int32_t place = (int32_t)layout->place[t][a];
        rank += w->cells.rays.back >> a & 1u ? -((place + 1) << level) : place << level;
    }
    return rank;
}

static extreme_tree tree_of(const extreme_walk *w, uint32_t t) {
    const tracer *tr = w->tr;
    const leaf_file *f = tr->treelets->file;
    const uint32_t at = leaf_layout_samples(tr->layout, tr->set, t);
    extreme_tree tree = {.t = t, .rank = rank_of(w, t)};
    tree.drawn = tr->layout->level_of[t] == tr->target_level;
    tree.bound = extreme_bound(w->cells.b->state[0], tree.drawn ? f->own[at] : f->ranges[at]);
    return tree;
}

/* Push a subtree. If there is no room, its rays begin anew as single rays. */
static void push_tree(extreme_walk *w, extreme_tree tree) {
    if (w->tree_count < PEAK_TREES_MAX) {
        peak_trees_rise(w->trees, w->tree_count++, tree);
        return;
    }
    for (unsigned k = 0; k < w->cells.rays.words; k++) {
        w->single.of[k] |= tree.rays.of[k];
        w->open.of[k] &= ~tree.rays.of[k];
    }
}

static void open_tree(extreme_walk *w, const extreme_tree *tree) {
    const tracer *tr = w->tr;
    const walk_scene *scene = tr->own;
    const leaf_layout *layout = tr->layout;
    const unsigned back = w->cells.rays.back, existing = leaf_layout_children(layout, tree->t);
    const unsigned children = octants_in_order(tr->treelets->children[tree->t], back);
    extreme_tree of[8];
    float bound[8];
    ray_set met[8];
    uint32_t first[3];
    for (unsigned left = children; left; left &= left - 1) {
        const unsigned k = (unsigned)__builtin_ctz(left), o = k ^ back;
        const uint32_t rank = (uint32_t)__builtin_popcount(existing & ((1u << o) - 1u));
        of[k] = tree_of(w, layout->first_child[tree->t] + rank);
        bound[k] = of[k].bound;
    }
    for (int a = 0; a < 3; a++)
        first[a] = layout->place[tree->t][a] << layout->cells_log2;
    const level_planes *planes = &scene->levels[layout->level_of[tree->t]];
    const node_planes n =
        node_planes_of(&w->cells.rays, planes, first, 1u << (layout->cells_log2 - 1));
    w->counters->nodes++;
    children_matter(w, &n, &tree->rays, children, bound, met);
    for (unsigned left = children; left; left &= left - 1) {
        const unsigned k = (unsigned)__builtin_ctz(left);
        of[k].rays = met[k];
        if (!ray_set_is_empty(&met[k], w->cells.rays.words))
            push_tree(w, of[k]);
    }
}

static void search_directory(extreme_walk *w) {
    extreme_tree root = tree_of(w, 0);
    root.rays = w->open;
    w->tree_count = 0;
    push_tree(w, root);
    while (w->tree_count > 0) {
        extreme_tree tree = w->trees[0];
        w->tree_count--;
        peak_trees_sink(w->trees, 0, w->tree_count, w->trees[w->tree_count]);
        if (!keep_searching(w, tree.bound, &tree.rays))
            continue;
        if (tree.drawn)
            search_drawn(w, &tree);
        else
            open_tree(w, &tree);
    }
    peak_cells_flush(&w->cells);
}

/* ---- Rays ---- */

/* Search along all rays of w->legs, whose directions lie in one octant. */
static void search_octant(extreme_walk *w) {
    extreme_cells *c = &w->cells;
    grid_rays_make(&c->rays, &w->legs, w->extent.middle, w->extent.size);
    w->open = w->single = w->resumed = c->level = (ray_set){{0}};
    c->queue = (cell_queue){.count = 0};
    c->batch.count = 0;
    for (unsigned i = 0; i < RAY_BATCH; i++)
        peak_cells_leave(c, i);
    for (unsigned i = 0; i < c->rays.count; i++) {
        const double *d = peak_ray(c, i)->d;
        ray_set_add(&w->open, i);
        if (d[0] == 0.0 || d[1] == 0.0 || d[2] == 0.0)
            ray_set_add(&c->level, i);
        if (peak_state(c, i)->next.t != LEAF_NO_TREELET)
            ray_set_add(&w->resumed, i);
        c->b->result[c->rays.ray[i]] = TRACE_MISS;
        update_best(c, i);
    }
    search_directory(w);
    for (unsigned i = 0; i < c->rays.count; i++)
        if (ray_set_has(&w->single, i))
            extreme_batch_single(w->tr, c->b, c->rays.ray[i], w->counters);
}

enum { PEAK_MISSES = 8, PEAK_ALONE };

/* Returns the octant with whose rays a ray is walked; PEAK_ALONE: as a single ray; PEAK_MISSES: it
 * misses the volume's box. */
static uint8_t begin_search(const extreme_walk *w, const ray *r, grid_approach *way) {
    if (!grid_way_ordinary(&w->extent, r, way))
        return PEAK_ALONE;
    way->t_in = r->t0;
    way->t_out = r->t1;
    return grid_way_meets_box(w->tr, r, way) ? (uint8_t)way->octant : (uint8_t)PEAK_MISSES;
}

static void peak_walk_begin(extreme_walk *w, const tracer *tr, extreme_batch *b,
                            ray_counters *counters) {
    w->tr = tr;
    w->counters = counters;
    w->cells.scene = tr->own;
    w->cells.b = b;
    w->cells.least = b->state[0]->least;
    w->cells.sign = b->state[0]->least ? -1.0f : 1.0f;
}

void SIMD_NAME(grid_extreme_batch)(const tracer *tr, extreme_batch *b, void *scratch,
                                   ray_counters *counters) {
    extreme_walk *w = scratch;
    grid_approach ways[RAY_BATCH];
    uint8_t goes[RAY_BATCH];
    unsigned octants = 0;
    peak_walk_begin(w, tr, b, counters);
    /* Where treelets of several levels are drawn, ranks do not rise along rays. */
    const bool usable = grid_extent_of(&w->extent, tr) && !tr->preview && !tr->lenient && !tr->stop;
    for (unsigned i = 0; i < b->count; i++) {
        goes[i] = usable ? begin_search(w, &b->rays[i], &ways[i]) : (uint8_t)PEAK_ALONE;
        octants |= 1u << goes[i];
        b->result[i] = TRACE_MISS;
        if (goes[i] == PEAK_ALONE)
            extreme_batch_single(tr, b, i, counters);
    }
    for (octants &= 255u; octants; octants &= octants - 1) {
        w->legs.count = 0;
        for (unsigned i = 0; i < b->count; i++)
            if (goes[i] == (unsigned)__builtin_ctz(octants))
                grid_legs_add(&w->legs, b->rays, i, &ways[i]);
        search_octant(w);
    }
}

#endif
#endif
