/* medium_batch_template.h - medium_batch.h for the ISA of the translation unit that includes it.
 *
 * These are the scalar functions of medium_stretch.c, written again for vectors, operation by
 * operation. A first pass goes over the columns. It finishes each piece that lies in one span of
 * the transfer function and needs no steps. The other pieces are cut into stretches, which go to
 * dense lists. Cuts are found, stretches computed and steps made a vector at a time. Pieces at a
 * step of the transfer function, or in too many spans, are left to the scalar code.
 */
#ifndef RENDER_MEDIUM_MEDIUM_BATCH_TEMPLATE_H
#define RENDER_MEDIUM_MEDIUM_BATCH_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "formats/base/simd_exp.h"
#include "render/medium/medium_batch.h"

void SIMD_NAME(medium_batch)(medium_batch *m, const segment_columns *pieces);

/* One span per lane: those members of transfer_span that are needed. */
typedef struct span_lanes {
    vd base, inverse, k[2];
    vd rgb[2][3], most_rgb, rgb_change;
    vd most_k, k_rate, rgb_rate;
} span_lanes;

/* Load four members of each lane's span: `member` and the three that follow it in memory. */
#define LOAD_SPANS(t, at, member, out)                                \
    d_load_four((const double *)(const void *)(t)->span +             \
                    offsetof(transfer_span, member) / sizeof(double), \
                (int)(sizeof(transfer_span) / sizeof(double)), at, out)

SIMD void find_members(const transfer *t, vl at, size_t offset, int count, vd out[]) {
    const double *column = t->column + offset / sizeof(double) * TRANSFER_FEW;
    for (int i = 0; i < count; i++)
        out[i] = d_look_up_half(column + i * TRANSFER_FEW, at);
}

/* Look up `count` members of each lane's span: `member` and those that follow it in memory. */
#define FIND_SPANS(t, at, member, count, out) \
    find_members(t, at, offsetof(transfer_span, member), count, out)

SIMD void look_up_spans(const transfer *t, vl at, span_lanes *s) {
    vd pair[2], rates[3];
    FIND_SPANS(t, at, base, 1, &s->base);
    FIND_SPANS(t, at, inverse, 1, &s->inverse);
    FIND_SPANS(t, at, k, 2, s->k);
    FIND_SPANS(t, at, rgb[0], 3, s->rgb[0]);
    FIND_SPANS(t, at, rgb[1], 3, s->rgb[1]);
    FIND_SPANS(t, at, most_rgb, 2, pair);
    s->most_rgb = pair[0];
    s->rgb_change = pair[1];
    FIND_SPANS(t, at, most_k, 3, rates);
    s->most_k = rates[0];
    s->k_rate = rates[1];
    s->rgb_rate = rates[2];
}

SIMD void load_spans(const transfer *t, const uint16_t at[], span_lanes *s) {
    vd four[4];
    if (D_LOOKS_UP && t->column) {
        look_up_spans(t, l_of_shorts(at), s);
        return;
    }
    LOAD_SPANS(t, at, base, four);
    s->base = four[0];
    s->inverse = four[1];
    s->k[0] = four[2];
    s->k[1] = four[3];
    LOAD_SPANS(t, at, rgb, four);
    for (int c = 0; c < 3; c++)
        s->rgb[0][c] = four[c];
    s->rgb[1][0] = four[3];
    LOAD_SPANS(t, at, rgb[1][1], four);
    s->rgb[1][1] = four[0];
    s->rgb[1][2] = four[1];
    s->most_rgb = four[2];
    s->rgb_change = four[3];
    LOAD_SPANS(t, at, most_k, four);
    s->most_k = four[0];
    s->k_rate = four[1];
    s->rgb_rate = four[2];
}

/* Load from, to and reach[] of each lane's span. */
SIMD void load_ends(const transfer *t, const uint16_t at[], vd ends[4]) {
    if (D_LOOKS_UP && t->column)
        FIND_SPANS(t, l_of_shorts(at), from, 4, ends);
    else
        LOAD_SPANS(t, at, from, ends);
}

/* ---- Stretches ---- */

/* One stretch per lane, each in one span. f: Bernstein coefficients of the value. */
typedef struct stretch_lanes {
    vd f[4];
    vd length, value_error;
    vd per_length;
    span_lanes span;
} stretch_lanes;

typedef struct seen_lanes {
    vd rgb[3], through, rgb_error, through_error;
    vd tangent, allowed;
} seen_lanes;

typedef struct smooth_lanes {
    vd w[4], k[4], depth, variance;
} smooth_lanes;

/* Vector form of complete(). */
SIMD void complete_lanes(const stretch_lanes *p, int degree, smooth_lanes *s) {
    const vd k0 = p->span.k[0], k1 = p->span.k[1];
    const vd base = p->span.base, inverse = p->span.inverse;
    const md unknown = d_ge(p->value_error * inverse, d_set(1.0));
    vd sum = d_set(0.0);
    s->variance = d_set(0.0);
    for (int i = 0; i <= degree; i++) {
        const vd w = (p->f[i] - base) * inverse;
        const vd known = d_select(d_gt(w, d_set(-4.0)), d_min(w, d_set(5.0)), d_set(-4.0));
        s->w[i] = d_select(unknown, d_set(0.5), known);
        s->k[i] = (d_set(1.0) - s->w[i]) * k0 + s->w[i] * k1;
        if (i > 0)
            s->variance = s->variance + d_abs(s->w[i] - s->w[i - 1]);
        sum = sum + s->k[i];
    }
    s->depth = d_max(sum / d_set(degree + 1) * p->length, d_set(0.0));
}

/* Vector form of depth_moment(). */
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

/* Vector form of weighted_change(). */
SIMD vd change_lanes(const stretch_lanes *p, const smooth_lanes *s, int degree, vd half,
                     vd through_half) {
    vd depth[5];
    depth[0] = d_set(0.0);
    for (int i = 0; i <= degree; i++)
        depth[i + 1] = depth[i] + p->length * s->k[i] / d_set(degree + 1);
    return through_half *
           ((d_set(1.0) + half) * (s->w[degree] - s->w[0]) - moment_lanes(s, degree, depth));
}

/* Vector form of seen_at_once(). */
SIMD void see_lanes(double share, int degree, const stretch_lanes *p, seen_lanes *out) {
    const double u = 0x1p-53;
    const vd one = d_set(1.0), zero = d_set(0.0), rounding = d_set(64.0 * u);
    smooth_lanes s;
    complete_lanes(p, degree, &s);
    const vd half = d_set(0.5) * s.depth, through_half = simd_exp(zero - half);
    const md thin = d_lt(half, one);
    const vd bend = d_select(thin, d_set(0.25) * (half * half), d_set(0.5));
    const vd change = d_select(thin, change_lanes(p, &s, degree, half, through_half), zero) +
                      bend * (s.w[degree] - s.w[0]);
    const vd first = s.w[0], last = s.w[degree], through = through_half * through_half;
    const vd most_rgb = p->span.most_rgb;
    for (int c = 0; c < 3; c++) {
        const vd c0 = p->span.rgb[0][c], c1 = p->span.rgb[1][c];
        const vd at_first = (one - first) * c0 + first * c1,
                 at_last = (one - last) * c0 + last * c1;
        const vd seen = (at_first - through * at_last) + (c1 - c0) * change;
        out->rgb[c] = d_min(d_max(seen, zero), most_rgb);
    }
    const vd spread = p->span.rgb_change * s.variance;
    const vd depth_error =
        (p->value_error * p->span.k_rate + d_set(8.0 * u) * p->span.most_k) * p->length;
    const vd shift = d_min(d_set(1.5) * depth_error, one) + rounding;
    const vd opacity = one - through;
    out->tangent = spread * bend;
    out->through = through;
    out->through_error = d_select(d_lt(depth_error, d_set(0.5)), through * shift + rounding, one);
    out->rgb_error = (out->tangent + shift * (most_rgb + spread)) +
                     (d_min(p->value_error * p->span.rgb_rate, most_rgb) * (opacity + rounding) +
                      rounding * most_rgb);
    out->allowed = d_max(d_set(share) * opacity + p->per_length * p->length,
                         d_set(MEDIUM_STEP_OF_REST) * (out->rgb_error - out->tangent));
}

/* Returns the lanes that need no steps: whose fit is 1 or more in seen_between(). */
SIMD md is_enough(const seen_lanes *s) {
    return d_le(s->tangent, s->allowed);
}

/* Vector form of next_step(). */
SIMD vd next_step_lanes(vd step, const seen_lanes *s) {
    const vd ratio = s->allowed / s->tangent;
    const vd fit = d_select(is_enough(s), d_max(ratio, d_set(1.0)), ratio);
    const vd by = d_max(d_set(MEDIUM_STEP_SHARE) * d_sqrt(fit), d_set(MEDIUM_STEP_LEAST));
    return step * d_min(by, d_set(MEDIUM_STEP_MOST));
}

/* ---- Pieces in their places ---- */

typedef struct piece_lanes {
    stretch_lanes whole;
    md seen;   /* something is seen, and the piece is in one span */
    md single; /* it is not in one span, but in spans low to high */
    uint16_t low[VD_N], high[VD_N];
} piece_lanes;

/* Vector form of segment_value_error(). */
SIMD vd lanes_value_error(const medium_batch *m, unsigned i, int degree, const vd b[4], vd length,
                          md even) {
    vd largest = d_abs(b[0]), step = d_set(0.0);
    for (int k = 0; k < degree; k++) {
        largest = d_max(largest, d_abs(b[k + 1]));
        step = d_max(step, d_abs(b[k + 1] - b[k]));
    }
    const vd by_t = d_set(degree) * step * d_min(d_load(m->t_error + i) / length, d_set(1.0));
    const vd error = d_load(m->value_error + i) + by_t + d_set(16.0 * 0x1p-53) * largest;
    return d_select(even, d_set(0.0), error);
}

/* With up to so many spans, comparing with all of them is faster than a binary search. */
enum { COUNTED_SPANS = 5 * VD_N };

/* Returns how many spans begin at the value or below. Does not count the first one, which begins
 * below every value. */
SIMD vl count_below(const double *from, int spans, vd value) {
    const vd one = (vd)l_set(1), none = (vd)l_set(0);
    vl count = l_set(0);
    for (int i = 1; i < spans; i++)
        count += (vl)d_select(d_le(d_set(from[i]), value), one, none);
    return count;
}

/* Returns the same by binary search. */
SIMD vl search_below(const double *from, int spans, vd value) {
    vl lo = l_set(0);
    for (int left = spans; left > 1;) {
        const int half = left / 2;
        const vl middle = lo + (uint64_t)half;
        lo = (vl)d_select(d_le(d_gather(from, middle), value), (vd)middle, (vd)lo);
        left -= half;
    }
    return lo;
}

/* Vector form of transfer_find(), for the first `lanes` lanes. The others get 0. */
SIMD void find_lanes(const transfer *t, vd value, unsigned lanes, uint16_t at[VD_N]) {
    uint64_t found[VD_N];
    l_store(found, t->spans <= COUNTED_SPANS ? count_below(t->from, t->spans, value)
                                             : search_below(t->from, t->spans, value));
    for (unsigned k = 0; k < VD_N; k++)
        at[k] = k < lanes ? (uint16_t)found[k] : 0;
}

/* Load a vector of pieces. Decide as only_span() does: pieces in one span go to p->seen, the others
 * to p->single with their range of spans. */
SIMD void load_pieces(medium_batch *m, const segment_columns *c, unsigned i, int degree,
                      piece_lanes *p) {
    stretch_lanes *s = &p->whole;
    const md even = d_eq(d_load(c->spread + i), d_set(SEGMENT_EVEN));
    vd lo, hi;
    lo = hi = s->f[0] = d_select(even, d_load(c->b[1] + i), d_load(c->b[0] + i));
    for (int k = 1; k <= degree; k++) {
        s->f[k] = d_load(c->b[k] + i);
        if (k == 3)
            s->f[k] = d_select(even, s->f[1], s->f[k]);
        lo = d_min(lo, s->f[k]);
        hi = d_max(hi, s->f[k]);
    }
    s->length = d_load(c->t1 + i) - d_load(c->t0 + i);
    s->value_error = lanes_value_error(m, i, degree, s->f, s->length, even);
    s->per_length = d_load(m->per_length + i);
    d_store(m->error + i, s->value_error);
    const unsigned lanes = c->count - i < VD_N ? c->count - i : VD_N;
    find_lanes(m->transfer, lo, lanes, p->low);
    vd ends[4];
    load_ends(m->transfer, p->low, ends);
    load_spans(m->transfer, p->low, &s->span);
    const md here = md_of_bits((1u << lanes) - 1);
    const md below = d_lt(hi, ends[1]);
    const md from = d_ge(lo - s->value_error, ends[2]);
    const md to = d_lt(hi + s->value_error, ends[3]);
    const md only = md_and(md_and(below, here), md_and(from, to));
    const vd nothing = d_set(0.0);
    const md empty = md_and(d_eq(s->span.k[0], nothing), d_eq(s->span.k[1], nothing));
    p->seen = md_and_not(only, empty);
    p->single = md_and_not(here, only);
    if (md_bits(p->single))
        find_lanes(m->transfer, hi, lanes, p->high);
}

/* Compute whole pieces at once, and store what is seen of them. Returns the lanes that need no
 * steps. */
SIMD md see_whole(medium_batch *m, unsigned i, int degree, const piece_lanes *p) {
    const vd one = d_set(1.0);
    seen_lanes out;
    see_lanes(m->share, degree, &p->whole, &out);
    for (int c = 0; c < 3; c++)
        d_store(m->rgb[c] + i, out.rgb[c]);
    /* medium_add_ends(), behind what medium_join() adds to nothing */
    const double most = 2.0 * m->transfer->most_k;
    const vd ends = d_min(d_set(1.5) * (d_load(m->t_error + i) * d_set(most)), one);
    d_store(m->through + i, out.through);
    d_store(m->through_error + i, d_min(out.through_error + d_set(0x1p-53) + ends, one));
    d_store(m->rgb_error + i, out.rgb_error + ends * d_set(m->transfer->most_rgb));
    return is_enough(&out);
}

/* ---- Cuts ---- */

/* A vector of numbers of pieces. Unused lanes repeat the last number of the list. */
typedef struct few {
    uint16_t at[VD_N];
    unsigned count;
} few;

SIMD few few_of(const uint16_t piece[], unsigned i, unsigned count) {
    few f = {.count = count - i < VD_N ? count - i : VD_N};
    for (unsigned k = 0; k < VD_N; k++)
        f.at[k] = piece[k < f.count ? i + k : count - 1];
    return f;
}

SIMD void coefficients_of(const segment_columns *c, const few *pieces, int degree, vd b[4]) {
    for (int k = 0; k <= degree; k++)
        b[k] = d_load_at(c->b[k], pieces->at);
}

/* Vector form of value_there. */
typedef struct value_lanes {
    vd value, slope, bend;
} value_lanes;

/* Vector form of value_there_of(). */
SIMD value_lanes values_at(const vd of[4], int degree, vd at) {
    vd b[4];
    value_lanes v = {d_set(0.0), d_set(0.0), d_set(0.0)};
    for (int k = 0; k <= degree; k++)
        b[k] = of[k];
    for (int left = degree; left > 0; left--) {
        v.slope = b[1] - b[0];
        if (left == 2)
            v.bend = (b[2] - b[1]) - v.slope;
        for (int k = 0; k < left; k++)
            b[k] = (d_set(1.0) - at) * b[k] + at * b[k + 1];
    }
    v.value = b[0];
    v.slope = v.slope * d_set(degree);
    v.bend = v.bend * d_set(degree * (degree - 1));
    return v;
}

/* Vector form of cut_at(), for the cuts from number i on. */
SIMD void find_few_cuts(medium_cut_list *l, unsigned i, unsigned count, const vd of[4],
                        int degree) {
    const unsigned all = (1u << count) - 1;
    const vd v = d_load(l->v + i), enough = d_load(l->enough + i);
    const vd fa = d_load(l->fa + i), fb = d_load(l->fb + i);
    const md rising = d_lt(fa, fb);
    vd a = d_load(l->a + i), b = d_load(l->b + i);
    vd at = d_min(a + (b - a) * ((v - fa) / (fb - fa)), b), off;
    for (int step = 0;; step++) {
        const value_lanes f = values_at(of, degree, at);
        off = f.value - v;
        const md found = d_le(d_abs(off), enough);
        if ((md_bits(found) & all) == all || step == MEDIUM_CUT_STEPS)
            break;
        const md falls_short = md_xor(rising, d_lt(off, d_set(0.0)));
        a = d_select(falls_short, a, at);
        b = d_select(falls_short, at, b);
        const vd middle = d_set(0.5) * (a + b);
        const vd by_slope = at - off * f.slope / (f.slope * f.slope - d_set(0.5) * off * f.bend);
        const md inside = md_and(d_gt(by_slope, a), d_lt(by_slope, b));
        const vd next = step % 4 < 3 ? d_select(inside, by_slope, middle) : middle;
        at = d_select(found, at, next);
    }
    d_store(l->at + i, at);
    d_store(l->off + i, d_abs(off));
}

SIMD void find_cuts(medium_batch *m, const segment_columns *c, int degree) {
    medium_cut_list *l = &m->cuts.cuts;
    for (unsigned i = 0; i < l->count; i += VD_N) {
        const few pieces = few_of(l->piece, i, l->count);
        vd b[4];
        coefficients_of(c, &pieces, degree, b);
        find_few_cuts(l, i, pieces.count, b, degree);
    }
}

/* ---- Stretches of pieces ---- */

/* Vector form of segment_part(). */
SIMD void part_lanes(const vd of[4], int degree, vd a, vd b, vd out[4]) {
    const vd one = d_set(1.0), zero = d_set(0.0);
    const vd at = d_select(d_gt(b, zero), a / b, zero);
    vd p[4];
    for (int k = 0; k <= degree; k++)
        p[k] = of[k];
    for (int i = 0; i <= degree; i++) {
        out[i] = p[0];
        for (int k = 0; k < degree - i; k++)
            p[k] = (one - b) * p[k] + b * p[k + 1];
    }
    for (int k = 0; k <= degree; k++)
        p[k] = out[k];
    for (int i = 0; i <= degree; i++) {
        out[degree - i] = p[degree - i];
        for (int k = 0; k < degree - i; k++)
            p[k] = (one - at) * p[k] + at * p[k + 1];
    }
}

/* The piece of each lane's stretch: coefficients of the value, and length. */
typedef struct of_pieces {
    vd b[4], length;
} of_pieces;

SIMD void load_stretches(const medium_batch *m, const segment_columns *c, const few *stretches,
                         int degree, of_pieces *of, stretch_lanes *p) {
    const medium_stretch_list *s = &m->cuts.stretches;
    few pieces = {.count = stretches->count};
    uint16_t spans[VD_N];
    for (unsigned k = 0; k < VD_N; k++) {
        pieces.at[k] = s->piece[stretches->at[k]];
        spans[k] = s->span[stretches->at[k]];
    }
    coefficients_of(c, &pieces, degree, of->b);
    of->length = d_load_at(c->t1, pieces.at) - d_load_at(c->t0, pieces.at);
    load_spans(m->transfer, spans, &p->span);
    p->value_error = d_load_at(m->error, pieces.at) + d_set(2.0) * d_load_at(s->off, stretches->at);
    p->per_length = d_load_at(m->per_length, pieces.at);
}

/* Vector form of seen_between(). */
SIMD void see_between(const medium_batch *m, const of_pieces *of, int degree, vd a, vd b,
                      stretch_lanes *p, seen_lanes *out) {
    part_lanes(of->b, degree, a, b, p->f);
    p->length = (b - a) * of->length;
    see_lanes(m->share, degree, p, out);
}

/* Compute the stretches from number i on, each at once. List the ones that need steps. */
SIMD void see_few_stretches(medium_batch *m, const segment_columns *c, unsigned i, int degree) {
    medium_stretch_list *s = &m->cuts.stretches;
    few here = {.count = s->count - i < VD_N ? s->count - i : VD_N};
    for (unsigned k = 0; k < VD_N; k++)
        here.at[k] = (uint16_t)(k < here.count ? i + k : s->count - 1);
    stretch_lanes p;
    of_pieces of;
    seen_lanes out;
    double step[VD_N];
    load_stretches(m, c, &here, degree, &of, &p);
    const vd a = d_load_at(s->from, here.at), b = d_load_at(s->to, here.at);
    see_between(m, &of, degree, a, b, &p, &out);
    for (int k = 0; k < 3; k++)
        d_store(s->rgb[k] + i, out.rgb[k]);
    d_store(s->through + i, out.through);
    d_store(s->rgb_error + i, out.rgb_error);
    d_store(s->through_error + i, out.through_error);
    unsigned left = ~md_bits(is_enough(&out)) & ((1u << here.count) - 1);
    if (left)
        d_store(step, next_step_lanes(b - a, &out));
    for (; left; left &= left - 1) {
        const unsigned k = (unsigned)__builtin_ctz(left);
        s->step[s->stepped] = step[k];
        s->by_steps[s->stepped++] = (uint16_t)(i + k);
    }
}

SIMD void see_stretches(medium_batch *m, const segment_columns *c, int degree) {
    for (unsigned i = 0; i < m->cuts.stretches.count; i += VD_N)
        see_few_stretches(m, c, i, degree);
}

/* ---- Steps ---- */

/* A walk in steps, per lane: what has been seen, the rest [a, b] of the stretch, the next step. */
typedef struct walk_lanes {
    vd rgb[3], through, rgb_error, through_error;
    vd a, b, step;
    md going;
} walk_lanes;

/* Vector form of medium_join(), in the lanes `in`. */
SIMD void join_lanes(walk_lanes *w, md in, const seen_lanes *s, vd most_rgb) {
    const vd reaching = w->through + w->through_error;
    const vd light = d_min(d_max(d_max(s->rgb[0], s->rgb[1]), s->rgb[2]), most_rgb);
    const vd rgb_error = w->rgb_error + (reaching * s->rgb_error + w->through_error * light);
    const vd through_error =
        reaching * s->through_error + w->through_error * s->through + d_set(0x1p-53) * w->through;
    w->rgb_error = d_select(in, rgb_error, w->rgb_error);
    w->through_error = d_select(in, through_error, w->through_error);
    for (int c = 0; c < 3; c++)
        w->rgb[c] = d_select(in, w->rgb[c] + w->through * s->rgb[c], w->rgb[c]);
    w->through = d_select(in, w->through * s->through, w->through);
}

/* Leave out the rest of a stretch if hardly any light comes through what is in front of it. Returns
 * the lanes where this was done. */
SIMD md leave_out_lanes(walk_lanes *w, md in, vd most_rgb, double drop) {
    const vd left = (w->through + w->through_error) * most_rgb;
    const md dark = md_and(md_and(in, d_lt(w->a, w->b)), d_le(left, d_set(drop)));
    w->rgb_error = d_select(dark, w->rgb_error + left, w->rgb_error);
    w->through_error = d_select(dark, w->through_error + w->through, w->through_error);
    w->through = d_select(dark, d_set(0.0), w->through);
    return dark;
}

/* Vector form of seen_by_steps(). */
SIMD void walk_on(const medium_batch *m, const of_pieces *of, int degree, stretch_lanes *p,
                  walk_lanes *w) {
    const vd most_rgb = p->span.most_rgb, shortest = d_set(MEDIUM_STEP_SHORTEST);
    while (md_bits(w->going)) {
        seen_lanes s;
        const vd to = d_select(d_gt(w->b - w->a, w->step), w->a + w->step, w->b);
        see_between(m, of, degree, w->a, to, p, &s);
        w->step = next_step_lanes(to - w->a, &s);
        const md again = md_and_not(d_gt(w->step, shortest), is_enough(&s));
        const md in = md_and_not(w->going, again);
        join_lanes(w, in, &s, most_rgb);
        w->step = d_select(in, d_max(w->step, shortest), w->step);
        w->a = d_select(in, to, w->a);
        const md dark = leave_out_lanes(w, in, most_rgb, m->drop);
        w->going = md_and(md_and_not(w->going, dark), d_lt(w->a, w->b));
    }
}

/* Compute the stretches of the list by_steps, from number i on. */
SIMD void see_by_steps(medium_batch *m, const segment_columns *c, unsigned i, int degree) {
    medium_stretch_list *s = &m->cuts.stretches;
    const few here = few_of(s->by_steps, i, s->stepped);
    const vd zero = d_set(0.0);
    stretch_lanes p;
    of_pieces of;
    double out[6][VD_N];
    load_stretches(m, c, &here, degree, &of, &p);
    walk_lanes w = {{zero, zero, zero},
                    d_set(1.0),
                    zero,
                    zero,
                    d_load_at(s->from, here.at),
                    d_load_at(s->to, here.at),
                    d_load(s->step + i),
                    md_of_bits((1u << here.count) - 1)};
    walk_on(m, &of, degree, &p, &w);
    for (int k = 0; k < 3; k++)
        d_store(out[k], w.rgb[k]);
    d_store(out[3], w.through);
    d_store(out[4], w.rgb_error);
    d_store(out[5], w.through_error);
    for (unsigned k = 0; k < here.count; k++) {
        const unsigned at = here.at[k];
        for (int x = 0; x < 3; x++)
            s->rgb[x][at] = out[x][k];
        s->through[at] = out[3][k];
        s->rgb_error[at] = out[4][k];
        s->through_error[at] = out[5][k];
    }
}

/* ---- All ---- */

SIMD void work_off_lists(medium_batch *m, const segment_columns *c, int degree) {
    find_cuts(m, c, degree);
    medium_cuts_place(&m->cuts, m->transfer);
    see_stretches(m, c, degree);
    for (unsigned i = 0; i < m->cuts.stretches.stepped; i += VD_N)
        see_by_steps(m, c, i, degree);
    medium_batch_join(m, c);
    medium_cuts_clear(&m->cuts);
}

/* Compute all stretches in the lists, and join them to pieces. Not inlined: it is long. */
static __attribute__((noinline)) void work_off(medium_batch *m, const segment_columns *c) {
    if (m->cuts.count == 0)
        return;
    if (c->degree == 1)
        work_off_lists(m, c, 1);
    else
        work_off_lists(m, c, 3);
}

/* Put a piece into the lists, or leave it to the scalar code. */
SIMD void put_off(medium_batch *m, const segment_columns *c, unsigned i, const piece_lanes *p,
                  unsigned k, bool single) {
    const int low = p->low[k];
    if (medium_cuts_full(&m->cuts))
        work_off(m, c);
    if (!single)
        medium_cuts_add_whole(&m->cuts, i + k, low);
    else if (!medium_cuts_add(&m->cuts, m->transfer, c, i + k, m->error[i + k], low, p->high[k]))
        medium_batch_single(m, c, i + k);
}

SIMD void see_pieces(medium_batch *m, const segment_columns *c, int degree) {
    medium_cuts_clear(&m->cuts);
    for (unsigned i = 0; i < c->count; i += VD_N) {
        piece_lanes p;
        load_pieces(m, c, i, degree, &p);
        const unsigned single = md_bits(p.single);
        unsigned seen = md_bits(p.seen), left = single;
        if (seen) {
            const unsigned done = md_bits(see_whole(m, i, degree, &p));
            left |= seen & ~done;
            seen &= done;
        }
        for (unsigned k = 0; k < VD_N; k++)
            m->seen[i + k] = (uint8_t)(seen >> k & 1u);
        for (; left; left &= left - 1) {
            const unsigned k = (unsigned)__builtin_ctz(left);
            put_off(m, c, i, &p, k, single >> k & 1u);
        }
    }
    work_off(m, c);
}

void SIMD_NAME(medium_batch)(medium_batch *m, const segment_columns *pieces) {
    if (pieces->degree == 1)
        see_pieces(m, pieces, 1);
    else
        see_pieces(m, pieces, 3);
}

#endif
#endif
