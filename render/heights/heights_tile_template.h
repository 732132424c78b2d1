/* heights_tile_template.h - heights_tile_X() of heights_tile.h; included by the units of an ISA
 * (see formats/base/simd.h). */
#ifndef RENDER_HEIGHTS_HEIGHTS_TILE_TEMPLATE_H
#define RENDER_HEIGHTS_HEIGHTS_TILE_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/heights/heights_tile.h"
#include "render/heights/heights_way.h"

enum { TILE = HEIGHTS_TILE, TILE_WINDOWS = 0 };

#include "render/tile/tile_boxes_template.h"
#include "render/tile/tile_shade_template.h"

typedef struct heights_tile {
    tile_boxes b;
    float unit2[3]; /* squares of the world lengths of grid units */
    tile_pixels pixels;
} heights_tile;
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
    heights_block b;
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
SIMD unsigned rays_in(const heights_tile *w, const heights_box *b, unsigned i, double t_in[VD_N],
                      double t_out[VD_N]) {
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
    d_store(t_in, in);
    d_store(t_out, out);
    return md_bits(md_and_not(d_le(in, out), beside)) & ((1u << VD_N) - 1u);
}

/* Suspend rays that pass an absent treelet. */
static void wait_for(heights_tile *w, uint32_t t, unsigned y, unsigned passing, bool *any) {
    w->b.s.out->waits[y] |= (tile_row)passing;
    w->b.s.open[y] &= ~(tile_row)passing;
    if (passing && !*any)
        tile_absent(w->b.s.out, t, 0);
    *any = *any || passing;
}

/* Rays that are in a treelet: which of each row, and where. */
typedef struct heights_visit {
    tile_row rows[TILE];
    double t_in[TILE * TILE], t_out[TILE * TILE];
} heights_visit;

/* Ask for what a ray reads where it is at a treelet's mean elevation. */
static void ask_for(const heights_tile *w, const heights_block *b, unsigned i, double t_in,
                    double t_out) {
    const tile_rays *rays = &w->b.s.rays;
    const double middle = 0.5 * (b->range[0] + b->range[1]);
    const double there = (middle - w->b.eye[1]) / rays->d[1][i];
    const double t = heights_least(heights_most(there, t_in), t_out);
    uint32_t cell[2];
    for (int axis = 0; axis < 2; axis++) {
        const double x = (w->b.eye[2 * axis] + t * rays->d[2 * axis][i]) * b->inverse -
                         (double)b->of->first_cell[2 * axis];
        const double last = (double)(b->of->shape.cells[2 * axis] - 1);
        cell[axis] = (uint32_t)heights_least(heights_most(x, 0.0), last);
    }
    heights_way_ask(b, cell[0], cell[1]);
}

static void visit_treelet(heights_tile *w, const tile_pending *p) {
    const tracer *tr = w->b.s.f->tracer;
    const heights_box box = box_of(tr, p->i, tracer_range(tr, p->i));
    heights_visit v;
    heights_block b;
    bool waits = false;
    if (!w->b.s.has_rays) {
        tile_state_rays(&w->b.s);
        look_with_open(&w->b);
    }
    const treelet *at = loader_lookup(tr->treelets, p->i);
    if (at) {
        tracer_touch(tr, p->i); /* judged by rectangles alone */
        b = heights_block_of(tr, at);
    }
    for (unsigned y = p->rect.y0; y <= p->rect.y1; y++) {
        v.rows[y] = 0;
        for (unsigned x = p->rect.x0 & ~(VD_N - 1u); x <= p->rect.x1; x += VD_N) {
            const unsigned i = TILE * y + x;
            unsigned left = (w->b.s.open[y] & row_mask(p->rect)) >> x & ((1u << VD_N) - 1u);
            if (left)
                left &= rays_in(w, &box, i, v.t_in + i, v.t_out + i);
            v.rows[y] |= (tile_row)(left << x);
            for (; at && left; left &= left - 1) {
                const unsigned k = i + (unsigned)__builtin_ctz(left);
                ask_for(w, &b, k, v.t_in[k], v.t_out[k]);
            }
        }
        if (!at)
            wait_for(w, p->i, y, v.rows[y], &waits);
    }
    for (unsigned y = p->rect.y0; at && y <= p->rect.y1; y++)
        for (unsigned left = v.rows[y]; left; left &= left - 1) {
            const unsigned i = TILE * y + (unsigned)__builtin_ctz(left);
            walk_ray(w, &b, i, v.t_in[i], v.t_out[i]);
        }
    if (waits)
        look_with_open(&w->b);
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
