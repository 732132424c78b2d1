/* heights_tile_template.h - heights_tile_X() of heights_tile.h; included by the units of an ISA
 * (see formats/base/simd.h). */
#ifndef RENDER_HEIGHTS_HEIGHTS_TILE_TEMPLATE_H
#define RENDER_HEIGHTS_HEIGHTS_TILE_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/heights/heights_roots_template.h"
#include "render/heights/heights_tile.h"
#include "render/heights/heights_ways_template.h"

enum { TILE = HEIGHTS_TILE, TILE_WINDOWS = 0 };

#include "render/tile/tile_boxes_template.h"
#include "render/tile/tile_shade_template.h"

typedef struct heights_tile {
    tile_boxes b;
    float unit2[3]; /* squares of the world lengths of grid units */
    tile_pixels pixels;
    double t_in[TILE * TILE], t_out[TILE * TILE]; /* where rays are in the treelet */
    ways ways;
} heights_tile;
_Static_assert(TILE *TILE <= WAYS, "each ray may have a way");
_Static_assert(sizeof(heights_tile) <= HEIGHTS_TILE_SCRATCH, "a tile has room in its scratch");

/* ---- Cells ---- */

/* A cell's number in its treelet. */
enum { LOCAL_LOG2 = LEAF_CELLS_LOG2_MAX };

static uint64_t cell_number(const frame *f, const tile_surface *s) {
    const resident_grid *g = resident_grid_of(s->at);
    const uint32_t *cells = f->tracer->layout->level[g->level].cells;
    return g->first_cell[0] + (s->local & ((1U << LOCAL_LOG2) - 1U)) +
           (uint64_t)cells[0] * (g->first_cell[2] + (s->local >> LOCAL_LOG2));
}

static bool cell_less(const hit *a, const hit *b) {
    return hit_less(a, b);
}

static bool cell_same(const hit *a, const hit *b) {
    return !hit_less(a, b) && !hit_less(b, a);
}

static const tile_order cell_order = {cell_number, cell_less, cell_same};

static ray ray_of(const tile_state *s, unsigned i) {
    ray r = {.t0 = s->rays.t0[i], .t1 = s->rays.t1[i]};
    for (int a = 0; a < 3; a++) {
        r.o[a] = r.held[a] = s->f->projection->eye[a];
        r.d[a] = s->rays.d[a][i];
    }
    return r;
}

/* ---- Shading ---- */

static void cell_normals(void *work, const tile_layer *l, tile_normals normal) {
    const heights_tile *w = work;
    const tracer *tr = w->b.s.f->tracer;
    const treelet *at = NULL;
    heights_block b = {.of = NULL};
    for (unsigned i = 0; i < TILE_RAYS; i++) {
        if (!in_layer(l, i))
            continue;
        const tile_surface *x = surface_of(l, i);
        const ray r = ray_of(&w->b.s, i);
        heights_patch p;
        double slope[3], gradient[3];
        float unit[3];
        if (at != x->at)
            b = heights_block_of(tr, at = x->at);
        (void)heights_block_patch(&b, x->local & ((1U << LOCAL_LOG2) - 1U), x->local >> LOCAL_LOG2,
                                  &p);
        (void)heights_hit_slope(&tr->space, &p, &r, x->t, slope, gradient, unit);
        for (int a = 0; a < 3; a++)
            normal[a][i] = unit[a];
    }
}

static void shadow_starts(void *work, const tile_layer *l, unsigned i, unsigned which,
                          surface_point to[]) {
    const heights_tile *w = work;
    for (unsigned left = which; left; left &= left - 1) {
        const unsigned n = i + (unsigned)__builtin_ctz(left);
        const tile_surface *x = surface_of(l, n);
        const ray r = ray_of(&w->b.s, n);
        const hit h = tile_hit(&w->b.s, x);
        *to++ = heights_hit_surface(w->b.s.f->tracer, x->at, &r, &h);
    }
}

static void cell_colours(void *work, const tile_layer *l, unsigned i, unsigned which,
                         float rgb[][3]) {
    const heights_tile *w = work;
    const frame *f = w->b.s.f;
    for (unsigned left = which; left; left &= left - 1) {
        const unsigned k = (unsigned)__builtin_ctz(left);
        const tile_surface *x = surface_of(l, i + k);
        const ray r = ray_of(&w->b.s, i + k);
        const hit h = tile_hit(&w->b.s, x);
        const surface_point at = heights_hit_surface(f->tracer, x->at, &r, &h);
        surface_colour(f, 0, &h, &at, rgb[k]);
    }
}

static const tile_kind shading = {cell_normals, shadow_starts, cell_colours};

/* ---- A treelet ---- */

static void walk_ray(heights_tile *w, const heights_block *b, unsigned i, double t_in,
                     double t_out) {
    tile_state *s = &w->b.s;
    const ray r = ray_of(s, i);
    heights_way way;
    heights_patch p;
    int cell[2];
    heights_way_begin(&way, b, &r, t_in, t_out, 255U);
    while (heights_way_next(&way, s->reach[i], cell, &p)) {
        heights_root roots[2];
        const int count = heights_patch_roots(&p, &r, roots);
        s->counters->cells++;
        for (int k = 0; k < count; k++) {
            const tile_surface found = {.t = roots[k].t,
                                        .at = &b->of->head,
                                        .local = (uint32_t)(cell[0] | cell[1] << LOCAL_LOG2),
                                        .entering = roots[k].entering};
            if (!(found.t >= r.t0 && found.t <= r.t1 && found.t <= s->reach[i]) ||
                !tile_state_take(s, i, found))
                continue;
            if (s->reach[i] < (double)INFINITY)
                look_as_far(&w->b, i);
            s->counters->roots++;
        }
    }
}

/* A treelet's box in grid space, and where rays are in it. */
typedef struct heights_box {
    double lo[3], hi[3];
} heights_box;

static heights_box box_of(const tracer *tr, uint32_t t, const float range[2]) {
    const leaf_layout *l = tr->layout;
    const double side = ldexp(1.0, (int)(l->cells_log2 + l->level_of[t]));
    heights_box b;
    for (int a = 0; a < 3; a += 2) {
        b.lo[a] = l->place[t][a] * side;
        b.hi[a] = b.lo[a] + side;
    }
    b.lo[1] = (double)range[0];
    b.hi[1] = (double)range[1];
    return b;
}

/* Returns which of VD_N rays from i on pass over or through the box as far as they look. */
SIMD unsigned rays_in(heights_tile *w, const heights_box *b, unsigned i) {
    const tile_rays *rays = &w->b.s.rays;
    vd in = d_load(rays->t0 + i);
    vd out = d_min(d_load(rays->t1 + i), d_load(w->b.s.reach + i));
    for (int a = 0; a < 3; a += 2) {
        const vd d = d_load(rays->d[a] + i), o = d_set(w->b.eye[a]);
        const vd first = (d_set(b->lo[a]) - o) / d, last = (d_set(b->hi[a]) - o) / d;
        in = d_max(in, d_min(first, last));
        out = d_min(out, d_max(first, last));
    }
    const vd o = d_set(w->b.eye[1]), d = d_load(rays->d[1] + i);
    const vd from = o + in * d, to = o + out * d;
    const vd slack = d_set(0x1p-48) * (d_abs(o) + d_max(d_abs(from), d_abs(to)) +
                                       d_set(fabs(b->lo[1]) + fabs(b->hi[1])));
    const md beside = md_or(d_gt(d_min(from, to), d_set(b->hi[1]) + slack),
                            d_lt(d_max(from, to), d_set(b->lo[1]) - slack));
    d_store(w->t_in + i, in);
    d_store(w->t_out + i, out);
    return md_bits(md_and_not(d_le(in, out), beside)) & ((1u << VD_N) - 1u);
}

/* The box of a treelet's cells. */
static heights_box box_of_cells(const heights_block *b) {
    heights_box box = {.lo[1] = b->range[0], .hi[1] = b->range[1]};
    for (int a = 0; a < 3; a += 2) {
        const uint32_t first = b->of->first_cell[a];
        box.lo[a] = first * b->size;
        box.hi[a] = (double)(first + b->of->shape.cells[a]) * b->size;
    }
    return box;
}

/* Suspend the open rays of a rectangle that pass an absent treelet. */
static void await_treelet(heights_tile *w, const tile_pending *p) {
    const tracer *tr = w->b.s.f->tracer;
    const heights_box box = box_of(tr, p->i, tracer_range(tr, p->i));
    bool any = false;
    for (unsigned y = p->rect.y0; y <= p->rect.y1; y++) {
        tile_row waits = 0;
        for (unsigned x = p->rect.x0 & ~(VD_N - 1u); x <= p->rect.x1; x += VD_N)
            waits |= (tile_row)rays_in(w, &box, TILE * y + x) << x;
        waits &= w->b.s.open[y] & row_mask(p->rect);
        w->b.s.out->waits[y] |= waits;
        w->b.s.open[y] &= ~waits;
        any = any || waits;
    }
    if (any) {
        tile_absent(w->b.s.out, p->i, 0);
        look_with_open(&w->b);
    }
}

/* Cut the ways of VD_N rays to the treelet's elevations, and store where they come in and go out,
 * on axes 0, 2 and 1. Returns which of them are left. */
SIMD unsigned cut_ways(const heights_tile *w, const way_block *b, unsigned i, double slack,
                       unsigned k, float from[3][VF_N], float to[3][VF_N]) {
    const heights_block *of = b->b;
    const vd o = d_set(w->b.eye[1]), d = d_load(w->b.s.rays.d[1] + i);
    const vd least = d_set(of->range[0] - slack), most = d_set(of->range[1] + slack);
    const md falls = d_lt(d, d_set(0.0));
    const vd in = d_max(d_load(w->t_in + i), (d_select(falls, most, least) - o) / d);
    const vd out = d_min(d_load(w->t_out + i), (d_select(falls, least, most) - o) / d);
    for (int a = 0; a < 2; a++) {
        const vd eye = d_set(w->b.eye[2 * a]), along = d_load(w->b.s.rays.d[2 * a] + i);
        const vd inverse = d_set(of->inverse), first = d_set(of->of->first_cell[2 * a]);
        d_store_floats(from[a] + k, (eye + in * along) * inverse - first);
        d_store_floats(to[a] + k, (eye + out * along) * inverse - first);
    }
    d_store_floats(from[2] + k, (o + in * d - d_set(b->least)) * d_set(b->codes));
    d_store_floats(to[2] + k, (o + out * d - d_set(b->least)) * d_set(b->codes));
    return md_bits(d_le(in, out)) & ((1u << VD_N) - 1u);
}

/* Add the ways of the rays from i on that are `passing`. */
SIMD void add_ways(ways *to, const way_block *b, unsigned i, unsigned passing, float from[3][VF_N],
                   float along[3][VF_N]) {
    const vf few = f_set(0x1p-20f);
    mf doubt = f_lt(few, few);
    for (int a = 0; a < 2; a++) {
        vf o, d;
        doubt = mf_or(doubt, way_axis(b, a, f_load(from[a]), f_load(along[a]), &o, &d));
        f_store(from[a], o);
        f_store(along[a], d);
    }
    const vf rise = f_load(along[2]) - f_load(from[2]);
    f_store(along[2], f_select(f_lt(f_abs(rise), few), few, rise));
    const unsigned doubtful = mf_bits(doubt);
    for (; passing; passing &= passing - 1) {
        const unsigned k = (unsigned)__builtin_ctz(passing);
        float *row = to->row[to->count];
        to->ray[to->count] = i + k;
        to->doubtful[to->count++] = doubtful >> k & 1u;
        for (int a = 0; a < 3; a++) {
            row[a] = from[a][k];
            row[4 + a] = along[a][k];
        }
    }
}

/* Gather the ways of the open rays that pass the treelet. */
static void gather_ways(heights_tile *w, const way_block *b, const heights_box *box, double slack,
                        tile_rect rect) {
    float from[3][VF_N], to[3][VF_N];
    w->ways.count = 0;
    for (unsigned y = rect.y0; y <= rect.y1; y++)
        for (unsigned x = rect.x0 & ~(VF_N - 1u); x <= rect.x1; x += VF_N) {
            const unsigned i = TILE * y + x;
            const unsigned left = (w->b.s.open[y] & row_mask(rect)) >> x & way_all(VF_N);
            unsigned passing = 0;
            for (unsigned k = 0; k < VF_N && left >> k; k += VD_N) {
                unsigned these = left >> k & ((1u << VD_N) - 1u);
                if (these)
                    these &= rays_in(w, box, i + k);
                if (these)
                    these &= cut_ways(w, b, i + k, slack, k, from, to);
                passing |= these << k;
            }
            if (passing)
                add_ways(&w->ways, b, i, passing, from, to);
        }
}

/* Take a root of ray i. */
SIMD void take_root(heights_tile *w, const heights_block *b, unsigned i, double t, uint32_t local,
                    bool entering) {
    tile_state *s = &w->b.s;
    const tile_surface found = {.t = t, .at = &b->of->head, .local = local, .entering = entering};
    if (!(t >= s->rays.t0[i] && t <= s->rays.t1[i] && t <= s->reach[i]) ||
        !tile_state_take(s, i, found))
        return;
    if (s->reach[i] < (double)INFINITY)
        look_as_far(&w->b, i);
    s->counters->roots++;
}

/* Take the roots in up to VD_N cells. */
static void take_cells(heights_tile *w, const heights_block *b, const uint32_t *cells,
                       unsigned count) {
    double x[VD_N], z[VD_N], h[4][VD_N], d[3][VD_N];
    unsigned of_ray[VD_N];
    uint32_t local[VD_N];
    patch_lanes p = {.size = b->size, .inverse = b->inverse};
    ray_lanes r;
    root_lanes roots;
    double t[2][VD_N];
    for (unsigned k = 0; k < VD_N; k++) {
        const uint32_t cell = cells[k < count ? k : 0];
        const uint32_t i = cell >> WAY_AXIS_0 & 63U, j = cell >> WAY_AXIS_2 & 63U;
        const size_t at = i + j * b->slice;
        of_ray[k] = w->ways.ray[cell & ((1U << WAY_AXIS_0) - 1U)];
        local[k] = i | j << LOCAL_LOG2;
        h[0][k] = heights_sample(b, at);
        h[1][k] = heights_sample(b, at + 1);
        h[2][k] = heights_sample(b, at + b->slice);
        h[3][k] = heights_sample(b, at + b->slice + 1);
        x[k] = (double)(b->of->first_cell[0] + i) * b->size;
        z[k] = (double)(b->of->first_cell[2] + j) * b->size;
        for (int a = 0; a < 3; a++)
            d[a][k] = w->b.s.rays.d[a][of_ray[k]];
    }
    p.x = d_load(x);
    p.z = d_load(z);
    for (int c = 0; c < 4; c++)
        p.h[c] = d_load(h[c]);
    for (int a = 0; a < 3; a++) {
        r.o[a] = d_set(w->b.eye[a]);
        r.d[a] = d_load(d[a]);
    }
    const unsigned lanes = (1u << count) - 1u;
    const unsigned visiting = heights_lanes_roots(&p, &r, &roots) & lanes;
    w->b.s.counters->cells += (unsigned)__builtin_popcount(visiting);
    if (!(roots.one & lanes))
        return;
    d_store(t[0], roots.t[0]);
    d_store(t[1], roots.t[1]);
    for (unsigned left = roots.one & lanes; left; left &= left - 1) {
        const unsigned k = (unsigned)__builtin_ctz(left);
        const bool entering = roots.entering >> k & 1u;
        take_root(w, b, of_ray[k], t[0][k], local[k], entering);
        if (roots.two >> k & 1u)
            take_root(w, b, of_ray[k], t[1][k], local[k], !entering);
    }
}

static void take_all_cells(heights_tile *w, const heights_block *b) {
    way_steps *cells = &w->ways.cells;
    for (unsigned k = 0; k < cells->count; k += VD_N)
        take_cells(w, b, cells->at + k, cells->count - k < VD_N ? cells->count - k : VD_N);
    cells->count = 0;
}

/* The most steps of a vector of ways in a node: 4 x 4 in it. */
enum { STEPS_MOST = 7 * VF_N };

static void walk_small_nodes(heights_tile *w, const way_block *b) {
    for (unsigned k = 0; k < w->ways.nodes[1].count; k += VF_N) {
        ways_in_cells(b, &w->ways, k);
        if (w->ways.cells.count > WAY_STEPS - STEPS_MOST)
            take_all_cells(w, b->b);
    }
    w->ways.nodes[1].count = 0;
}

static void walk_nodes(heights_tile *w, const way_block *b) {
    for (unsigned k = 0; k < w->ways.nodes[0].count; k += VF_N) {
        ways_in_nodes(b, &w->ways, k, &w->ways.nodes[1]);
        if (w->ways.nodes[1].count > WAY_STEPS - STEPS_MOST)
            walk_small_nodes(w, b);
    }
    w->ways.nodes[0].count = 0;
}

/* Walk the gathered ways, and then those that are in doubt, one by one. */
static void walk_ways(heights_tile *w, const way_block *b) {
    ways *of = &w->ways;
    way_steps *first = &of->nodes[b->top == 16.0f ? 0 : 1];
    of->nodes[0].count = of->nodes[1].count = of->cells.count = 0;
    for (unsigned k = 0; k < of->count; k += VF_N) {
        ways_in_treelet(b, of, k, first);
        if (of->nodes[0].count > WAY_STEPS - STEPS_MOST)
            walk_nodes(w, b);
        if (of->nodes[1].count > WAY_STEPS - STEPS_MOST)
            walk_small_nodes(w, b);
    }
    walk_nodes(w, b);
    walk_small_nodes(w, b);
    take_all_cells(w, b->b);
    for (unsigned k = 0; k < of->count; k++)
        if (of->doubtful[k])
            walk_ray(w, b->b, of->ray[k], w->t_in[of->ray[k]], w->t_out[of->ray[k]]);
}

/* Walk the open rays that pass a treelet, one by one. */
static void walk_rays(heights_tile *w, const heights_block *b, const heights_box *box,
                      tile_rect rect) {
    for (unsigned y = rect.y0; y <= rect.y1; y++)
        for (unsigned x = rect.x0 & ~(VD_N - 1u); x <= rect.x1; x += VD_N) {
            const unsigned i = TILE * y + x;
            unsigned left = rays_in(w, box, i) & (w->b.s.open[y] & row_mask(rect)) >> x;
            for (; left; left &= left - 1) {
                const unsigned k = i + (unsigned)__builtin_ctz(left);
                walk_ray(w, b, k, w->t_in[k], w->t_out[k]);
            }
        }
}

__attribute__((noinline)) static void visit_treelet(heights_tile *w, const tile_pending *p) {
    const tracer *tr = w->b.s.f->tracer;
    way_block b;
    if (!w->b.s.has_rays) {
        tile_state_rays(&w->b.s);
        look_with_open(&w->b);
    }
    const treelet *at = loader_lookup(tr->treelets, p->i);
    if (!at) {
        await_treelet(w, p);
        return;
    }
    tracer_touch(tr, p->i); /* judged by rectangles alone */
    const heights_block of = heights_block_of(tr, at);
    const double slack = of.slack + 0x1p-40 * fabs(w->b.eye[1]);
    const heights_box box = box_of_cells(&of);
    if (!way_block_of(&of, w->b.eye, slack, &b)) {
        walk_rays(w, &of, &box, p->rect);
        return;
    }
    gather_ways(w, &b, &box, slack, p->rect);
    walk_ways(w, &b);
}

/* ---- The directory ---- */

static bool is_drawn(const tracer *tr, uint32_t t) {
    return tr->layout->level_of[t] == tr->target_level || (tr->stop && tr->stop[t]);
}

enum { PENDING_MAX = 3 * LEAF_LEVELS_MAX + 4 };

static int push_children(heights_tile *w, const tile_pending *p, tile_pending *stack, int top) {
    const tracer *tr = w->b.s.f->tracer;
    const leaf_layout *l = tr->layout;
    const float(*ranges)[2] =
        (const float(*)[2])tr->treelets->file->ranges + leaf_layout_samples(l, tr->set, 0);
    const unsigned active = tr->treelets->children[p->i];
    unsigned there = leaf_layout_children(l, p->i), count = 0, of[4];
    near_boxes b;
    box_rects boxes;
    float near2[4];
    for (unsigned n = 0; there; there &= there - 1, n++) {
        const unsigned o = (unsigned)__builtin_ctz(there);
        const uint32_t t = l->first_child[p->i] + n;
        if (!(active >> o & 1u))
            continue;
        const heights_box box = box_of(tr, t, ranges[t]);
        near2[count] = 0.0f;
        for (int a = 0; a < 3; a++) {
            b.lo[a][count] = (float)(box.lo[a] - w->b.eye[a]);
            b.hi[a][count] = (float)(box.hi[a] - w->b.eye[a]);
            const float out = fmaxf(fmaxf(b.lo[a][count], -b.hi[a][count]), 0.0f);
            near2[count] += w->unit2[a] * out * out;
        }
        of[count++] = t;
    }
    leave_idle(&b, count);
    w->b.s.counters->nodes++;
    rects_of_boxes(&w->b, &b, &p->rect, &boxes);
    memcpy(boxes.near2, near2, sizeof near2);
    const int bottom = top;
    top = push_boxes(&boxes, boxes.rects.alive & ((1u << count) - 1u), stack, top);
    for (int k = bottom; k < top; k++)
        stack[k].i = of[stack[k].i];
    return top;
}

static void walk_directory(heights_tile *w, tile_rect rect) {
    const tracer *tr = w->b.s.f->tracer;
    tile_pending stack[PENDING_MAX];
    int top = 0;
    stack[top++] = (tile_pending){0, 0, rect, 0.0f};
    while (top > 0) {
        const tile_pending p = stack[--top];
        if (!in_sight(&w->b, p.rect, p.near2))
            continue;
        if (!is_drawn(tr, p.i)) {
            top = push_children(w, &p, stack, top);
        } else if (tr->treelets->own[p.i]) {
            visit_treelet(w, &p);
        }
    }
}

/* Leave all pixels to single rays. */
static void leave_tile(const tile_row asked[], tile_outcome *out) {
    out->absent_count = 0;
    for (unsigned y = 0; y < TILE; y++) {
        out->open[y] = asked[y];
        out->waits[y] = 0;
    }
}

void SIMD_NAME(heights_tile)(const frame *f, uint32_t x0, uint32_t y0, const tile_row asked[],
                             tile_outcome *out, ray_counters *counters);

void SIMD_NAME(heights_tile)(const frame *f, uint32_t x0, uint32_t y0, const tile_row asked[],
                             tile_outcome *out, ray_counters *counters) {
    const heights_field *field = f->tracer->own;
    heights_tile *w = out->scratch;
    if (f->tracer->preview || f->tracer->lenient) { /* other treelets may stand in */
        leave_tile(asked, out);
        return;
    }
    tile_boxes_begin(&w->b, f, &cell_order, x0, y0, asked, out, counters);
    for (int a = 0; a < 3; a++)
        w->unit2[a] = (float)(field->unit[a] * field->unit[a]);
    do {
        walk_directory(w, tile_boxes_again(&w->b));
        shade_walk(&w->b.s, &shading, w, &w->pixels);
    } while (tile_state_again(&w->b.s, TILE_LAYERS, w->pixels.rgba[3]));
    shade_behind_all(f, &w->pixels);
    write_tile(&w->b.s, &w->pixels);
}

#endif
#endif
