/* stepping_batch_template.h - stepping_batch.h for the ISA of the translation unit that includes
 * it: the scalar functions (stepping_batch.c) written again for vectors, operation by operation. A
 * lane is a piece.
 */
#ifndef RENDER_EXPERIMENTS_STEPPING_BATCH_TEMPLATE_H
#define RENDER_EXPERIMENTS_STEPPING_BATCH_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "formats/base/simd_exp.h"
#include "render/experiments/stepping_batch.h"

void SIMD_NAME(stepping_batch)(stepping_batch *m, const segment_columns *pieces);

/* A member of spans; at: how many doubles each lies behind the first span. */
#define OF_SPANS(m, member, at) d_gather(&(m)->transfer->span->member, at)

/* Offsets of spans, in doubles, by their number. */
SIMD vl span_at(vd number) {
    return l_mul((vl)(number + d_set(0x1p52)), l_set(sizeof(transfer_span) / sizeof(double)));
}

/* Vector form of transfer_find(). */
SIMD vl find_spans(const stepping_batch *m, double widest, vd value) {
    const vd last = d_set(m->transfer->spans - 1);
    vd at = d_set(0.0);
    for (double step = widest; step >= 1.0; step *= 0.5) {
        const vd next = d_min(at + d_set(step), last);
        at = d_select(d_le(OF_SPANS(m, from, span_at(next)), value), next, at);
    }
    return span_at(at);
}

typedef struct stepping_lanes {
    vd from, to, t0, t1, shrink, power[4];
    vd rgb[3], through;
} stepping_lanes;

SIMD void load_lanes(const stepping_batch *m, const segment_columns *c, unsigned i, int degree,
                     stepping_lanes *p) {
    const vd b0 = d_load(c->b[0] + i), b1 = d_load(c->b[1] + i), three = d_set(3.0);
    p->from = d_load(m->from + i);
    p->to = d_load(m->to + i);
    p->t0 = d_load(c->t0 + i);
    p->t1 = d_load(c->t1 + i);
    p->shrink = d_set(1.0) / (p->t1 - p->t0);
    p->power[0] = b0;
    p->power[1] = b1 - b0;
    if (degree == 3) {
        const vd b2 = d_load(c->b[2] + i), b3 = d_load(c->b[3] + i);
        p->power[1] = three * (b1 - b0);
        p->power[2] = three * ((b2 - b1) - (b1 - b0));
        p->power[3] = (b3 - b0) - three * (b2 - b1);
    }
    p->through = d_set(1.0);
    p->rgb[0] = p->rgb[1] = p->rgb[2] = d_set(0.0);
}

SIMD void take_samples(const stepping_batch *m, double widest, md live, vd value, vd length,
                       stepping_lanes *p) {
    const vd one = d_set(1.0), zero = d_set(0.0);
    const vl at = find_spans(m, widest, value);
    const vd w = (value - OF_SPANS(m, base, at)) * OF_SPANS(m, inverse, at), rest = one - w;
    const vd k = rest * OF_SPANS(m, k[0], at) + w * OF_SPANS(m, k[1], at);
    live = md_and(live, d_gt(k, zero)); /* without extinction the sums do not change */
    if (!md_bits(live))
        return;
    const vd through = simd_exp(zero - k * length), share = p->through * (one - through);
    for (int c = 0; c < 3; c++) {
        const vd rgb = rest * OF_SPANS(m, rgb[0][c], at) + w * OF_SPANS(m, rgb[1][c], at);
        p->rgb[c] = d_select(live, p->rgb[c] + share * rgb, p->rgb[c]);
    }
    p->through = d_select(live, p->through * through, p->through);
}

SIMD void take_pieces(stepping_batch *m, const segment_columns *c, int degree) {
    const vd rounder = d_set(PORTABLE_ROUNDER), one = d_set(1.0), half = d_set(0.5);
    const vd step = d_set(m->step);
    double widest = 0.5;
    while (2.0 * widest < m->transfer->spans)
        widest *= 2.0;
    for (unsigned i = 0; i < c->count; i += VD_N) {
        const unsigned lanes = c->count - i < VD_N ? c->count - i : VD_N;
        const md here = md_of_bits((1u << lanes) - 1);
        stepping_lanes p;
        load_lanes(m, c, i, degree, &p);
        vd n = (((p.t0 - p.from) * d_set(m->inverse) - half) + rounder) - rounder;
        for (n = d_max(n, d_set(0.0));; n = n + one) {
            const vd begin = p.from + n * step, end = d_min(p.from + (n + one) * step, p.to);
            const vd t = half * (begin + end);
            const md more = md_and(here, md_and(d_lt(begin, p.to), d_lt(t, p.t1)));
            if (!md_bits(more))
                break;
            const md live = md_and(more, d_ge(t, p.t0));
            if (!md_bits(live))
                continue;
            const vd s = (t - p.t0) * p.shrink;
            const vd value =
                degree == 1 ? p.power[0] + s * p.power[1]
                            : p.power[0] + s * (p.power[1] + s * (p.power[2] + s * p.power[3]));
            take_samples(m, widest, live, value, end - begin, &p);
        }
        d_store(m->through + i, p.through);
        for (int k = 0; k < 3; k++)
            d_store(m->rgb[k] + i, p.rgb[k]);
    }
}

void SIMD_NAME(stepping_batch)(stepping_batch *m, const segment_columns *pieces) {
    if (pieces->degree == 1)
        take_pieces(m, pieces, 1);
    else
        take_pieces(m, pieces, 3);
}

#endif
#endif
