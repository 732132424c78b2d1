/* cell_batch_template.h - cell_batch.h for the ISA of the translation unit that includes it.
 *
 * These are the scalar functions of cell_kernel.c, written again for vectors, operation by
 * operation. Each lane is rounded exactly as in the scalar code; branches have become masks. The
 * scalar code still computes the lanes whose control polygon changes sides more than once, or has
 * an end at the isovalue.
 *
 * The lanes with a root are packed before they are refined: about one in three of the active cells
 * that rays meet has one.
 */
#ifndef RENDER_GRID_CELL_BATCH_TEMPLATE_H
#define RENDER_GRID_CELL_BATCH_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include <math.h>
#include <string.h>

#include "render/grid/cell_batch.h"
#include "render/grid/cell_kernel.h"
#include "render/grid/cell_visit_template.h"

void SIMD_NAME(cell_batch)(const cell_batch *b, int lanes, const double *isovalues, int count,
                           cell_batch_hits *out);
void SIMD_NAME(cell_roots)(const cell_batch *b, int lanes, double isovalue, cell_batch_roots *out);

enum { VECTORS = CELL_BATCH / VD_N, VECTOR_LANES = (1 << VD_N) - 1, PACK_MAX = CELL_BATCH - 4 };

/* ---- the cubic: cell_cubic() ---- */

/* Subtract the isovalue from the samples. Returns the active lanes. */
SIMD md differences(const cell_batch *b, int at, vd iso, vd f[8]) {
    md any = md_of_bits(0), all = md_of_bits(VECTOR_LANES);
    for (int i = 0; i < 8; i++) {
        f[i] = d_of_floats(b->samples[i] + at) - iso;
        const md inside = d_ge(f[i], d_set(0.0));
        any = md_or(any, inside);
        all = md_and(all, inside);
    }
    return md_and_not(any, all);
}

/* ---- cell_roots(), the first of them ---- */

typedef struct search {
    vd c[4], lo, hi, reach, s;
    md side_lo, going;
} search;

/* Begin the search for the only root of cubics with control values b, whose ends lie on different
 * sides. */
SIMD search search_begin(const double b[4][CELL_BATCH], int at, unsigned lanes) {
    const vd three = d_set(3.0), b0 = d_load(b[0] + at), b1 = d_load(b[1] + at),
             b2 = d_load(b[2] + at), b3 = d_load(b[3] + at);
    return (search){.c = {b0, three * (b1 - b0), three * ((b2 - b1) - (b1 - b0)),
                          (b3 - b0) - three * (b2 - b1)},
                    .lo = d_set(0.0),
                    .hi = d_set(1.0),
                    .reach = d_set(1.0),
                    .s = b0 / (b0 - b3),
                    .side_lo = d_ge(b0, d_set(0.0)),
                    .going = md_of_bits(lanes)};
}

/* One step of refine(). */
SIMD void search_step(search *r) {
    const vd s = r->s, half = d_set(0.5), one = d_set(1.0), last_bit = d_set(CELL_LAST_BIT);
    const vd c3_s = s * r->c[3], h2 = r->c[2] + c3_s, h1 = r->c[1] + s * h2, f = r->c[0] + s * h1;
    const vd g2 = h2 + c3_s, slope = h1 + s * g2, bend = g2 + c3_s;
    const md past = md_xor(d_ge(f, d_set(0.0)), r->side_lo);
    const vd lo = d_select(past, r->lo, s), hi = d_select(past, s, r->hi);
    const vd per_slope = one / slope, newton = f * per_slope;
    const vd q = bend * per_slope * newton, qq = q * q;
    const vd third = r->c[3] * per_slope * newton * newton;
    const vd z = qq + d_abs(third), series = newton * (one + (q + ((qq + qq) - third)));
    const vd move = d_select(d_le(z, d_set(CELL_SERIES_USED)), series, newton);
    const vd next = s - move, length = d_abs(move);
    const md accepted = md_and(md_and(d_ge(next, lo), d_le(next, hi)), d_le(length, r->reach));
    const vd rest = d_abs(newton) * (z * (d_set(5.0) * d_abs(q) + d_set(48.0) * z));
    const md settled = md_or(md_and(d_le(z, d_set(CELL_SERIES_SURE)), d_le(rest, last_bit)),
                             d_le(length, last_bit));
    const vd width = half * (hi - lo);
    const md closed = md_and_not(d_le(width, last_bit), accepted);
    r->lo = lo;
    r->hi = hi;
    r->s = d_select(r->going, d_select(accepted, next, half * (lo + hi)), s);
    r->reach = d_select(accepted, half * length, width);
    r->going = md_and_not(r->going, md_or(md_and(accepted, settled), closed));
}

/* Search two vectors at a time: one waits for its division while the other works. */
static void search_all(const double b[4][CELL_BATCH], unsigned lanes, double roots[CELL_BATCH]) {
    for (int at = 0; lanes >> at; at += 2 * VD_N) {
        search x = search_begin(b, at, lanes >> at & VECTOR_LANES);
        const unsigned others = lanes >> at >> VD_N & VECTOR_LANES;
        if (others) {
            search y = search_begin(b, at + VD_N, others);
            for (int step = 0; step < CELL_STEPS_MAX && md_bits(md_or(x.going, y.going)); step++) {
                search_step(&x);
                search_step(&y);
            }
            d_store(roots + at + VD_N, y.s);
        } else {
            for (int step = 0; step < CELL_STEPS_MAX && md_bits(x.going); step++)
                search_step(&x);
        }
        d_store(roots + at, x.s);
    }
}

/* Search a few lanes, packed side by side. */
static void search_packed(const double b[4][CELL_BATCH], unsigned lanes, double roots[CELL_BATCH]) {
    _Alignas(64) double packed[4][CELL_BATCH], found[CELL_BATCH];
    int n = 0;
    for (unsigned rest = lanes; rest; rest &= rest - 1, n++)
        for (int i = 0; i < 4; i++)
            packed[i][n] = b[i][__builtin_ctz(rest)];
    search_all(packed, (1u << n) - 1, found);
    n = 0;
    for (unsigned rest = lanes; rest; rest &= rest - 1, n++)
        roots[__builtin_ctz(rest)] = found[n];
}

/* Sort the active lanes. *plain: the control polygon clearly changes sides once. *hard: the lane
 * needs the scalar code. Lanes without a change of side are in neither. */
SIMD void classify(const vd b[4], md active, md *plain, md *hard) {
    const vd zero = d_set(0.0);
    const md s0 = d_ge(b[0], zero), s1 = d_ge(b[1], zero), s2 = d_ge(b[2], zero),
             s3 = d_ge(b[3], zero);
    const md first = md_xor(s0, s1), second = md_xor(s1, s2), third = md_xor(s2, s3);
    const md some = md_and(active, md_or(md_or(first, second), third));
    const md one =
        md_and_not(md_xor(md_xor(first, second), third), md_and(md_and(first, second), third));
    const vd end0 = d_abs(b[0]), end3 = d_abs(b[3]);
    const vd largest = d_max(d_max(end0, d_abs(b[1])), d_max(d_abs(b[2]), end3));
    const vd near = d_set(CELL_NEAR_END) * d_and_bits(largest, CELL_EXPONENT_BITS);
    const md clear = md_and(d_gt(end0, near), d_gt(end3, near));
    const md ordinary =
        md_and(d_ge(largest, d_set(CELL_ORDINARY_MIN)), d_le(largest, d_set(CELL_ORDINARY_MAX)));
    *plain = md_and(md_and(some, one), md_and(clear, ordinary));
    *hard = md_and_not(some, *plain);
}

/* Find the first roots of the lanes `hard` by the scalar code. Returns the lanes that have one. */
static unsigned scalar_roots(const double b[4][CELL_BATCH], unsigned hard, double s[CELL_BATCH]) {
    unsigned has = 0;
    for (unsigned rest = hard; rest; rest &= rest - 1) {
        const int lane = __builtin_ctz(rest);
        const double control[4] = {b[0][lane], b[1][lane], b[2][lane], b[3][lane]};
        double roots[3];
        if (cell_roots(control, roots) > 0) {
            s[lane] = roots[0];
            has |= 1u << lane;
        }
    }
    return has;
}

/* The cubics of the lanes that visit active cells. plain, hard: as classify() sorts them. outside:
 * they begin below the isovalue. */
typedef struct cubics {
    _Alignas(64) double control[4][CELL_BATCH];
    unsigned plain, hard, outside;
} cubics;

SIMD void cubics_of(const cell_batch *b, const visits v[VECTORS], unsigned visited, double iso,
                    cubics *q) {
    q->plain = q->hard = q->outside = 0;
    for (int k = 0, at = 0; k < VECTORS; k++, at += VD_N) {
        vd f[8], c[4];
        md one, several;
        const md active =
            md_and(differences(b, at, d_set(iso), f), md_of_bits(visited >> at & VECTOR_LANES));
        if (!md_bits(active))
            continue;
        cubic(&v[k], f, c);
        classify(c, active, &one, &several);
        for (int i = 0; i < 4; i++)
            d_store(q->control[i] + at, c[i]);
        q->plain |= md_bits(one) << at;
        q->hard |= md_bits(several) << at;
        q->outside |= md_bits(d_lt(c[0], d_set(0.0))) << at;
    }
}

/* Find the roots of the lanes `plain`. */
SIMD void plain_roots(const cubics *q, double s[CELL_BATCH]) {
    if (__builtin_popcount(q->plain) > PACK_MAX)
        search_all(q->control, q->plain, s);
    else if (q->plain)
        search_packed(q->control, q->plain, s);
}

/* Find the first roots of the lanes `visited`. Parameters go to s; returns the lanes that have one.
 */
SIMD unsigned first_roots(const cell_batch *b, const visits v[VECTORS], unsigned visited,
                          double iso, double s[CELL_BATCH], unsigned *entering) {
    cubics q;
    cubics_of(b, v, visited, iso, &q);
    *entering = q.outside;
    plain_roots(&q, s);
    return q.plain | scalar_roots(q.control, q.hard, s);
}

/* ---- a batch ---- */

/* Turn the roots of isovalue i into hits. The lanes `has` have a root, at the parameter s. A root
 * becomes its lane's hit if it is nearer than the lane's best hit. */
SIMD void report(const visits *v, int at, const double *s, unsigned has, unsigned entering, int i,
                 vd *best, cell_batch_hits *out) {
    const vd at_s = d_load(s + at), line = v->t_in + at_s * (v->t_out - v->t_in);
    const md before = md_and(d_lt(at_s, d_set(1.0)), d_lt(line, v->t_out));
    const vd t = d_select(before, line, v->t_out);
    const unsigned first = md_bits(d_lt(t, *best)) | ~(out->found >> at);
    const unsigned take = has >> at & VECTOR_LANES & first;
    const unsigned exits = md_bits(d_eq(t, v->t_out));
    *best = d_select(md_of_bits(take), t, *best);
    d_store(out->t + at, *best);
    out->found |= take << at;
    out->entering = (out->entering & ~(take << at)) | (take << at & entering);
    out->at_exit = (out->at_exit & ~(take << at)) | (take & exits) << at;
    for (int k = 0; k < VD_N; k++)
        out->iso[at + k] = i == 0 || take >> k & 1u ? i : out->iso[at + k];
}

void SIMD_NAME(cell_batch)(const cell_batch *b, int lanes, const double *isovalues, int count,
                           cell_batch_hits *out) {
    visits v[VECTORS];
    vd best[VECTORS];
    unsigned visited = 0;
    for (int k = 0, at = 0; at < lanes; k++, at += VD_N) {
        best[k] = d_set(INFINITY);
        visited |= md_bits(visits_of(b, at, &v[k])) << at;
    }
    visited &= (1u << lanes) - 1;
    out->found = out->entering = out->at_exit = 0;
    for (int i = 0; i < count; i++) {
        _Alignas(64) double s[CELL_BATCH];
        unsigned entering;
        const unsigned has = first_roots(b, v, visited, isovalues[i], s, &entering);
        for (int k = 0, at = 0; has >> at; k++, at += VD_N)
            if (has >> at & VECTOR_LANES)
                report(&v[k], at, s, has, entering, i, &best[k], out);
    }
}

/* ---- all roots ---- */

/* Find all roots of the lanes that need the scalar code. s: by number, then by lane. */
static void all_scalar_roots(const cubics *q, double s[CELL_ROOTS_MAX][CELL_BATCH],
                             cell_batch_roots *out) {
    for (unsigned rest = q->hard; rest; rest &= rest - 1) {
        const int lane = __builtin_ctz(rest);
        const double control[4] = {q->control[0][lane], q->control[1][lane], q->control[2][lane],
                                   q->control[3][lane]};
        double roots[CELL_ROOTS_MAX];
        const int count = cell_roots(control, roots);
        for (int n = 0; n < count; n++) {
            s[n][lane] = roots[n];
            out->found[n] |= 1u << lane;
        }
    }
}

/* Convert the parameters of the n-th roots to t. */
SIMD void place_roots(const visits *v, int at, int n, const double *s, cell_batch_roots *out) {
    const vd at_s = d_load(s + at), line = v->t_in + at_s * (v->t_out - v->t_in);
    const md before = md_and(d_lt(at_s, d_set(1.0)), d_lt(line, v->t_out));
    const vd t = d_select(before, line, v->t_out);
    d_store(out->t[n] + at, t);
    out->at_exit[n] |= (md_bits(d_eq(t, v->t_out)) & VECTOR_LANES) << at;
}

void SIMD_NAME(cell_roots)(const cell_batch *b, int lanes, double isovalue, cell_batch_roots *out) {
    visits v[VECTORS];
    cubics q;
    _Alignas(64) double s[CELL_ROOTS_MAX][CELL_BATCH];
    unsigned visited = 0;
    for (int k = 0, at = 0; at < lanes; k++, at += VD_N)
        visited |= md_bits(visits_of(b, at, &v[k])) << at;
    cubics_of(b, v, visited & ((1u << lanes) - 1), isovalue, &q);
    plain_roots(&q, s[0]);
    memset(out->found, 0, sizeof out->found);
    memset(out->at_exit, 0, sizeof out->at_exit);
    out->found[0] = q.plain;
    all_scalar_roots(&q, s, out);
    for (int n = 0; n < CELL_ROOTS_MAX; n++) {
        out->entering[n] = n % 2 == 0 ? q.outside : ~q.outside;
        for (int k = 0, at = 0; out->found[n] >> at; k++, at += VD_N)
            if (out->found[n] >> at & VECTOR_LANES)
                place_roots(&v[k], at, n, s[n], out);
    }
}

#endif
#endif
