/* flat_beams_template.h - beams of rays and boxes, in the frame of a volume; included by the units
 * of an ISA (see formats/base/simd.h).
 *
 * The frame. A volume is moved and scaled until its bounds lie within -1 .. 1, and mirrored until
 * all directions of a group of rays are positive. A ray's direction is scaled until its largest
 * component is 1. t is counted from a little (AHEAD) before the ray enters it, or before its
 * own start if that comes later. So all that it may meet lies at 0 <= t <= 4 or so, and a box's
 * near planes are its lower ones. All numbers are then floats of ordinary size, whatever the
 * volume's coordinates are.
 *
 * Errors, with u = 2^-24, and the margins that cover them:
 *
 * - Positions. Origins and planes are computed in double and rounded, or are the sum of a treelet's
 * corner and a multiple, both rounded: 4 u each at most. An origin moved back to the start of its
 * beam errs by 8 u more. A point of a polygon errs by 24 u more, since its share of the edge is a
 * float, too. The planes of a treelet's nodes, which mesh_leaf_plane() rounds, also err by u of
 * their world coordinate. Boxes are widened by `slack`: 2^-18, which is 64 u, plus 4 u of the world
 * coordinate.
 *
 * - t. A difference and a product err by 2 u of themselves, a direction's inverse by u. So inverses
 * are made smaller for near planes and larger for far ones, by 16 u. Near planes behind the origin
 * do not count (t begins at 0), and slack makes the sign right for far ones there.
 *
 * - Steepness. An inverse is at most 2^40. A steeper ray moves by less than 2^-37 along the axis,
 * far less than the slack.
 *
 * - Ends. A hit's t errs by less than 2^-40 of itself (box_interval_behind()), and rays come from
 * FARTHEST at most: 2^-28. AHEAD is 2^-16, before the start and behind the end.
 *
 * - Absent treelets. A ray waits for each absent treelet that it enters according to
 * box_interval_in(). That test has a margin of its own: see generosity().
 */
#ifndef RENDER_FLAT_FLAT_BEAMS_TEMPLATE_H
#define RENDER_FLAT_FLAT_BEAMS_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/flat/flat_rays_template.h"
#include "render/walk/box_interval.h"

/* Beams of a group that are walked together: bits of a word. */
enum { FLAT_BEAMS = 32 };

static const double AHEAD = 0x1p-16, STEEPEST = 0x1p40, FARTHEST = 0x1p12;

/* A volume's frame, and how a group of rays mirrors it. */
typedef struct beam_frame {
    double centre[3], scale;
    double sign[3];
    float slack[3]; /* of boxes */
    double half;    /* all of the volume lies within -half .. half, margins included */
} beam_frame;

/* Returns false if the frame's numbers are too large or too small for floats. */
static bool frame_of_bounds(const float bounds[6], beam_frame *f) {
    double size = 0.0;
    for (int a = 0; a < 3; a++) {
        const double lo = (double)bounds[a], hi = (double)bounds[a + 3];
        f->centre[a] = 0.5 * (lo + hi);
        size = hi - lo > size ? hi - lo : size;
    }
    f->scale = 2.0 / size;
    f->half = 1.0 + 0x1p-5;
    for (int a = 0; a < 3; a++) {
        const double lo = fabs((double)bounds[a]), hi = fabs((double)bounds[a + 3]);
        const double slack = 0x1p-18 + 0x1p-22 * (lo > hi ? lo : hi) * f->scale;
        f->slack[a] = (float)slack;
        f->half = 1.0 + 0x1p-5 + slack > f->half ? 1.0 + 0x1p-5 + slack : f->half;
    }
    return f->scale > 0x1p-100 && f->scale < 0x1p100 && f->half < 2.0;
}

/* ---- Rays ---- */

/* The rays of a group, numbered like those of flat_rays. */
typedef struct frame_rays {
    _Alignas(64) float o[3][FLAT_RAYS], d[3][FLAT_RAYS], inverse[3][FLAT_RAYS];
    float moment[3][FLAT_RAYS]; /* o x d */
    float far[FLAT_RAYS];       /* how far they look; below 0: not at all */
    float back[FLAT_RAYS];      /* how far before each its beam begins */
    double begin[FLAT_RAYS];    /* t in the frame is per_t times the ray's own t, less `begin` */
    double per_t[FLAT_RAYS];
} frame_rays;

/* Convert VD_N rays from `at` on. */
SIMD void put_in_frame(const beam_frame *f, const flat_rays *from, int at, frame_rays *to) {
    vd d[3], o[3], largest = d_set(0.0), enter = d_set(-INFINITY), leave = d_set(INFINITY);
    for (int a = 0; a < 3; a++) {
        d[a] = d_abs(d_load(from->d[a] + at));
        o[a] = (d_load(from->o[a] + at) - d_set(f->centre[a])) * d_set(f->scale * f->sign[a]);
        largest = d_max(largest, d[a]);
    }
    const vd per_t = largest * d_set(f->scale);
    for (int a = 0; a < 3; a++) {
        d[a] = d[a] / largest;
        const vd inverse = d_set(1.0) / d_max(d[a], d_set(1.0 / STEEPEST));
        enter = d_max(enter, (d_set(-f->half) - o[a]) * inverse);
        leave = d_min(leave, (d_set(f->half) - o[a]) * inverse);
        d_store_floats(to->inverse[a] + at, inverse);
        d_store_floats(to->d[a] + at, d[a]);
    }
    const vd first = d_max(enter, d_load(from->from + at) * per_t);
    const vd end = d_min(leave, d_load(from->to + at) * per_t);
    const vd begin = first - d_set(AHEAD);
    const vd far =
        d_select(d_le(begin, end + d_set(AHEAD)), end - begin + d_set(2.0 * AHEAD), d_set(-1.0));
    for (int a = 0; a < 3; a++) {
        o[a] = o[a] + begin * d[a];
        d_store_floats(to->o[a] + at, o[a]);
    }
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3, c = (a + 2) % 3;
        d_store_floats(to->moment[a] + at, o[b] * d[c] - o[c] * d[b]);
    }
    d_store_floats(to->far + at, far);
    d_store(to->begin + at, begin);
    d_store(to->per_t + at, per_t);
}

/* Let ray i look no farther than t. */
static void look_up_to(frame_rays *r, int i, double t) {
    const float far = (float)(t * r->per_t[i] - r->begin[i] + 2.0 * AHEAD);
    r->far[i] = far < r->far[i] ? far : r->far[i];
}

/* ---- Beams ---- */

/* Store the lanes in `of` side by side. */
SIMD void f_pack(float *to, unsigned of, vf x) {
    float from[VF_N];
    f_store(from, x);
    for (; of; of &= of - 1)
        *to++ = from[__builtin_ctz(of)];
}

/* Beams, a lane each. For near planes: the origin farthest ahead and the fastest ray. For far
 * planes: the origin farthest behind and the slowest ray. */
typedef struct flat_beams {
    _Alignas(64) float ahead[3][FLAT_BEAMS], behind[3][FLAT_BEAMS];
    float least[3][FLAT_BEAMS], most[3][FLAT_BEAMS]; /* of the inverses of directions */
    float far[FLAT_BEAMS];
} flat_beams;

static void empty_beam(flat_beams *m, unsigned beam) {
    for (int a = 0; a < 3; a++) {
        m->ahead[a][beam] = m->behind[a][beam] = 0.0f;
        m->least[a][beam] = m->most[a][beam] = 1.0f;
    }
    m->far[beam] = -1.0f;
}

/* Returns how far a beam of these rays looks; below 0: not at all. */
SIMD float farthest(const frame_rays *r, unsigned first, unsigned end) {
    float most = -1.0f;
    for (unsigned i = first; i < end; i++) {
        const float far = r->far[i] < 0.0f ? -1.0f : r->far[i] + r->back[i];
        most = far > most ? far : most;
    }
    return most;
}

/* ---- Blocks of rays ---- */

/* The most rays of a beam. */
enum { BEAM_RAYS = (int)VF_N < 8 ? (int)VF_N : 8 };

/* VF_N rays. Lanes that do not look are left out of least and greatest values. */
typedef struct ray_lanes {
    vf o[3], d[3], inverse[3], far;
    mf looks;
} ray_lanes;

/* The beams of blocks of neighbouring rays. All lanes of a block have the same numbers, except
 * `back`. */
typedef struct block_lanes {
    vf ahead[3], behind[3], least[3], most[3], far;
    vf back;  /* per ray */
    vf cost;  /* see cost_of_blocks() */
    vf share; /* number of rays in the block */
} block_lanes;

SIMD ray_lanes ray_lanes_load(const frame_rays *r, unsigned at) {
    ray_lanes l = {.far = f_load(r->far + at)};
    for (int a = 0; a < 3; a++) {
        l.o[a] = f_load(r->o[a] + at);
        l.d[a] = f_load(r->d[a] + at);
        l.inverse[a] = f_load(r->inverse[a] + at);
    }
    l.looks = f_ge(l.far, f_set(0.0f));
    return l;
}

/* Give every lane the least number of its block of `share` lanes. */
SIMD vf block_min(vf x, unsigned share) {
    x = share > 1 ? f_min(x, f_swap(x, 1)) : x;
    x = share > 2 ? f_min(x, f_swap(x, 2)) : x;
    return share > 4 ? f_min(x, f_swap(x, 4)) : x;
}

/* Give every lane the greatest number of its block. */
SIMD vf block_max(vf x, unsigned share) {
    x = share > 1 ? f_max(x, f_swap(x, 1)) : x;
    x = share > 2 ? f_max(x, f_swap(x, 2)) : x;
    return share > 4 ? f_max(x, f_swap(x, 4)) : x;
}

/* Returns by how much of their t rays are to be moved back, so that all rays of a block begin in a
 * plane across the axis, where the first of them begins. Their origins then spread over a plane
 * instead of a box. 0: they would have to move far. */
SIMD vf ways_back(const ray_lanes *r, unsigned share, int axis) {
    const vf more = f_set(INFINITY), less = f_set(-INFINITY), o = r->o[axis];
    const vf first = block_min(f_select(r->looks, o, more), share);
    const vf last = block_max(f_select(r->looks, o, less), share);
    const vf slowest = block_min(f_select(r->looks, r->d[axis], more), share);
    const mf near = mf_and(f_le(last - first, f_set(0.25f)), f_ge(slowest, f_set(0.25f)));
    return f_select(mf_and(near, r->looks), (o - first) * r->inverse[axis], f_set(0.0f));
}

/* Returns the cost of one block. Joining is worth it while this is below the cost of its parts. A
 * beam meets the tets within it and half a cell (of size `cell`) around it; a ray meets the tets of
 * its own cell. The width of a beam is the largest distance of its rays on their way. */
SIMD vf cost_of_blocks(const block_lanes *b, float cell) {
    const vf one = f_set(1.0f);
    vf wide = f_set(0.0f);
    for (int a = 0; a < 3; a++) {
        const vf origins = b->ahead[a] - b->behind[a];
        const vf turns = one / b->least[a] - one / b->most[a];
        wide = f_max(wide, origins + turns);
    }
    const vf cells = one + wide * f_set(1.0f / cell);
    return f_select(f_ge(b->far, f_set(0.0f)), cells * cells, f_set(0.0f));
}

SIMD block_lanes blocks_of(const ray_lanes *r, unsigned share, int axis, float cell) {
    const vf more = f_set(INFINITY), less = f_set(-INFINITY);
    block_lanes b = {.back = ways_back(r, share, axis), .share = f_set((float)share)};
    for (int a = 0; a < 3; a++) {
        const vf o = r->o[a] - b.back * r->d[a];
        b.ahead[a] = block_max(f_select(r->looks, o, less), share);
        b.behind[a] = block_min(f_select(r->looks, o, more), share);
        b.least[a] = block_min(f_select(r->looks, r->inverse[a], more), share);
        b.most[a] = block_max(f_select(r->looks, r->inverse[a], f_set(0.0f)), share);
    }
    b.far = block_max(f_select(r->looks, r->far + b.back, f_set(-1.0f)), share);
    b.cost = cost_of_blocks(&b, cell);
    return b;
}

/* Join blocks in pairs where that costs no more than the two. */
SIMD void join_blocks(const ray_lanes *r, unsigned share, int axis, float cell, block_lanes *b) {
    const block_lanes joined = blocks_of(r, share, axis, cell);
    const vf apart = b->cost + f_swap(b->cost, share / 2);
    const mf pays = f_le(joined.cost, apart);
    for (int a = 0; a < 3; a++) {
        b->ahead[a] = f_select(pays, joined.ahead[a], b->ahead[a]);
        b->behind[a] = f_select(pays, joined.behind[a], b->behind[a]);
        b->least[a] = f_select(pays, joined.least[a], b->least[a]);
        b->most[a] = f_select(pays, joined.most[a], b->most[a]);
    }
    b->far = f_select(pays, joined.far, b->far);
    b->back = f_select(pays, joined.back, b->back);
    b->share = f_select(pays, joined.share, b->share);
    b->cost = f_min(joined.cost, apart);
}

/* Find the cheapest blocks of VF_N rays. */
SIMD block_lanes best_blocks(const frame_rays *r, unsigned at, int axis, float cell) {
    const ray_lanes rays = ray_lanes_load(r, at);
    block_lanes b = blocks_of(&rays, 1, axis, cell);
    join_blocks(&rays, 2, axis, cell, &b);
    join_blocks(&rays, 4, axis, cell, &b);
    if (BEAM_RAYS >= 8)
        join_blocks(&rays, 8, axis, cell, &b);
    return b;
}

/* Returns a bit for the first lane of each block that has rays that look. Sets share[] of a first
 * lane to the block's number of rays. */
SIMD unsigned heads_of_blocks(const block_lanes *b, uint8_t share[VF_N]) {
    const unsigned looking = mf_bits(f_ge(b->far, f_set(0.0f)));
    float shares[VF_N];
    unsigned heads = 0;
    f_store(shares, b->share);
    for (unsigned k = 0; k < VF_N; k += share[k]) {
        share[k] = (uint8_t)shares[k];
        heads |= looking & 1u << k;
    }
    return heads;
}

/* Make beams of blocks, from number `beam` on. slack: the margin, see generosity(). */
SIMD void put_blocks(flat_beams *m, unsigned beam, const block_lanes *b, unsigned heads,
                     float slack) {
    for (int a = 0; a < 3; a++) {
        f_pack(m->ahead[a] + beam, heads, b->ahead[a] + f_set(slack));
        f_pack(m->behind[a] + beam, heads, b->behind[a] - f_set(slack));
        f_pack(m->least[a] + beam, heads, b->least[a] * f_set(1.0f - 0x1p-20f));
        f_pack(m->most[a] + beam, heads, b->most[a] * f_set(1.0f + 0x1p-20f));
    }
    f_pack(m->far + beam, heads, b->far);
}

/* Returns the margin of box_interval_in() for these rays. Beams need it too: a ray waits for each
 * treelet that it enters according to that function. The margin is at most 4 BOX_INTERVAL_MARGIN of
 * a box's t, which is less than the t where the rays begin in the frame, plus 8. */
SIMD float generosity(const frame_rays *r, unsigned count) {
    double most = 0.0;
    for (unsigned i = 0; i < count; i++)
        if (r->far[i] >= 0.0f)
            most = fabs(r->begin[i]) > most ? fabs(r->begin[i]) : most;
    return (float)(4.0 * BOX_INTERVAL_MARGIN * (most + 8.0));
}

/* ---- Boxes ---- */

/* Boxes of a node. There, AVX-512 has idle lanes, and SSE needs two vectors. */
enum { NODE_BOXES = 8, BEAM_BOXES = (int)VF_N > NODE_BOXES ? (int)VF_N : NODE_BOXES };

typedef struct beam_boxes {
    _Alignas(64) float lo[3][BEAM_BOXES], hi[3][BEAM_BOXES];
} beam_boxes;

/* Returns which of VF_N beams from `at` on may meet a box. */
SIMD unsigned beams_through(const flat_beams *m, const beam_boxes *b, unsigned box, unsigned at) {
    vf in = f_set(0.0f), out = f_load(m->far + at);
    for (int a = 0; a < 3; a++) {
        const vf near = f_set(b->lo[a][box]) - f_load(m->ahead[a] + at);
        const vf far = f_set(b->hi[a][box]) - f_load(m->behind[a] + at);
        in = f_max(in, near * f_load(m->least[a] + at));
        out = f_min(out, far * f_load(m->most[a] + at));
    }
    return mf_bits(f_le(in, out));
}

/* Returns which of VF_N boxes from `at` on a beam may meet. */
SIMD unsigned boxes_in(const flat_beams *m, const beam_boxes *b, unsigned at, unsigned beam) {
    vf in = f_set(0.0f), out = f_set(m->far[beam]);
    for (int a = 0; a < 3; a++) {
        const vf near = f_load(b->lo[a] + at) - f_set(m->ahead[a][beam]);
        const vf far = f_load(b->hi[a] + at) - f_set(m->behind[a][beam]);
        in = f_max(in, near * f_set(m->least[a][beam]));
        out = f_min(out, far * f_set(m->most[a][beam]));
    }
    return mf_bits(f_le(in, out));
}

/* Returns how many vectors of VF_N beams have any of these beams. */
SIMD unsigned vectors_in(uint32_t beams) {
    enum { ALL = (1u << VF_N) - 1 };
    unsigned count = 0;
    for (unsigned at = 0; at < FLAT_BEAMS; at += VF_N)
        count += (beams >> at & ALL) != 0;
    return count;
}

/* Test boxes against beams. boxes: a bit per box to be tested; wanted[]: the beams to test a box
 * with; any: all beams in wanted[]. Returns the boxes that some wanted beam may meet, and sets
 * met[] to these beams. met[] of other boxes is undefined. Takes the cheaper way: vectors of boxes,
 * beam by beam, or vectors of beams, box by box. */
SIMD unsigned meet_boxes(const flat_beams *m, const beam_boxes *b, unsigned boxes, uint32_t any,
                         const uint32_t wanted[BEAM_BOXES], uint32_t met[BEAM_BOXES]) {
    enum { ALL = (1u << VF_N) - 1 };
    const unsigned end = 32u - (unsigned)__builtin_clz(boxes | 1u);
    const unsigned steps = (end + VF_N - 1) / VF_N * (unsigned)__builtin_popcount(any);
    unsigned found = 0;
    if (3 * steps <= 2 * (unsigned)__builtin_popcount(boxes) * vectors_in(any)) {
        memset(met, 0, BEAM_BOXES * sizeof *met);
        for (uint32_t left = any; left; left &= left - 1) {
            const unsigned beam = (unsigned)__builtin_ctz(left);
            for (unsigned at = 0; at < end; at += VF_N) {
                unsigned bits = (boxes_in(m, b, at, beam) << at) & boxes;
                for (found |= bits; bits; bits &= bits - 1) {
                    const unsigned c = (unsigned)__builtin_ctz(bits);
                    met[c] |= wanted[c] & left & -left;
                }
            }
        }
        return found;
    }
    for (; boxes; boxes &= boxes - 1) {
        const unsigned c = (unsigned)__builtin_ctz(boxes);
        met[c] = 0;
        for (unsigned at = 0; at < FLAT_BEAMS; at += VF_N) {
            const unsigned bits = wanted[c] >> at & ALL;
            if (bits)
                met[c] |= (beams_through(m, b, c, at) & bits) << at;
        }
        found |= (unsigned)(met[c] != 0) << c;
    }
    return found;
}

#endif
#endif
