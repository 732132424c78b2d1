/* grid_extreme_cells_template.h - ray-cells in a search for extremes in a grid
 * (grid_extreme_batch.h): which may matter, and what is in them; included by the units of an ISA
 * (see formats/base/simd.h).
 */
#ifndef RENDER_GRID_GRID_EXTREME_CELLS_TEMPLATE_H
#define RENDER_GRID_GRID_EXTREME_CELLS_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/grid/cell_visit_template.h"
#include "render/grid/grid_extreme.h"
#include "render/grid/grid_ray_cells_template.h"
#include "render/ray/extreme_batch.h"
#include "stream/grid_resident.h"

/* What rays have found, by their places, in single precision for the tests of nodes and cells.
 * Scores are rounded down. If a score did not change by that, an equal score matters up to `t`,
 * which is counted as in grid_rays and rounded up. If it did, an equal score does not matter: t is
 * -INFINITY. */
typedef struct best_scores {
    float score[RAY_BATCH + 1], t[RAY_BATCH + 1]; /* the last one is no ray's */
} best_scores;

/* Ray-cells, one a lane, on their way to the filter. Lanes of one cell lie beside each other. The
 * numbers of a cell are stored by whole vectors from its first lane on. They reach beyond its
 * lanes, until the next cell overwrites them. */
typedef struct cell_queue {
    float lo[3][2 * VF_N], hi[3][2 * VF_N], inv[3][2 * VF_N]; /* planes, from the middle on */
    float samples[8][2 * VF_N];
    uint32_t ray[VF_N]; /* the ray's place */
    uint8_t cell[VF_N]; /* number of its cell, of these: */
    const resident_grid *at[VF_N];
    uint32_t cells[VF_N][3];
    unsigned count, cell_count;
} cell_queue;

/* Ray-cells to be computed. */
typedef struct peak_batch {
    cell_batch cells;
    unsigned count;
    uint8_t ray[CELL_BATCH]; /* the ray's place */
    uint32_t treelet[CELL_BATCH];
    _Alignas(64) double score[CELL_BATCH]; /* the ray's score when the lane was filled */
} peak_batch;

typedef struct extreme_cells {
    const walk_scene *scene;
    extreme_batch *b;
    grid_rays rays;
    bool least; /* looks for the least values; sign: of scores, -1 for the least */
    float sign;
    ray_set level;               /* have a direction component of 0 */
    best_scores found, in_block; /* in_block: the same by slots */
    uint16_t slot[RAY_BATCH];    /* a ray's slot while a block is searched; RAY_BATCH: none */
    cell_queue queue;
    peak_batch batch;
} extreme_cells;

SIMD const ray *peak_ray(const extreme_cells *p, unsigned i) {
    return &p->b->rays[p->rays.ray[i]];
}

SIMD extreme_state *peak_state(const extreme_cells *p, unsigned i) {
    return p->b->state[p->rays.ray[i]];
}

/* ---- What has been found ---- */

/* update_best() - updates what ray i has found. */
static void update_best(extreme_cells *p, unsigned i) {
    const extreme_state *s = peak_state(p, i);
    float score = (float)s->score, t = -INFINITY;
    if ((double)score > s->score)
        score -= fabsf(score) * 0x1p-23f + 0x1p-149f;
    if (extreme_found(s) && (double)score == s->score) {
        t = (float)(s->t - p->rays.t_in[i]) * (1.0f + 4.0f * UNIT);
        t = t > 0.0f ? t : 0.0f;
    }
    p->found.score[i] = p->in_block.score[p->slot[i]] = score;
    p->found.t[i] = p->in_block.t[p->slot[i]] = t;
}

/* peak_cells_enter() - give ray i a slot. peak_cells_leave() - take its slot away. */
SIMD void peak_cells_enter(extreme_cells *p, unsigned i, unsigned slot) {
    p->slot[i] = (uint16_t)slot;
    p->in_block.score[slot] = p->found.score[i];
    p->in_block.t[slot] = p->found.t[i];
}
SIMD void peak_cells_leave(extreme_cells *p, unsigned i) {
    p->slot[i] = RAY_BATCH;
}

/* may_improve() - returns which of the VF_N rays from `at` on are interested in scores up to
 * `bound` from t_in on. */
SIMD mf may_improve(const best_scores *found, unsigned at, vf bound, vf t_in) {
    const vf score = f_load(found->score + at);
    const mf before = f_le(t_in, f_load(found->t + at));
    return mf_or(f_gt(bound, score), mf_and(f_eq(bound, score), before));
}

/* ---- In double ---- */

/* The greatest, or the least, value of a cubic, and the parameter where it comes first:
 * segment_range(). */
typedef struct cubic_peak {
    vd value, at;
} cubic_peak;

SIMD vd cubic_value(const vd b[4], vd s) {
    const vd b01 = mix(b[0], b[1], s), b12 = mix(b[1], b[2], s), b23 = mix(b[2], b[3], s);
    return mix(mix(b01, b12, s), mix(b12, b23, s), s);
}

SIMD void offer_value(cubic_peak *best, vd value, vd at, md there, vd sign) {
    const md better = md_and(there, d_gt(value * sign, best->value * sign));
    best->value = d_select(better, value, best->value);
    best->at = d_select(better, at, best->at);
}

/* Returns the extreme value over cubic_extrema() and the ends. */
SIMD cubic_peak cubic_peak_of(const vd b[4], vd sign) {
    const vd zero = d_set(0.0), one = d_set(1.0), none = d_set(-1.0);
    const vd q0 = b[1] - b[0], q1 = b[2] - b[1], q2 = b[3] - b[2];
    const vd half_b = q1 - q0, a = (q2 - q1) - half_b, discriminant = q1 * q1 - q0 * q2;
    const vd root = d_sqrt(d_max(discriminant, zero));
    const vd w = d_set(-0.0) - (half_b + d_select(d_ge(half_b, zero), root, d_set(-0.0) - root));
    const vd of_a = d_select(d_eq(a, zero), none, w / a);
    const vd of_w = d_select(d_eq(w, zero), none, q0 / w);
    const md swapped = d_lt(of_w, of_a), real = d_ge(discriminant, zero);
    const vd s0 = d_select(swapped, of_w, of_a), s1 = d_select(swapped, of_a, of_w);
    cubic_peak best = {b[0], zero};
    offer_value(&best, cubic_value(b, s0), s0, md_and(real, md_and(d_gt(s0, zero), d_lt(s0, one))),
                sign);
    offer_value(&best, cubic_value(b, s1), s1, md_and(real, md_and(d_gt(s1, zero), d_lt(s1, one))),
                sign);
    offer_value(&best, b[3], one, md_of_bits(~0u), sign);
    return best;
}

/* Returns a bound of the score: a cubic stays within its control values, except for rounding. */
SIMD vd most_control(const vd b[4], vd sign) {
    vd most = b[0] * sign, size = d_abs(b[0]);
    for (int i = 1; i < 4; i++) {
        most = d_max(most, b[i] * sign);
        size = d_max(size, d_abs(b[i]));
    }
    return most + d_set(0x1p-47) * size;
}

SIMD void take_scores(extreme_cells *p, int at, unsigned lanes, vd score, vd t) {
    double scores[VD_N], ts[VD_N];
    d_store(scores, score);
    d_store(ts, t);
    for (; lanes; lanes &= lanes - 1) {
        const unsigned k = (unsigned)__builtin_ctz(lanes), i = p->batch.ray[(unsigned)at + k];
        extreme_state *s = peak_state(p, i);
        if (!extreme_matters(s, scores[k], ts[k]))
            continue;
        extreme_offer(s, scores[k], ts[k], p->batch.treelet[(unsigned)at + k]);
        update_best(p, i);
    }
}

/* Compute the extremes of a vector of ray-cells. */
SIMD void compute_scores(extreme_cells *p, int at, unsigned lanes) {
    const cell_batch *cells = &p->batch.cells;
    const vd sign = d_set((double)p->sign), before = d_load(p->batch.score + at);
    visits v;
    vd f[8], b[4], most = d_of_floats(cells->samples[0] + at) * sign;
    const md visited = visits_of(cells, at, &v);
    for (int i = 0; i < 8; i++) {
        f[i] = d_of_floats(cells->samples[i] + at);
        most = d_max(f[i] * sign, most);
    }
    cubic(&v, f, b);
    const md there = md_and(md_and(visited, d_lt(v.t_in, v.t_out)),
                            d_ge(d_min(most, most_control(b, sign)), before));
    lanes &= md_bits(there);
    if (!lanes)
        return;
    const cubic_peak peak = cubic_peak_of(b, sign);
    const vd score = d_min(peak.value * sign, most);
    const vd line = d_min(v.t_in + peak.at * (v.t_out - v.t_in), v.t_out);
    const vd inside = d_select(d_gt(peak.at, d_set(0.0)), line, v.t_in); /* keeps t_in = -0 */
    const vd t = d_select(d_lt(peak.at, d_set(1.0)), inside, v.t_out);
    take_scores(p, at, lanes & md_bits(d_ge(score, before)), score, t);
}

static void peak_batch_flush(extreme_cells *p) {
    const unsigned count = p->batch.count;
    p->batch.count = 0;
    for (unsigned at = 0; at < count; at += VD_N)
        compute_scores(p, (int)at, count - at < VD_N ? (1u << (count - at)) - 1u : ~0u);
}

static void peak_batch_add(extreme_cells *p, const resident_grid *at, const uint32_t cell[3],
                           const float samples[8], unsigned i) {
    peak_batch *b = &p->batch;
    const level_planes *planes = &p->scene->levels[at->level];
    const ray *r = peak_ray(p, i);
    if (ray_set_has(&p->level, i) &&
        !cell_batch_along(planes, r, cell, p->rays.t_in[i], p->rays.t_out[i])) {
        if (grid_extreme_cell(p->scene, at, r, cell, samples, peak_state(p, i)))
            update_best(p, i);
        return;
    }
    const unsigned k = b->count++;
    cell_batch_put(&b->cells, k, planes, r, cell, samples);
    b->ray[k] = (uint8_t)i;
    b->treelet[k] = at->head.id;
    b->score[k] = peak_state(p, i)->score;
    if (b->count == CELL_BATCH)
        peak_batch_flush(p);
}

/* ---- In single precision ---- */

/* Returns the lanes whose greatest control value may reach what their rays have found. Scores less
 * the found score are as exact as samples less an isovalue, so may_cross()'s proof holds. */
SIMD unsigned queue_may_matter(const extreme_cells *p) {
    const cell_queue *q = &p->queue;
    float found[VF_N] = {0};
    vf f[8], b[4], lo[3], hi[3], inv[3];
    for (int a = 0; a < 3; a++) {
        lo[a] = f_load(q->lo[a]);
        hi[a] = f_load(q->hi[a]);
        inv[a] = f_load(q->inv[a]);
    }
    const ray_visits v = ray_visits_of(&p->rays, q->ray, lo, hi, inv);
    for (unsigned k = 0; k < q->count; k++)
        found[k] = p->found.score[q->ray[k]];
    for (int s = 0; s < 8; s++)
        f[s] = f_load(q->samples[s]) - f_load(found);
    const near_forms forms = ray_cell_forms(f, v.e, f_set(0.0f));
    near_controls(&v.way, forms.c, b);
    const vf most = f_max(f_max(b[0], b[3]), f_max(b[1], b[2]));
    /* NaN is no reason to drop a ray: nothing is found yet. */
    return ~mf_bits(f_lt(most, f_set(-0.0f) - forms.bound)) & ((1u << q->count) - 1u);
}

static void peak_queue_flush(extreme_cells *p) {
    cell_queue *q = &p->queue;
    unsigned left = q->count > 0 ? queue_may_matter(p) : 0;
    q->count = q->cell_count = 0;
    for (; left; left &= left - 1) {
        const unsigned k = (unsigned)__builtin_ctz(left), c = q->cell[k];
        float samples[8];
        for (int s = 0; s < 8; s++)
            samples[s] = q->samples[s][k] * p->sign;
        peak_batch_add(p, q->at[c], q->cells[c], samples, q->ray[k]);
    }
}

/* peak_cells_flush() - computes all ray-cells that have been collected. */
static void peak_cells_flush(extreme_cells *p) {
    peak_queue_flush(p);
    peak_batch_flush(p);
}

/* Put a cell into the queue; the lanes that are added next belong to it. */
SIMD void queue_cell(cell_queue *q, const resident_grid *at, const uint32_t cell[3],
                     const float planes[3][3], const float scores[8]) {
    const unsigned c = q->cell_count++;
    q->at[c] = at;
    for (int a = 0; a < 3; a++) {
        q->cells[c][a] = cell[a];
        f_store(q->lo[a] + q->count, f_set(planes[a][0]));
        f_store(q->hi[a] + q->count, f_set(planes[a][1]));
        f_store(q->inv[a] + q->count, f_set(planes[a][2]));
    }
    for (int s = 0; s < 8; s++)
        f_store(q->samples[s] + q->count, f_set(scores[s]));
}

/* peak_cells_add() - adds a cell for some rays: bit k of `rays` is the ray at places[k]. */
static void peak_cells_add(extreme_cells *p, const resident_grid *at, const uint32_t cell[3],
                           const float planes[3][3], const float scores[8], const uint8_t places[],
                           unsigned rays) {
    cell_queue *q = &p->queue;
    if (q->count == VF_N)
        peak_queue_flush(p);
    queue_cell(q, at, cell, planes, scores);
    for (; rays; rays &= rays - 1) {
        if (q->count == VF_N) {
            peak_queue_flush(p);
            queue_cell(q, at, cell, planes, scores);
        }
        q->ray[q->count] = places[__builtin_ctz(rays)];
        q->cell[q->count++] = (uint8_t)(q->cell_count - 1);
    }
}

#endif
#endif
