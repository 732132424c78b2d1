/* flat_batch_template.h - a batch of rays through a volume whose cells have flat polygons; included
 * by the units of an ISA (see formats/base/simd.h).
 *
 * Rays of one octant of directions go together, sorted so that neighbours are side by side. They
 * form FLAT_BEAMS beams at a time. A beam is an interval of origins and an interval of directions
 * per axis. It has as many consecutive rays as keep it narrow, or a single ray if rays have nothing
 * in common. The tree over the treelets, and what is in them, are walked once for all beams, near
 * children first. Each node has a bit for each beam that may meet it. Active cells are taken a
 * vector at a time. Beams are tested against the boxes around their polygons, then rays against the
 * edge functions, in single precision. All these tests are conservative; the bounds are stated
 * where they are used. The remaining rays go to flat_rays_template.h. So a ray's answer equals the
 * answer of single rays, to the bit.
 *
 * A ray that looks for any hit takes any. So it may find one where a single ray, which takes
 * treelets in order, would wait for an absent treelet.
 *
 * Deviation from W07 5: the packets there have one eye, and are not split. Here no ray visits a box
 * that only other rays meet. Rays without coherence share nodes, boxes and polygons once these are
 * fetched or made.
 *
 * The kind's unit defines what flat_batch_cells_template.h declares of it, and calls walk_batch().
 */
#ifndef RENDER_FLAT_FLAT_BATCH_TEMPLATE_H
#define RENDER_FLAT_FLAT_BATCH_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/flat/flat_batch_cells_template.h"
#include "stream/treelet_tree.h"

/* What is still to be visited, and the beams that may meet it: a node of a tree, of its level or,
 * if nodes have no levels, of 0. */
typedef struct batch_pending {
    uint32_t level, i, beams;
} batch_pending;

enum { BATCH_TREE_STACK = TREELET_TREE_LEVELS_MAX * TREELET_TREE_ARITY };

/* ---- Nodes ---- */

/* Push children and their beams, the nearest last. */
SIMD int push_boxes(const flat_batch *w, const beam_boxes *b, unsigned left,
                    const uint32_t beams[BEAM_BOXES], batch_pending *stack, int top) {
    const int bottom = top;
    float near[MESH_CHILDREN];
    for (; left; left &= left - 1) {
        const unsigned c = (unsigned)__builtin_ctz(left);
        float key = 0.0f;
        for (int a = 0; a < 3; a++)
            key += w->along[a] * b->lo[a][c];
        int at = top++;
        for (; at > bottom && near[at - 1 - bottom] < key; at--) {
            stack[at] = stack[at - 1];
            near[at - bottom] = near[at - 1 - bottom];
        }
        near[at - bottom] = key;
        stack[at] = (batch_pending){0, c, beams[c]};
    }
    return top;
}

/* Fill lanes without a box with harmless numbers. */
SIMD void leave_idle(beam_boxes *b, unsigned from) {
    for (int a = 0; a < 3; a++)
        for (unsigned c = from; c < BEAM_BOXES; c++)
            b->lo[a][c] = b->hi[a][c] = 0.0f;
}

/* Open a node of a tree. Children get their number in their level. */
static int open_family(flat_batch *w, const treelet_tree *tree, const batch_pending *p,
                       batch_pending *stack, int top) {
    const beam_frame *f = &w->frame;
    uint32_t count, first = treelet_tree_children(tree, p->level, p->i, &count);
    uint32_t wanted[BEAM_BOXES], met[BEAM_BOXES];
    unsigned active = 0;
    beam_boxes b;
    w->counters->nodes++;
    for (uint32_t c = 0; c < count; c++) {
        const float *bounds = tree->bounds[p->level - 1][first + c];
        wanted[c] = p->beams;
        active |= (unsigned)tree->active[p->level - 1][first + c] << c;
        for (int a = 0; a < 3; a++) {
            const bool back = f->sign[a] < 0.0;
            const double scale = f->scale * f->sign[a];
            const double lo = ((double)bounds[back ? a + 3 : a] - f->centre[a]) * scale;
            const double hi = ((double)bounds[back ? a : a + 3] - f->centre[a]) * scale;
            b.lo[a][c] = (float)lo - f->slack[a];
            b.hi[a][c] = (float)hi + f->slack[a];
        }
    }
    leave_idle(&b, count);
    const unsigned left = meet_boxes(&w->beams, &b, active, p->beams, wanted, met);
    const int bottom = top;
    top = push_boxes(w, &b, left, met, stack, top);
    for (int k = bottom; k < top; k++) {
        stack[k].i += first;
        stack[k].level = p->level - 1;
    }
    return top;
}

/* Walk a tree for some beams, from its root: visit() its active leaves. */
SIMD void walk_beams_through(flat_batch *w, const treelet_tree *tree, uint32_t beams,
                             void (*visit)(flat_batch *w, const void *ctx, uint32_t i,
                                           uint32_t beams),
                             void (*ahead)(flat_batch *w, uint32_t i), const void *ctx) {
    batch_pending stack[BATCH_TREE_STACK];
    int top = 0;
    if (tree->active[tree->levels - 1][0])
        stack[top++] = (batch_pending){tree->levels - 1, 0, beams};
    while (top > 0) {
        batch_pending p = stack[--top];
        p.beams &= w->alive;
        if (!p.beams)
            continue;
        if (p.level == 0) {
            visit(w, ctx, p.i, p.beams);
            continue;
        }
        const int bottom = top;
        top = open_family(w, tree, &p, stack, top);
        for (int k = bottom; k < top && ahead && p.level == 1; k++)
            ahead(w, stack[k].i);
    }
}

/* ---- Treelets ---- */

/* Note the t at which each ray, walked as a single ray, would enter an absent treelet. It need not
 * look behind that. */
static void wait_for_treelet(flat_batch *w, uint32_t t, uint32_t beams) {
    const treelet_tree *tree = w->tr->treelets->tree;
    const float *bounds = tree->bounds[0][t];
    const double lo[3] = {bounds[0], bounds[1], bounds[2]};
    const double hi[3] = {bounds[3], bounds[4], bounds[5]};
    uint64_t rays[RAY_WORDS];
    (void)rays_of_beams(w, beams, rays);
    for (unsigned i = 0; i < w->count; i++) {
        if (!(rays[i / 64] >> i % 64 & 1u))
            continue;
        const ray *r = &w->b->rays[w->of[i]];
        const box_line slabs = box_line_of(r);
        const double behind =
            box_interval_behind(tree->bounds[tree->levels - 1][0], r, &w->rays.after[i]);
        box_interval in;
        if (!box_interval_in(&slabs, lo, hi, &in) || in.t_out < behind || !(in.t_in < w->wait[i]))
            continue;
        w->wait[i] = in.t_in;
        w->rays.to[i] = in.t_in < w->rays.to[i] ? in.t_in : w->rays.to[i];
        look_up_to(&w->in_frame, (int)i, in.t_in);
        beam_sees(w, i);
    }
}

static void visit_resident(flat_batch *w, const void *ctx, uint32_t t, uint32_t beams) {
    const treelet *at = loader_lookup(w->tr->treelets, t);
    (void)ctx;
    if (!at) {
        wait_for_treelet(w, t, beams);
        return;
    }
    tracer_touch(w->tr, t); /* judged by boxes alone */
    batch_treelet(w, at, beams);
}

static void queue_resident(flat_batch *w, uint32_t t) {
    loader_prefetch(w->tr->treelets, t);
}

/* ---- Groups ---- */

/* Rays form beams as long as beams are narrow compared with cells of average size. The value was
 * chosen by counts of visits, on one and eight bucky balls. */
static const double NARROW = 1.4;

/* Make beams of the rays from `from` on, as many as there is room for. Returns the first ray that
 * is in none. */
static unsigned make_beams(flat_batch *w, unsigned from) {
    const float cell = (float)(NARROW * 2.0 / batch_cells_across(w));
    const float slack = generosity(&w->in_frame, w->count);
    unsigned beams = 0, at = from;
    for (; at < w->count; at += VF_N) {
        const block_lanes b = best_blocks(&w->in_frame, at, w->axis, cell);
        uint8_t share[VF_N];
        const unsigned heads = heads_of_blocks(&b, share);
        if (beams + (unsigned)__builtin_popcount(heads) > FLAT_BEAMS)
            break;
        f_store(w->in_frame.back + at, b.back);
        put_blocks(&w->beams, beams, &b, heads, slack);
        for (unsigned left = heads; left; left &= left - 1, beams++) {
            const unsigned k = (unsigned)__builtin_ctz(left);
            w->first[beams] = (uint8_t)(at + k);
            w->share[beams] = share[k];
            memset(w->beam_of + at + k, (int)beams, share[k]);
        }
    }
    w->alive = (uint32_t)((UINT64_C(1) << beams) - 1);
    for (unsigned beam = beams; beam < FLAT_BEAMS; beam++)
        empty_beam(&w->beams, beam);
    return at;
}

static void put_ray(flat_batch *w, unsigned k) {
    const unsigned i = w->count++;
    const trace_state *s = &w->b->states[k];
    flat_rays_put(&w->rays, (int)i, &w->b->rays[k], &s->after);
    w->rays.best[i] = s->best;
    w->rays.to[i] = s->best.t < w->rays.to[i] ? s->best.t : w->rays.to[i];
    w->of[i] = (uint8_t)k;
    w->any[i] = s->any;
    w->origin[i] = s->origin;
    w->origin_iso[i] = s->origin_iso;
    w->wait[i] = INFINITY;
    w->at[i] = NULL;
}

/* Sum the directions of some of a group's rays, and find the axis that they go along most. */
static void sum_directions(flat_batch *w, const uint8_t rays[], unsigned count) {
    const unsigned step = 1 + count / 16;
    double sum[3] = {0.0, 0.0, 0.0};
    for (unsigned i = 0; i < count; i += step) {
        const double *d = w->b->rays[rays[i]].d;
        const double size = 1.0 / (fabs(d[0]) + fabs(d[1]) + fabs(d[2]));
        for (int a = 0; a < 3; a++)
            sum[a] += fabs(d[a]) * size;
    }
    w->axis = sum[1] > sum[0];
    w->axis = sum[2] > sum[w->axis] ? 2 : w->axis;
    for (int a = 0; a < 3; a++)
        w->along[a] = (float)sum[a];
}

/* A number per ray, padded to whole vectors. */
typedef struct ray_numbers {
    _Alignas(64) float of[RAY_BATCH];
} ray_numbers;

/* Project the origins of rays along the sum of their directions, onto two of the axes. Add each
 * ray's own direction, so that rays of one origin get different points. */
static void project_rays(const flat_batch *w, const uint8_t rays[], unsigned count,
                         ray_numbers at[2]) {
    const beam_frame *f = &w->frame;
    const int z = w->axis, x = (z + 1) % 3, y = (z + 2) % 3;
    const double slope[2] = {(double)(w->along[x] / w->along[z]) * f->sign[x] * f->sign[z],
                             (double)(w->along[y] / w->along[z]) * f->sign[y] * f->sign[z]};
    for (unsigned i = 0; i < count; i++) {
        const ray *r = &w->b->rays[rays[i]];
        const double size = 1.0 / (fabs(r->d[0]) + fabs(r->d[1]) + fabs(r->d[2]));
        at[0].of[i] = (float)((r->o[x] - slope[0] * r->o[z]) * f->scale + r->d[x] * size);
        at[1].of[i] = (float)((r->o[y] - slope[1] * r->o[z]) * f->scale + r->d[y] * size);
    }
    for (unsigned i = count; i % VF_N; i++)
        for (int k = 0; k < 2; k++)
            at[k].of[i] = at[k].of[0];
}

/* Scale the numbers so that they go from 0 to 15.99. */
static void in_sixteenths(ray_numbers *x, unsigned count) {
    vf lo = f_load(x->of), hi = lo;
    for (unsigned i = VF_N; i < count; i += VF_N) {
        lo = f_min(lo, f_load(x->of + i));
        hi = f_max(hi, f_load(x->of + i));
    }
    for (unsigned by = 1; by < VF_N; by *= 2) {
        lo = f_min(lo, f_swap(lo, by));
        hi = f_max(hi, f_swap(hi, by));
    }
    const vf per = f_select(f_gt(hi, lo), f_set(15.99f) / (hi - lo), f_set(0.0f));
    for (unsigned i = 0; i < count; i += VF_N)
        f_store(x->of + i, (f_load(x->of + i) - lo) * per);
}

/* Spread the bits of numbers below 16 to every other bit. */
SIMD vi spread_bits(vi n) {
    n = (n | n << 2) & 0x33;
    return (n | n << 1) & 0x55;
}

/* Compute the places of points on a Morton curve. */
static void curve_keys(ray_numbers at[2], unsigned count, int32_t key[RAY_BATCH]) {
    in_sixteenths(&at[0], count);
    in_sixteenths(&at[1], count);
    for (unsigned i = 0; i < count; i += VF_N) {
        const vi x = f_to_int(f_load(at[0].of + i)), y = f_to_int(f_load(at[1].of + i));
        const vi k = (spread_bits(x) | spread_bits(y) << 1) & 255;
        memcpy(key + i, &k, sizeof k);
    }
}

/* Sort a group's rays by curve_keys(), so that beams are made of neighbours. */
static void sort_rays(const flat_batch *w, uint8_t rays[], unsigned count) {
    ray_numbers at[2];
    int32_t key[RAY_BATCH];
    uint8_t from[RAY_BATCH];
    uint16_t begins[257] = {0};
    project_rays(w, rays, count, at);
    curve_keys(at, count, key);
    for (unsigned i = 0; i < count; i++)
        begins[key[i] + 1]++;
    for (unsigned k = 1; k < 257; k++)
        begins[k] = (uint16_t)(begins[k] + begins[k - 1]);
    memcpy(from, rays, count);
    for (unsigned i = 0; i < count; i++)
        rays[begins[key[i]]++] = from[i];
}

static void gather_octant(flat_batch *w, unsigned octant) {
    uint8_t rays[RAY_BATCH];
    unsigned count = 0;
    for (unsigned k = 0; k < w->b->count; k++)
        if (!w->alone[k] && w->octant[k] == octant)
            rays[count++] = (uint8_t)k;
    for (int a = 0; a < 3; a++)
        w->frame.sign[a] = octant >> a & 1u ? -1.0 : 1.0;
    sum_directions(w, rays, count);
    if (count > FLAT_BEAMS)
        sort_rays(w, rays, count);
    w->count = 0;
    for (unsigned i = 0; i < count; i++)
        put_ray(w, rays[i]);
    for (unsigned i = count; i % 16; i++)
        flat_rays_clear(&w->rays, (int)i);
    for (unsigned i = 0; i < count; i += VD_N)
        put_in_frame(&w->frame, &w->rays, (int)i, &w->in_frame);
    for (unsigned i = count; i % 16; i++)
        w->in_frame.far[i] = -1.0f;
}

/* Write the result of ray i of the group. If an absent treelet may hold a nearer hit, trace the ray
 * anew as a single ray. */
static void answer(flat_batch *w, unsigned i) {
    const unsigned k = w->of[i];
    trace_state *s = &w->b->states[k];
    const hit *best = &w->rays.best[i];
    const bool found = w->at[i] != NULL;
    if (!(found && w->any[i]) && w->wait[i] < INFINITY && w->wait[i] <= best->t) {
        ray_batch_single(w->tr, w->b, k, w->counters);
        return;
    }
    if (found) {
        s->best = *best;
        if (!s->any)
            s->point = batch_point(w, w->at[i], &w->b->rays[k], best);
    }
    w->b->results[k] = hit_exists(&s->best) ? TRACE_HIT : TRACE_MISS;
}

static void walk_group(flat_batch *w) {
    memset(w->looks, 0, sizeof w->looks);
    for (unsigned i = 0; i < w->count; i++)
        w->looks[i / 64] |= (uint64_t)(w->in_frame.far[i] >= 0.0f) << i % 64;
    for (unsigned first = 0; first < w->count;) {
        first = make_beams(w, first);
        walk_beams_through(w, w->tr->treelets->tree, w->alive, visit_resident, queue_resident,
                           NULL);
    }
}

/* ---- Batches ---- */

/* Returns whether to trace a ray as a single ray: it does not fit into the frame, was blocked
 * before, or can have no hit. */
static bool goes_alone(const beam_frame *f, const ray *r, const trace_state *s) {
    double largest = 0.0;
    bool near = s->blocked == LEAF_NO_TREELET && r->t0 <= r->t1 && r->t0 <= s->best.t &&
                s->after.t <= r->t1 && s->after.t <= s->best.t;
    for (int a = 0; a < 3; a++) {
        near &= fabs(r->o[a] - f->centre[a]) * f->scale <= FARTHEST;
        near &= fabs(r->d[a]) <= 0x1p200;
        largest = fabs(r->d[a]) > largest ? fabs(r->d[a]) : largest;
    }
    return !near || !(largest >= 0x1p-200);
}

/* Trace a batch. What of *w the kind needs is set. front_first: as in flat_rays. */
SIMD void walk_batch(flat_batch *w, const tracer *tr, ray_batch *b, bool front_first,
                     ray_counters *counters) {
    const treelet_tree *tree = tr->treelets->tree;
    unsigned octants = 0;
    w->tr = tr;
    w->b = b;
    w->counters = counters;
    w->rays.front_first = front_first;
    w->cells.any = 0;
    w->cells.count = 0;
    const bool together =
        !tr->preview && frame_of_bounds(tree->bounds[tree->levels - 1][0], &w->frame);
    for (unsigned i = 0; i < b->count; i++) {
        const ray *r = &b->rays[i];
        w->alone[i] = !together || goes_alone(&w->frame, r, &b->states[i]);
        w->octant[i] = (uint8_t)((r->d[0] < 0.0) | (r->d[1] < 0.0) << 1 | (r->d[2] < 0.0) << 2);
        if (w->alone[i])
            ray_batch_single(tr, b, i, counters);
        else
            octants |= 1u << w->octant[i];
    }
    for (; octants; octants &= octants - 1) {
        gather_octant(w, (unsigned)__builtin_ctz(octants));
        walk_group(w);
        for (unsigned i = 0; i < w->count; i++)
            answer(w, i);
    }
}

#endif
#endif
