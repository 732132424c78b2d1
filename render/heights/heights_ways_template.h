/* heights_ways_template.h - the cells of a treelet on the ways of many rays, VF_N rays at a time;
 * included by the units of an ISA (see formats/base/simd.h).
 *
 * It finds the same cells as heights_way.h, and some more, in single precision. A way is given by
 * where it comes into the treelet and where it leaves it, in cells and codes of the treelet, and s
 * goes from 0 to 1 on it. A lane takes a way through the treelet, past nodes of 16 cells on a side;
 * then one through such a node, past nodes of 4; then one through such a node, past its cells.
 * Lanes step from plane to plane, and leave out what the way is above or below of. So each step is
 * short, and vectors are full when they begin.
 *
 * Rounding moves a place on a way by less than half of WAY_ERROR. So the order of two planes is in
 * doubt where a way crosses them closer to each other than that allows, and so is where a way is
 * that is close to a plane inside of the node that it enters. Such ways are given back, to be
 * walked alone. As to elevations nodes are widened by more than all rounding.
 */
#ifndef RENDER_HEIGHTS_HEIGHTS_WAYS_TEMPLATE_H
#define RENDER_HEIGHTS_HEIGHTS_WAYS_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include <string.h>

#include "render/heights/heights_way.h"

/* Cells. Coordinates are at most 64: their rounding, and that of what is computed of them, is less
 * than 2^-16. */
#define WAY_ERROR 0x1p-15f
/* Codes: more than the rounding of elevations. */
#define WAY_RISE 0x1p-10

enum { WAYS = 1024, WAY_STEPS = 1024, WAY_ROW = 8 };

/* Nodes or cells on ways: the number of the way, the first cell along axes 0 and 2; the part of the
 * way that may meet their elevations. */
enum { WAY_AXIS_0 = 10, WAY_AXIS_2 = 16, WAY_NUMBER = (1 << WAY_AXIS_0) - 1 };

typedef struct way_steps {
    unsigned count;
    uint32_t at[WAY_STEPS + VF_N];
    float s[WAY_STEPS + VF_N], end[WAY_STEPS + VF_N];
} way_steps;

/* Ways: where they begin on axes 0, 2 and 1, and how far they go there; which rays they are of. */
typedef struct ways {
    unsigned count;
    uint32_t ray[WAYS];
    uint8_t doubtful[WAYS];
    float row[WAYS + VF_N][WAY_ROW];
    way_steps nodes[2], cells; /* nodes: of 16 cells on a side, of 4 */
} ways;

/* A treelet, prepared for ways. */
typedef struct way_block {
    const heights_block *b;
    const uint8_t *low, *high; /* codes of nodes of 4 cells */
    uint32_t most;             /* the greatest place among them */
    float top;                 /* edge of the nodes that ways go past first */
    uint32_t tops[16];         /* their codes: of the least elevation, and << 16 of the greatest */
    float limit[2], last[2];   /* less than all cells along axes 0 and 2; the last ones */
    float slack;               /* of codes */
    double least, codes;       /* elevations: where codes begin, and codes of a unit */
} way_block;

/* Look up the codes of the nodes that ways go past first. */
static void way_block_tops(way_block *b) {
    const heights_block *of = b->b;
    const uint32_t levels = of->of->shape.node_levels, depth = levels > 2 ? levels - 2 : levels;
    const uint8_t *codes = of->codes + leaf_codes_at(depth);
    for (uint32_t i = 0; i < 16; i++) {
        const uint32_t at = heights_morton(i & 3, i >> 2) & ((1U << 3 * depth) - 1U);
        b->tops[i] = codes[at] | (uint32_t)codes[at + ((size_t)1 << 3 * depth)] << 16;
    }
}

/* way_block_of() - false: single precision is too coarse for what rays from a place see of it.
 * slack: of elevations. */
static bool way_block_of(const heights_block *b, const double from[3], double slack,
                         way_block *out) {
    const uint32_t levels = b->of->shape.node_levels;
    const double codes = b->step > 0.0 ? 1.0 / b->step : 0.0, far = b->range[1] - b->range[0];
    const double most = fabs(from[1]) + fabs(b->range[0]) + fabs(b->range[1]);
    bool fine = most * codes < 0x1p36 && codes < 0x1p127 && far < 0x1p127;
    out->b = b;
    out->least = b->range[0];
    out->codes = codes;
    out->top = levels > 2 ? 16.0f : 4.0f;
    out->slack = (float)(WAY_RISE + slack * codes);
    out->low = b->codes + leaf_codes_at(levels);
    out->high = out->low + ((size_t)1 << 3 * levels);
    out->most = (1U << 3 * levels) - 1U;
    for (int a = 0; a < 2; a++) {
        const double last = (double)b->of->first_cell[2 * a] + (1 << LEAF_CELLS_LOG2_MAX);
        out->limit[a] = (float)b->of->shape.cells[2 * a] - 0.5f;
        out->last[a] = (float)b->of->shape.cells[2 * a] - 1.0f;
        fine = fine && fabs(from[2 * a]) * b->inverse + last < 0x1p28;
    }
    if (fine)
        way_block_tops(out);
    return fine;
}

/* ---- Lanes ---- */

typedef struct way_lanes {
    vf o[3], d[3], r[3];  /* way: o + s d; 1 / d */
    vf ahead[2], unit[2]; /* 1 where planes ahead are the upper ones, else 0; +1, -1 */
    vf near[2];           /* closer than that to a plane, the side is in doubt */
    vf margin;            /* of s, where planes are crossed */
    vf slack;             /* of codes */
    mf falls;
    vi number;
    unsigned alive, doubtful;
} way_lanes;

SIMD unsigned way_all(unsigned count) {
    return count >= VF_N ? (unsigned)(((uint64_t)1 << VF_N) - 1) : (1u << count) - 1u;
}

/* Lanes whose place on an axis is close to a plane within a node. */
SIMD mf way_close(vf x, vf near, vf edge, vf inverse, vf at, vf size) {
    const vf plane = f_floor(x * inverse + f_set(0.5f)) * edge;
    return mf_and(f_lt(f_abs(x - plane), near), mf_and(f_gt(plane, at), f_lt(plane, at + size)));
}

/* Ways on an axis, from where they come in and go out. One that hardly moves stays in the middle of
 * its cell. Returns those that are in doubt. */
SIMD mf way_axis(const way_block *b, int a, vf from, vf to, vf *o, vf *d) {
    const vf zero = f_set(0.0f), one = f_set(1.0f), error = f_set(WAY_ERROR);
    const vf last = f_set(b->last[a]), wide = f_set(64.0f), along = to - from;
    const vf cell = f_max(f_min(f_floor(from), last), zero);
    const vf other = f_max(f_min(f_floor(to), last), zero);
    const mf slow = f_lt(f_abs(along), f_set(0x1p-7f));
    const mf close = mf_or(way_close(from, error, one, one, zero, wide),
                           way_close(to, error, one, one, zero, wide));
    const mf still = mf_and_not(mf_and(slow, f_eq(cell, other)), close);
    *o = f_select(still, cell + f_set(0.5f), from);
    *d = f_select(still, zero, along);
    return mf_and_not(slow, still);
}

/* Prepare lanes of ways. */
SIMD void way_lanes_of(const way_block *b, const ways *w, vi number, unsigned alive, way_lanes *l) {
    const vf zero = f_set(0.0f), one = f_set(1.0f);
    uint32_t rows[VF_N];
    vf from[4], along[4], steep[2];
    i_store(rows, number);
    f_load_fours(w->row[0], WAY_ROW, rows, from);
    f_load_fours(w->row[0] + 4, WAY_ROW, rows, along);
    for (int a = 0; a < 3; a++) {
        l->o[a] = from[a];
        l->d[a] = along[a];
        l->r[a] = one / along[a];
    }
    for (int a = 0; a < 2; a++) {
        steep[a] = f_select(f_eq(l->d[a], zero), zero, f_abs(l->r[a]));
        l->ahead[a] = f_select(f_lt(l->d[a], zero), zero, one);
        l->unit[a] = l->ahead[a] + l->ahead[a] - one;
    }
    l->margin = f_set(WAY_ERROR) * (steep[0] + steep[1]);
    for (int a = 0; a < 2; a++)
        l->near[a] = f_set(WAY_ERROR) + f_abs(l->d[a]) * l->margin;
    l->falls = f_lt(l->d[2], zero);
    l->slack = f_set(b->slack) + f_abs(l->d[2]) * l->margin;
    l->number = number;
    l->alive = alive;
    l->doubtful = 0;
}

SIMD void way_lanes_doubt(way_lanes *l, mf doubt) {
    const unsigned lanes = mf_bits(doubt) & l->alive;
    l->doubtful |= lanes;
    l->alive &= ~lanes;
}

static void way_lanes_end(const way_lanes *l, ways *w) {
    uint32_t numbers[VF_N];
    i_store(numbers, l->number);
    for (unsigned left = l->doubtful; left; left &= left - 1)
        w->doubtful[numbers[__builtin_ctz(left)]] = 1;
}

SIMD vf way_clamp(vf x, float most) {
    return f_max(f_min(x, f_set(most)), f_set(0.0f));
}

/* Begin at s in a node at a corner: set at[] to its child there. */
SIMD void way_lanes_begin(const way_block *b, way_lanes *l, vf s, const vf corner[2], vf size,
                          vf edge, vf inverse, vf at[2]) {
    for (int a = 0; a < 2; a++) {
        const vf x = way_clamp(l->o[a] + s * l->d[a], b->limit[a]);
        way_lanes_doubt(l, way_close(x, l->near[a], edge, inverse, corner[a], size));
        at[a] = f_min(f_max(f_floor(x * inverse) * edge, corner[a]), corner[a] + size - edge);
    }
}

/* The s where ways leave what they are in at `at`, along each axis. */
SIMD vf way_lanes_next(const way_lanes *l, const vf at[2], vf edge, vf t[2]) {
    for (int a = 0; a < 2; a++)
        t[a] = (at[a] + l->ahead[a] * edge - l->o[a]) * l->r[a];
    return f_min(t[0], t[1]);
}

/* Cut s .. end to where ways are at elevations. Returns which are not. */
SIMD mf way_lanes_cut(const way_lanes *l, vf low, vf high, vf *s, vf *end) {
    low = low - l->slack;
    high = high + l->slack;
    const vf first = (f_select(l->falls, high, low) - l->o[2]) * l->r[2];
    const vf last = (f_select(l->falls, low, high) - l->o[2]) * l->r[2];
    *s = f_max(*s, first);
    *end = f_min(*end, last);
    return f_gt(*s, *end);
}

/* Go on behind the plane that is next. Lanes end behind `end`, and outside of a node. */
SIMD void way_lanes_step(way_lanes *l, const vf t[2], vf next, vf end, const vf corner[2],
                         const vf past[2], vf edge, vf at[2]) {
    const mf over = f_lt(end, next), along = f_le(t[0], t[1]);
    way_lanes_doubt(l, mf_and_not(f_lt(f_abs(t[0] - t[1]), l->margin), over));
    at[0] = f_select(along, at[0] + l->unit[0] * edge, at[0]);
    at[1] = f_select(along, at[1], at[1] + l->unit[1] * edge);
    mf done = over;
    for (int a = 0; a < 2; a++)
        done = mf_or(done, mf_or(f_lt(at[a], corner[a]), f_gt(at[a], past[a])));
    l->alive &= ~mf_bits(done);
}

SIMD void way_steps_add(way_steps *to, const way_lanes *l, unsigned found, const vf at[2], vf s,
                        vf end) {
    i_pack(to->at + to->count,
           l->number | f_to_int(at[0]) << WAY_AXIS_0 | f_to_int(at[1]) << WAY_AXIS_2, found);
    i_pack((uint32_t *)(void *)(to->s + to->count), (vi)s, found);
    i_pack((uint32_t *)(void *)(to->end + to->count), (vi)end, found);
    to->count += (unsigned)__builtin_popcount(found);
}

/* The first cells of nodes. */
SIMD void way_steps_corner(vi at, vf corner[2]) {
    corner[0] = f_of_ints(at >> WAY_AXIS_0 & i_set((1u << (WAY_AXIS_2 - WAY_AXIS_0)) - 1u));
    corner[1] = f_of_ints(at >> WAY_AXIS_2 & i_set((1u << (WAY_AXIS_2 - WAY_AXIS_0)) - 1u));
}

/* ---- What is read soon ---- */

/* Have the cache fetch the codes in the nodes of 16 cells that were found last. */
SIMD void way_codes_ask(const way_block *b, const way_steps *nodes, unsigned from) {
    for (; from < nodes->count; from++) {
        const uint32_t i = nodes->at[from] >> (WAY_AXIS_0 + 2) & 15U;
        const uint32_t place = heights_morton(i, nodes->at[from] >> (WAY_AXIS_2 + 2) & 15U);
        __builtin_prefetch(b->low + place);
        __builtin_prefetch(b->low + place + 45);
        __builtin_prefetch(b->high + place);
        __builtin_prefetch(b->high + place + 45);
    }
}

/* Have it fetch the samples in nodes of 4 cells. */
SIMD void way_samples_ask(const way_block *b, const way_steps *nodes, unsigned from) {
    const size_t width = sample_size(b->b->type), row = b->b->slice * width;
    for (; from < nodes->count; from++) {
        const uint32_t i = nodes->at[from] >> WAY_AXIS_0 & 63U;
        const char *at =
            (const char *)b->b->first + i * width + (nodes->at[from] >> WAY_AXIS_2 & 63U) * row;
        for (int k = 0; k < 5; k++)
            __builtin_prefetch(at + k * row);
    }
}

/* ---- Nodes ---- */

/* Take VF_N ways, from `from` on, past the largest nodes. Returns how many ways that were. */
static void ways_in_treelet(const way_block *b, ways *w, unsigned from, way_steps *out) {
    const vf zero = f_set(0.0f), one = f_set(1.0f), top = f_set(b->top), inverse = one / top;
    const vf corner[2] = {zero, zero}, past[2] = {f_set(b->limit[0]), f_set(b->limit[1])};
    uint32_t numbers[VF_N];
    const unsigned before = out->count;
    way_lanes l;
    vf at[2], t[2], s = zero;
    for (unsigned k = 0; k < VF_N; k++)
        numbers[k] = from + k;
    way_lanes_of(b, w, i_load(numbers), way_all(w->count - from), &l);
    const vf whole = one + l.margin;
    way_lanes_begin(b, &l, s, corner, f_set(64.0f), top, inverse, at);
    while (l.alive) {
        const vf next = way_lanes_next(&l, at, top, t);
        const vi node = f_to_int(at[0] * inverse) | f_to_int(at[1] * inverse) << 2;
        const vi codes = i_look_up_16(b->tops, node & i_set(15u));
        vf in = s, stop = f_min(whole, next);
        const mf misses = way_lanes_cut(&l, f_of_ints(codes & i_set(0xffffu)),
                                        f_of_ints(codes >> 16), &in, &stop);
        const unsigned found = l.alive & ~mf_bits(misses);
        if (found)
            way_steps_add(out, &l, found, at, in, stop);
        way_lanes_step(&l, t, next, whole, corner, past, top, at);
        s = next;
    }
    if (b->top == 16.0f)
        way_codes_ask(b, out, before);
    else
        way_samples_ask(b, out, before);
    way_lanes_end(&l, w);
}

/* The elevations, as codes, of nodes of 4 cells on a side. */
SIMD void way_codes(const way_block *b, const vf at[2], vf *low, vf *high) {
    const vf quarter = f_set(0.25f);
    vi place = f_to_int(at[0] * quarter) | f_to_int(at[1] * quarter) << 16;
    place = (place | place << 4) & i_set(0x00c300c3u);
    place = (place | place << 2) & i_set(0x02490249u);
    place = (place | place >> 14) & i_set(b->most);
    *low = f_of_ints(i_gather(b->low, place) & i_set(255u));
    *high = f_of_ints(i_gather(b->high, place) & i_set(255u));
}

/* Take ways past the nodes of 4 cells in VF_N nodes of 16, from `from` on. */
static void ways_in_nodes(const way_block *b, ways *w, unsigned from, way_steps *out) {
    const way_steps *nodes = &w->nodes[0];
    const unsigned before = out->count;
    const vf edge = f_set(4.0f), inverse = f_set(0.25f);
    const vi node = i_load(nodes->at + from);
    const vf end = f_load(nodes->end + from);
    way_lanes l;
    vf at[2], t[2], corner[2], past[2], s = f_load(nodes->s + from);
    way_lanes_of(b, w, node & i_set(WAY_NUMBER), way_all(nodes->count - from), &l);
    way_steps_corner(node, corner);
    for (int a = 0; a < 2; a++)
        past[a] = f_min(corner[a] + f_set(15.5f), f_set(b->limit[a]));
    way_lanes_begin(b, &l, s, corner, f_set(16.0f), edge, inverse, at);
    while (l.alive) {
        vf low, high;
        const vf next = way_lanes_next(&l, at, edge, t);
        way_codes(b, at, &low, &high);
        vf in = s, stop = f_min(end, next);
        const mf misses = way_lanes_cut(&l, low, high, &in, &stop);
        const unsigned found = l.alive & ~mf_bits(misses);
        if (found)
            way_steps_add(out, &l, found, at, in, stop);
        way_lanes_step(&l, t, next, end, corner, past, edge, at);
        s = next;
    }
    way_samples_ask(b, out, before);
    way_lanes_end(&l, w);
}

/* ---- Cells ---- */

/* Bytes from `at` on: two at least, and none behind the last node's. */
SIMD vi way_four_bytes(const heights_block *b, const char *from, vi at) {
    const uint32_t *cells = b->of->shape.cells;
    const int32_t last = (int32_t)(cells[0] + (cells[2] - 1) * b->slice) - 3;
    const vi past = (at - last) & (at > last);
    return i_gather(from, at - past) >> (past << 3);
}

/* The samples at two nodes that follow each other along axis 0, the first of which is `at` samples
 * behind `from`. */
SIMD void way_samples(const heights_block *b, const char *from, vi at, vf out[2]) {
    vi both;
    switch (b->type) {
    case SAMPLE_U8:
        both = way_four_bytes(b, from, at);
        out[0] = f_of_ints(both & i_set(255u));
        out[1] = f_of_ints(both >> 8 & i_set(255u));
        break;
    case SAMPLE_I8:
        both = way_four_bytes(b, from, at);
        out[0] = f_of_ints((both << 24) >> 24);
        out[1] = f_of_ints((both << 16) >> 24);
        break;
    case SAMPLE_U16:
        both = i_gather(from, at << 1);
        out[0] = f_of_ints(both & i_set(0xffffu));
        out[1] = f_of_ints(both >> 16 & i_set(0xffffu));
        break;
    case SAMPLE_I16:
        both = i_gather(from, at << 1);
        out[0] = f_of_ints((both << 16) >> 16);
        out[1] = f_of_ints(both >> 16);
        break;
    default:
        out[0] = (vf)i_gather(from, at << 2);
        out[1] = (vf)i_gather(from + sizeof(float), at << 2);
    }
}

/* The heights of cells, as codes. */
SIMD void way_heights(const way_block *b, const vf at[2], vf h[4]) {
    const heights_block *of = b->b;
    const char *from = of->first;
    /* Lanes without a way may be anywhere. */
    const vi node = f_to_int(way_clamp(at[0], b->last[0]) +
                             way_clamp(at[1], b->last[1]) * f_set((float)of->slice));
    way_samples(of, from, node, h);
    way_samples(of, from + of->slice * sample_size(of->type), node, h + 2);
    for (int c = 0; c < 4; c++)
        h[c] = (h[c] - f_set((float)b->least)) * f_set((float)b->codes);
}

/* The patch's height minus the way's, at s. */
SIMD vf way_lanes_height(const way_lanes *l, const vf at[2], const vf h[4], vf s, vf place[2]) {
    for (int a = 0; a < 2; a++)
        place[a] = l->o[a] + s * l->d[a] - at[a];
    const vf first = h[0] + place[0] * (h[1] - h[0]), last = h[2] + place[0] * (h[3] - h[2]);
    return first + place[1] * (last - first) - (l->o[2] + s * l->d[2]);
}

/* Lanes whose ways surely stay above the patch, or below it, from s to end: the difference of
 * heights is a quadratic polynomial, which is off the line between its ends by a quarter of its
 * greatest term at most. error: of heights. */
SIMD mf way_lanes_beside(const way_lanes *l, const vf at[2], const vf h[4], vf error, vf s,
                         vf end) {
    vf in[2], out[2];
    const vf first = way_lanes_height(l, at, h, s, in), last = way_lanes_height(l, at, h, end, out);
    const vf twist = (h[3] - h[2]) - (h[1] - h[0]);
    const vf bend = f_abs(twist * (out[0] - in[0]) * (out[1] - in[1])) * f_set(0.25f);
    const vf sure = bend + l->slack + error;
    return mf_or(f_gt(f_min(first, last), sure), f_lt(f_max(first, last), f_set(0.0f) - sure));
}

/* How far from their places, in cells, ways may be: in a cell that they stay in anywhere. */
SIMD vf way_lanes_error(const way_lanes *l) {
    vf sum = f_set(0.0f);
    for (int a = 0; a < 2; a++)
        sum = sum + f_select(f_eq(l->d[a], f_set(0.0f)), f_set(1.0f), l->near[a]);
    return sum;
}

/* Find the cells that ways may meet in VF_N nodes of 4 cells, from `from` on. */
static void ways_in_cells(const way_block *b, ways *w, unsigned from) {
    const way_steps *nodes = &w->nodes[1];
    way_steps *out = &w->cells;
    const vf one = f_set(1.0f);
    const vi node = i_load(nodes->at + from);
    const vf end = f_load(nodes->end + from);
    way_lanes l;
    vf at[2], t[2], corner[2], past[2], s = f_load(nodes->s + from);
    way_lanes_of(b, w, node & i_set(WAY_NUMBER), way_all(nodes->count - from), &l);
    way_steps_corner(node, corner);
    for (int a = 0; a < 2; a++)
        past[a] = f_min(corner[a] + f_set(3.5f), f_set(b->limit[a]));
    way_lanes_begin(b, &l, s, corner, f_set(4.0f), one, one, at);
    const vf error = way_lanes_error(&l);
    while (l.alive) {
        vf h[4];
        const vf next = way_lanes_next(&l, at, one, t);
        way_heights(b, at, h);
        const vf low = f_min(f_min(h[0], h[1]), f_min(h[2], h[3]));
        const vf high = f_max(f_max(h[0], h[1]), f_max(h[2], h[3]));
        vf in = s, stop = f_min(end, next);
        const mf misses = mf_or(way_lanes_cut(&l, low, high, &in, &stop),
                                way_lanes_beside(&l, at, h, (high - low) * error, in, stop));
        const unsigned found = l.alive & ~mf_bits(misses);
        if (found) {
            i_pack(out->at + out->count,
                   l.number | f_to_int(at[0]) << WAY_AXIS_0 | f_to_int(at[1]) << WAY_AXIS_2, found);
            out->count += (unsigned)__builtin_popcount(found);
        }
        way_lanes_step(&l, t, next, end, corner, past, one, at);
        s = next;
    }
    way_lanes_end(&l, w);
}

#endif
#endif
