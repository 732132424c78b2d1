/* grid_rays_template.h - the rays of a batch whose directions lie in one octant: sorted, and in a
 * form for tests against nodes of a grid. Included by the units of an ISA (see
 * formats/base/simd.h).
 */
#ifndef RENDER_GRID_GRID_RAYS_TEMPLATE_H
#define RENDER_GRID_GRID_RAYS_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include <float.h>
#include <math.h>
#include <string.h>

#include "render/grid/grid_cross_template.h"
#include "render/grid/level_planes.h"
#include "render/ray/ray_batch.h"

/* A set of rays: a bit a ray, by its place in the batch's order. */
enum { RAY_SET_WORDS = RAY_BATCH / 64 };
typedef struct ray_set {
    uint64_t of[RAY_SET_WORDS];
} ray_set;

/* Some rays of a batch, and the intervals in which they are to be followed through the grid. */
typedef struct grid_legs {
    unsigned count;
    uint8_t number[RAY_BATCH]; /* in the batch */
    const ray *r[RAY_BATCH];
    double t_in[RAY_BATCH], t_out[RAY_BATCH];
    double t_box[RAY_BATCH]; /* where they enter the volume's box, or a little before */
    double per_d[RAY_BATCH][3];
} grid_legs;

/* Rays by their places, for tests against planes. Let r be the reciprocal. A ray meets a near plane
 * at t = (plane - near_o) r or later, and a far plane at (plane - far_o) r or earlier; see
 * widening(). It ends at t1. */
typedef struct ray_slabs {
    float near_o[3][RAY_BATCH], far_o[3][RAY_BATCH], reciprocal[3][RAY_BATCH], t1[RAY_BATCH];
} ray_slabs;

/* Rays of one octant of directions, for conservative tests against nodes in single precision.
 * Neighbours have places beside each other. A ray's origin here is its entry, relative to `middle`,
 * and t is relative to the entry. */
typedef struct grid_rays {
    unsigned count, words;  /* words of sets in use */
    unsigned back;          /* bit a: d[a] < 0 */
    uint8_t ray[RAY_BATCH]; /* by place: its number in the batch */
    double t_in[RAY_BATCH], t_out[RAY_BATCH];
    double entry[3][RAY_BATCH]; /* o + t_in d */
    double middle[3];
    ray_slabs slabs;
    /* The same ray by ray, for f_load_triples(). [0] of the span: where the cell kernel lets the
     * ray begin, not above 0; [1]: t1. */
    float o_of[RAY_BATCH][3], d_of[RAY_BATCH][3], per_d_of[RAY_BATCH][3], span_of[RAY_BATCH][3];
    float rounding[3]; /* 2^23 times the largest rounding error of entries and planes, by axis */
} grid_rays;

/* Planes of a node's halves, as rays of an octant of directions meet them. [0]: the half that they
 * enter first. */
typedef struct node_planes {
    float near[3][2], far[3][2];
} node_planes;

/* Limits that keep all numbers and their products in float's range. Components below COMPONENT_MIN
 * of the largest would leave reciprocals useless. */
static const double EXTENT_MIN = 1e-15, EXTENT_MAX = 1e15, COMPONENT_MIN = 1e-9;

/* Stands for the reciprocal of 0. Times any extent it stays in float's range, but is a t that no
 * ray reaches. So a ray parallel to two planes, and between them, comes in before its start and
 * leaves beyond its end. */
static const double PER_NOTHING = 1e20;

/* ---- Sets ---- */

static bool ray_set_is_empty(const ray_set *s, unsigned words) {
    uint64_t any = 0;
    for (unsigned w = 0; w < words; w++)
        any |= s->of[w];
    return any == 0;
}

SIMD unsigned ray_set_count(const ray_set *s, unsigned words) {
    unsigned count = 0;
    for (unsigned w = 0; w < words; w++)
        count += (unsigned)__builtin_popcountll(s->of[w]);
    return count;
}

SIMD bool ray_set_has(const ray_set *s, unsigned i) {
    return s->of[i / 64] >> i % 64 & 1u;
}

SIMD void ray_set_add(ray_set *s, unsigned i) {
    s->of[i / 64] |= UINT64_C(1) << i % 64;
}

SIMD void ray_set_drop(ray_set *s, unsigned i) {
    s->of[i / 64] &= ~(UINT64_C(1) << i % 64);
}

/* ---- Places ---- */

/* Spread four bits, each followed by a zero. */
static unsigned spread(unsigned x) {
    return (x & 1u) | (x & 2u) << 1 | (x & 4u) << 2 | (x & 8u) << 3;
}

/* Returns x's square, 0 .. 15, counted from lo; also where all x are equal. */
static unsigned square_of(float x, float lo, float per) {
    const float at = (x - lo) * per;
    return at >= 15.0f ? 15u : at > 0.0f ? (unsigned)at : 0u;
}

/* Returns the axis along which rays go furthest. */
static int main_axis(const grid_legs *legs) {
    double way[3] = {0.0, 0.0, 0.0};
    for (unsigned i = 0; i < legs->count; i++)
        for (int a = 0; a < 3; a++)
            way[a] += (legs->t_out[i] - legs->t_in[i]) * fabs(legs->r[i]->d[a]);
    const int first = way[1] > way[0];
    return way[2] > way[first] ? 2 : first;
}

/* Find where rays cross a plane perpendicular to their main axis, half way along them. Rays that
 * are neighbours there are neighbours in the grid. */
static void crossings(const grid_legs *legs, float u[2][RAY_BATCH]) {
    const int main = main_axis(legs), side[2] = {(main + 1) % 3, (main + 2) % 3};
    double middle = 0.0;
    for (unsigned i = 0; i < legs->count; i++) {
        const ray *r = legs->r[i];
        middle += r->o[main] + 0.5 * (legs->t_in[i] + legs->t_out[i]) * r->d[main];
    }
    middle /= legs->count;
    for (unsigned i = 0; i < legs->count; i++) {
        const ray *r = legs->r[i];
        const double t = (middle - r->o[main]) * legs->per_d[i][main];
        for (int k = 0; k < 2; k++)
            u[k][i] = (float)(r->o[side[k]] + t * r->d[side[k]]);
    }
}

/* Compute codes of 8 bits: the rays' places along a Morton curve in that plane. */
static void codes_of(const grid_legs *legs, uint8_t code[RAY_BATCH]) {
    float u[2][RAY_BATCH], lo[2] = {FLT_MAX, FLT_MAX}, hi[2] = {-FLT_MAX, -FLT_MAX};
    crossings(legs, u);
    for (int k = 0; k < 2; k++) {
        for (unsigned i = 0; i < legs->count; i++) {
            lo[k] = u[k][i] < lo[k] ? u[k][i] : lo[k];
            hi[k] = u[k][i] > hi[k] ? u[k][i] : hi[k];
        }
    }
    /* Squares: the longer side decides. */
    const float width = hi[0] - lo[0] > hi[1] - lo[1] ? hi[0] - lo[0] : hi[1] - lo[1];
    const float per = width > 0.0f ? 15.999f / width : 0.0f;
    for (unsigned i = 0; i < legs->count; i++)
        code[i] = (uint8_t)(spread(square_of(u[0][i], lo[0], per)) |
                            spread(square_of(u[1][i], lo[1], per)) << 1);
}

/* Sort the numbers 0 .. count - 1 by their codes. */
static void sort_by_code(const uint8_t code[], unsigned count, uint8_t order[]) {
    uint16_t from[257] = {0};
    for (unsigned i = 0; i < count; i++)
        from[code[i] + 1]++;
    for (unsigned c = 0; c < 256; c++)
        from[c + 1] = (uint16_t)(from[c + 1] + from[c]);
    for (unsigned i = 0; i < count; i++)
        order[from[code[i]]++] = (uint8_t)i;
}

/* ---- Nodes ---- */

SIMD node_planes node_planes_of(const grid_rays *g, const level_planes *planes,
                                const uint32_t first[3], uint32_t half) {
    node_planes n;
    for (int a = 0; a < 3; a++) {
        const double *at = planes->at[a] + first[a];
        const float lo = (float)(at[0] - g->middle[a]), mid = (float)(at[half] - g->middle[a]);
        const float hi = (float)(at[2 * half] - g->middle[a]);
        const bool back = g->back >> a & 1u;
        n.near[a][0] = back ? hi : lo;
        n.near[a][1] = n.far[a][0] = mid;
        n.far[a][1] = back ? lo : hi;
    }
    return n;
}

/* Compute t where the VF_N rays from `at` on enter slabs between near and far planes, and leave
 * them. Each axis has `slabs` of them, x first. Along z, t is cut to the rays' own interval, 0 to
 * t1. */
SIMD void slabs_meet(const ray_slabs *s, unsigned at, unsigned slabs, const float near[],
                     const float far[], vf comes[], vf leaves[]) {
    for (unsigned a = 0; a < 3; a++) {
        const vf near_o = f_load(s->near_o[a] + at), far_o = f_load(s->far_o[a] + at);
        const vf r = f_load(s->reciprocal[a] + at);
        for (unsigned i = slabs * a; i < slabs * (a + 1); i++) {
            comes[i] = (f_set(near[i]) - near_o) * r;
            leaves[i] = (f_set(far[i]) - far_o) * r;
        }
    }
    const vf t1 = f_load(s->t1 + at);
    for (unsigned i = 2 * slabs; i < 3 * slabs; i++) {
        comes[i] = f_max(comes[i], f_set(0.0f));
        leaves[i] = f_min(leaves[i], t1);
    }
}

/* t where VF_N rays enter and leave both halves of a node, on each axis. */
typedef struct halves_met {
    vf near[3][2], far[3][2];
} halves_met;

SIMD halves_met halves_met_of(const grid_rays *g, const node_planes *n, unsigned at) {
    halves_met m;
    slabs_meet(&g->slabs, at, 2, n->near[0], n->far[0], m.near[0], m.far[0]);
    return m;
}

/* Return t where rays enter and leave child k in order: octant k ^ back. */
SIMD vf child_near(const halves_met *m, unsigned k) {
    return f_max(f_max(m->near[2][k >> 2], m->near[1][k >> 1 & 1]), m->near[0][k & 1]);
}
SIMD vf child_far(const halves_met *m, unsigned k) {
    return f_min(f_min(m->far[2][k >> 2], m->far[1][k >> 1 & 1]), m->far[0][k & 1]);
}

/* Find the rays that meet each of a node's children, in order. */
SIMD void children_met(const grid_rays *g, const node_planes *n, const ray_set *in,
                       ray_set met[8]) {
    const uint64_t all = (UINT64_C(1) << VF_N) - 1;
    for (unsigned w = 0; w < g->words; w++) {
        uint64_t of[8] = {0, 0, 0, 0, 0, 0, 0, 0};
        for (uint64_t left = in->of[w]; left;) {
            const unsigned shift = (unsigned)__builtin_ctzll(left) & ~(VF_N - 1u);
            const halves_met m = halves_met_of(g, n, 64 * w + shift);
            for (unsigned k = 0; k < 8; k++)
                of[k] |= (uint64_t)mf_bits(f_le(child_near(&m, k), child_far(&m, k))) << shift;
            left &= ~(all << shift);
        }
        for (unsigned k = 0; k < 8; k++)
            met[k].of[w] = of[k] & in->of[w];
    }
}

/* ---- Making them ---- */

/* Returns by how much a ray's origin is moved away from near and from far planes, so that tests are
 * conservative. Errors, in units u of 2^-24: planes and entries err by u of their size when they
 * become floats. Their difference, its product and the reciprocal err by u each. Together this
 * makes 2 u size + 3 u (2 size), where size is the larger of both, and terms of second order. The
 * entry itself, the kernel's own crossings, and the ends of t err by a few 2^-53 of the
 * distance from the ray's origin. */
static double widening(double size, double distance) {
    return 9.0 * 0x1p-24 * size + 0x1p-48 * distance;
}

/* Set the rays' entries. Raise size[] and distance[] to the largest ones, for widening(). */
static void rays_enter(grid_rays *g, const grid_legs *legs, const uint8_t order[], double size[3],
                       double distance[3]) {
    for (unsigned i = 0; i < legs->count; i++) {
        const unsigned from = order[i];
        const ray *r = legs->r[from];
        const double t_in = legs->t_in[from];
        g->ray[i] = legs->number[from];
        g->t_in[i] = t_in;
        g->t_out[i] = legs->t_out[from];
        const double begins = r->t0 > legs->t_box[from] ? r->t0 : legs->t_box[from];
        g->slabs.t1[i] = (float)(legs->t_out[from] - t_in) * (1.0f + 4.0f * UNIT);
        g->span_of[i][0] = (float)(begins - t_in);
        g->span_of[i][1] = g->slabs.t1[i];
        for (int a = 0; a < 3; a++) {
            const double e = r->o[a] + t_in * r->d[a], seen = fabs(e - g->middle[a]);
            const double far = fabs(r->o[a]) + fabs(t_in * r->d[a]);
            g->entry[a][i] = e;
            g->o_of[i][a] = (float)(e - g->middle[a]);
            g->d_of[i][a] = (float)r->d[a];
            g->slabs.reciprocal[a][i] = g->per_d_of[i][a] = (float)legs->per_d[from][a];
            size[a] = seen > size[a] ? seen : size[a];
            distance[a] = far > distance[a] ? far : distance[a];
        }
    }
}

/* Fill up the last vector with lanes that meet nothing. */
static void fill_up(grid_rays *g) {
    for (unsigned i = g->count; i % VF_N != 0; i++) {
        g->slabs.t1[i] = -1.0f;
        for (int a = 0; a < 3; a++)
            g->slabs.near_o[a][i] = g->slabs.far_o[a][i] = g->slabs.reciprocal[a][i] = 0.0f;
    }
}

/* grid_rays_make() - makes *g of rays in one octant of directions. middle: of the volume; size:
 * from there to the furthest plane. */
static void grid_rays_make(grid_rays *g, const grid_legs *legs, const double middle[3],
                           const double size[3]) {
    uint8_t code[RAY_BATCH], order[RAY_BATCH];
    codes_of(legs, code);
    sort_by_code(code, legs->count, order);
    g->count = legs->count;
    g->words = (legs->count + 63) / 64;
    g->back = 0;
    double furthest[3] = {size[0], size[1], size[2]}, distance[3] = {0.0, 0.0, 0.0};
    for (int a = 0; a < 3; a++) {
        g->middle[a] = middle[a];
        g->back |= (unsigned)(legs->r[0]->d[a] < 0.0) << a;
    }
    rays_enter(g, legs, order, furthest, distance);
    for (int a = 0; a < 3; a++) {
        const double wide = widening(furthest[a], distance[a] + fabs(middle[a]) + size[a]);
        const double w = g->back >> a & 1u ? -wide : wide;
        g->rounding[a] = (float)(furthest[a] + 0x1p-24 * (distance[a] + fabs(middle[a])));
        for (unsigned i = 0; i < g->count; i++) {
            g->slabs.near_o[a][i] = (float)(g->entry[a][i] - middle[a] + w);
            g->slabs.far_o[a][i] = (float)(g->entry[a][i] - middle[a] - w);
        }
    }
    fill_up(g);
}

#endif
#endif
