/* medium_batch_template.h - medium_batch.h for the ISA of the translation unit that includes it.
 *
 * The scalar functions (medium_stretch.c) written again for vectors, operation by operation, where
 * a piece lies in one span of the transfer function and need not be halved. The others are left to
 * the scalar code.
 */
#ifndef RENDER_MEDIUM_BATCH_TEMPLATE_H
#define RENDER_MEDIUM_BATCH_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "formats/base/portable_math.h"

#include "render/medium_batch.h"

void SIMD_NAME(medium_batch)(medium_batch *m, const segment_columns *pieces);

/* The lanes' spans. */
typedef struct span_lanes {
    const transfer *transfer;
    uint16_t at[VD_N];
} span_lanes;

#define OF_SPAN(lanes, member) \
    d_load_at(transfer_column((lanes)->transfer, offsetof(transfer_span, member)), (lanes)->at)

/* ---- Pieces: only_span(), value_error_of() ---- */

typedef struct piece_lanes {
    vd b[4];
    vd length, value_error;
    span_lanes span;
    md seen;   /* something is, and the vector code can tell what */
    md single; /* the scalar code can */
} piece_lanes;

SIMD vd lanes_value_error(const medium_batch *m, const segment_columns *c, unsigned i, int degree,
                          const vd b[4], vd length) {
    vd largest = d_abs(b[0]), step = d_set(0.0);
    for (int k = 0; k < degree; k++) {
        largest = d_max(largest, d_abs(b[k + 1]));
        step = d_max(step, d_abs(b[k + 1] - b[k]));
    }
    const vd by_t = d_set(degree) * step * d_min(d_load(m->t_error + i) / length, d_set(1.0));
    (void)c;
    return d_load(m->value_error + i) + by_t + d_set(16.0 * 0x1p-53) * largest;
}

SIMD void load_pieces(const medium_batch *m, const segment_columns *c, unsigned i, int degree,
                      piece_lanes *p) {
    vd lo, hi;
    double least[VD_N];
    lo = hi = p->b[0] = d_load(c->b[0] + i);
    for (int k = 1; k <= degree; k++) {
        p->b[k] = d_load(c->b[k] + i);
        lo = d_min(lo, p->b[k]);
        hi = d_max(hi, p->b[k]);
    }
    p->length = d_load(c->t1 + i) - d_load(c->t0 + i);
    p->value_error = lanes_value_error(m, c, i, degree, p->b, p->length);
    d_store(least, lo);
    p->span.transfer = m->transfer;
    const unsigned lanes = c->count - i < VD_N ? c->count - i : VD_N;
    for (unsigned k = 0; k < VD_N; k++)
        p->span.at[k] = k < lanes ? (uint16_t)transfer_find(m->transfer, least[k]) : 0;
    const md here = md_of_bits((1u << lanes) - 1);
    const md below = d_lt(hi, OF_SPAN(&p->span, to));
    const md from = d_ge(lo - p->value_error, OF_SPAN(&p->span, reach[0]));
    const md to = d_lt(hi + p->value_error, OF_SPAN(&p->span, reach[1]));
    const md only = md_and(md_and(below, here), md_and(from, to));
    const vd nothing = d_set(0.0);
    const md empty =
        md_and(d_eq(OF_SPAN(&p->span, k[0]), nothing), d_eq(OF_SPAN(&p->span, k[1]), nothing));
    p->seen = md_and_not(only, empty);
    p->single = md_and_not(here, only);
}

/* ---- A stretch: complete(), weighted_change(), seen_at_once() ---- */

typedef struct smooth_lanes {
    vd w[4], k[4], depth, variance;
} smooth_lanes;

SIMD void complete_lanes(const piece_lanes *p, int degree, smooth_lanes *s) {
    const vd k0 = OF_SPAN(&p->span, k[0]), k1 = OF_SPAN(&p->span, k[1]);
    const vd base = OF_SPAN(&p->span, base), inverse = OF_SPAN(&p->span, inverse);
    const md unknown = d_ge(p->value_error * inverse, d_set(1.0));
    vd sum = d_set(0.0);
    s->variance = d_set(0.0);
    for (int i = 0; i <= degree; i++) {
        const vd w = (p->b[i] - base) * inverse;
        const vd known = d_select(d_gt(w, d_set(-4.0)), d_min(w, d_set(5.0)), d_set(-4.0));
        s->w[i] = d_select(unknown, d_set(0.5), known);
        s->k[i] = (d_set(1.0) - s->w[i]) * k0 + s->w[i] * k1;
        if (i > 0)
            s->variance = s->variance + d_abs(s->w[i] - s->w[i - 1]);
        sum = sum + s->k[i];
    }
    s->depth = d_max(sum / d_set(degree + 1) * p->length, d_set(0.0));
}

SIMD vd moment_lanes(const smooth_lanes *s, int degree, const vd depth[5]) {
    static const double weight[3][5] = MEDIUM_MOMENT;
    vd sum = d_set(0.0);
    if (degree == 1) {
        for (int i = 0; i <= 2; i++)
            sum = sum + depth[i];
        return (s->w[1] - s->w[0]) * (sum / d_set(3.0));
    }
    for (int i = 0; i < 3; i++) {
        vd row = d_set(0.0);
        for (int j = 0; j < 5; j++)
            row = row + d_set(weight[i][j]) * depth[j];
        sum = sum + (s->w[i + 1] - s->w[i]) * row;
    }
    return sum;
}

SIMD vd change_lanes(const piece_lanes *p, const smooth_lanes *s, int degree, vd half,
                     vd through_half) {
    vd depth[5];
    depth[0] = d_set(0.0);
    for (int i = 0; i <= degree; i++)
        depth[i + 1] = depth[i] + p->length * s->k[i] / d_set(degree + 1);
    return through_half *
           ((d_set(1.0) + half) * (s->w[degree] - s->w[0]) - moment_lanes(s, degree, depth));
}

/* portable_exp() of x <= 0. */
SIMD vd exp_lanes(vd x) {
    typedef int64_t vl __attribute__((vector_size(sizeof(vd))));
    static const double series[] = PORTABLE_EXP_SERIES;
    const vd ordinary = d_max(x, d_set(-700.0));
    const vd rounder = d_set(PORTABLE_ROUNDER);
    const vd n = ordinary * d_set(PORTABLE_LOG2_E) + rounder - rounder;
    const vd r = (ordinary - n * d_set(PORTABLE_LN2_HIGH)) - n * d_set(PORTABLE_LN2_LOW);
    vd p = d_set(series[0]);
    for (size_t i = 1; i < sizeof series / sizeof *series; i++)
        p = p * r + d_set(series[i]);
    const vd value = d_set(1.0) + (r + r * r * p);
    /* 2^n: n + 1023 are the lowest bits of the sum. */
    const vl bits = (vl)(n + d_set(0x1.8p52 + 1023.0)) << 52;
    return d_select(d_lt(x, d_set(-700.0)), d_set(0.0), value * (vd)bits);
}

/* Returns the lanes that need not be halved. */
SIMD md see_lanes(medium_batch *m, unsigned i, int degree, const piece_lanes *p) {
    const double u = 0x1p-53;
    const vd one = d_set(1.0), zero = d_set(0.0), rounding = d_set(64.0 * u);
    smooth_lanes s;
    complete_lanes(p, degree, &s);
    const vd half = d_set(0.5) * s.depth, through_half = exp_lanes(zero - half);
    const md thin = d_lt(half, one);
    const vd bend = d_select(thin, d_set(0.25) * (half * half), d_set(0.5));
    const vd change = d_select(thin, change_lanes(p, &s, degree, half, through_half), zero) +
                      bend * (s.w[degree] - s.w[0]);
    const vd first = s.w[0], last = s.w[degree], through = through_half * through_half;
    const vd most_rgb = OF_SPAN(&p->span, most_rgb);
    for (int c = 0; c < 3; c++) {
        const vd c0 = OF_SPAN(&p->span, rgb[0][c]), c1 = OF_SPAN(&p->span, rgb[1][c]);
        const vd at_first = (one - first) * c0 + first * c1,
                 at_last = (one - last) * c0 + last * c1;
        const vd seen = (at_first - through * at_last) + (c1 - c0) * change;
        d_store(m->rgb[c] + i, d_min(d_max(seen, zero), most_rgb));
    }
    const vd spread = OF_SPAN(&p->span, rgb_change) * s.variance;
    const vd tangent = spread * bend;
    const vd depth_error =
        (p->value_error * OF_SPAN(&p->span, k_rate) + d_set(8.0 * u) * OF_SPAN(&p->span, most_k)) *
        p->length;
    const vd shift = d_min(d_set(1.5) * depth_error, one) + rounding;
    const vd through_error =
        d_select(d_lt(depth_error, d_set(0.5)), through * shift + rounding, one);
    const vd opacity = one - through;
    const vd rgb_error =
        (tangent + shift * (most_rgb + spread)) +
        (d_min(p->value_error * OF_SPAN(&p->span, rgb_rate), most_rgb) * (opacity + rounding) +
         rounding * most_rgb);
    const vd allowed = d_set(m->share) * opacity + d_load(m->per_length + i) * p->length;
    /* add_ends() */
    const double most = 2.0 * m->transfer->most_k;
    const vd ends = d_min(d_set(1.5) * (d_load(m->t_error + i) * d_set(most)), one);
    d_store(m->through + i, through);
    d_store(m->through_error + i, d_min(through_error + ends, one));
    d_store(m->rgb_error + i, rgb_error + ends * d_set(m->transfer->most_rgb));
    return md_or(d_le(tangent, allowed), d_gt(rgb_error - tangent, allowed));
}

SIMD void see_pieces(medium_batch *m, const segment_columns *c, int degree) {
    for (unsigned i = 0; i < c->count; i += VD_N) {
        piece_lanes p;
        load_pieces(m, c, i, degree, &p);
        unsigned seen = md_bits(p.seen), single = md_bits(p.single);
        if (seen) {
            const unsigned done = md_bits(see_lanes(m, i, degree, &p));
            single |= seen & ~done;
            seen &= done;
        }
        for (unsigned k = 0; k < VD_N; k++)
            m->seen[i + k] = (uint8_t)(seen >> k & 1u);
        for (; single; single &= single - 1)
            medium_batch_single(m, c, i + (unsigned)__builtin_ctz(single));
    }
}

void SIMD_NAME(medium_batch)(medium_batch *m, const segment_columns *pieces) {
    if (pieces->degree == 1)
        see_pieces(m, pieces, 1);
    else
        see_pieces(m, pieces, 3);
}

#endif
#endif
