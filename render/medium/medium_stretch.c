#include "render/medium/medium_stretch.h"

#include <math.h>
#include <string.h>

#include "formats/base/portable_math.h"
#include "render/ray/cubic.h"

static const double unit = 0x1p-53; /* half an ulp of 1 */

/* ---- Between two cuts ---- */

/* A stretch in one span of the transfer function. */
typedef struct smooth {
    double w[4];     /* Bernstein coefficients of w */
    int degree;      /* 1 or 3 */
    double length;   /* of t */
    double k[4];     /* extinction, likewise */
    double depth;    /* optical, of all of it */
    double variance; /* sum of the absolute differences of w */
} smooth;

/* What all steps through a span share. */
typedef struct smooth_span {
    const medium_rule *rule;
    const transfer_span *span;
    double value_error;
} smooth_span;

static double mean_of(const double b[], int degree) {
    double sum = 0.0;
    for (int i = 0; i <= degree; i++)
        sum += b[i];
    return sum / (degree + 1);
}

/* Compute the members that follow from w and the length. */
static void complete(const transfer_span *span, smooth *s) {
    s->variance = 0.0;
    for (int i = 0; i <= s->degree; i++) {
        s->k[i] = (1.0 - s->w[i]) * span->k[0] + s->w[i] * span->k[1];
        s->variance += i > 0 ? fabs(s->w[i] - s->w[i - 1]) : 0.0;
    }
    s->depth = fmax(mean_of(s->k, s->degree) * s->length, 0.0);
}

/* The integral of w' tau, where tau has the Bernstein coefficients depth[0 .. degree + 1]. */
static double depth_moment(const smooth *s, const double depth[]) {
    static const double weight[3][5] = MEDIUM_MOMENT;
    double sum = 0.0;
    if (s->degree == 1)
        return (s->w[1] - s->w[0]) * mean_of(depth, 2);
    for (int i = 0; i < 3; i++) {
        double row = 0.0;
        for (int j = 0; j < 5; j++)
            row += weight[i][j] * depth[j];
        sum += (s->w[i + 1] - s->w[i]) * row;
    }
    return sum;
}

/* J of (2) by the tangent at half the depth; through_half: e^-h. */
static double weighted_change(const smooth *s, double half, double through_half) {
    double depth[5];
    depth[0] = 0.0;
    for (int i = 0; i <= s->degree; i++)
        depth[i + 1] = depth[i] + s->length * s->k[i] / (s->degree + 1);
    return through_half * ((1.0 + half) * (s->w[s->degree] - s->w[0]) - depth_moment(s, depth));
}

static double in_unit(double w) {
    return fmin(fmax(w, 0.0), 1.0);
}

static double rgb_at(const transfer_span *span, int c, double w) {
    return (1.0 - w) * span->rgb[0][c] + w * span->rgb[1][c];
}

/* Bound of the error of e^-depth for an error of the depth. */
static double shift_of(double depth_error) {
    return fmin(1.5 * depth_error, 1.0);
}

/* The whole stretch at once: (2), with (3) in *tangent. */
static medium_stretch seen_at_once(const smooth_span *p, const smooth *s, double *tangent) {
    const transfer_span *span = p->span;
    const double half = 0.5 * s->depth, through_half = portable_exp(-half);
    const bool thin = half < 1.0;
    const double bend = thin ? 0.25 * (half * half) : 0.5;
    const double change =
        (thin ? weighted_change(s, half, through_half) : 0.0) + bend * (s->w[s->degree] - s->w[0]);
    const double first = s->w[0], last = s->w[s->degree];
    medium_stretch out = {.through = through_half * through_half};
    for (int c = 0; c < 3; c++) {
        const double dc = span->rgb[1][c] - span->rgb[0][c];
        const double seen =
            (rgb_at(span, c, first) - out.through * rgb_at(span, c, last)) + dc * change;
        out.rgb[c] = fmin(fmax(seen, 0.0), span->most_rgb);
    }
    const double spread = span->rgb_change * s->variance;
    *tangent = spread * bend;
    /* The depth's own rounding is a share of the depth; its effect is that share of x e^-x < 1. */
    const double rounding = 64.0 * unit;
    const double depth_error =
        (p->value_error * span->k_rate + 8.0 * unit * span->most_k) * s->length;
    const double shift = shift_of(depth_error) + rounding;
    out.through_error = depth_error < 0.5 ? out.through * shift + rounding : 1.0;
    out.rgb_error =
        (*tangent + shift * (span->most_rgb + spread)) +
        (fmin(p->value_error * span->rgb_rate, span->most_rgb) * ((1.0 - out.through) + rounding) +
         rounding * span->most_rgb);
    return out;
}

/* ---- In a span ---- */

typedef struct piece_walk {
    const medium_rule *rule;
    const segment *piece;
    double value_error;
    medium_stretch seen;
    double near_rgb, near_through; /* errors near cuts, of the whole piece */
} piece_walk;

/* Clamp a coefficient of w. Polynomials of this degree with 0 <= w <= 1 stay within these limits,
 * unless w is nothing but rounding. */
static double coefficient(double w) {
    return w > -4.0 ? fmin(w, 5.0) : -4.0;
}

/* Compute [a, b] of a piece at once. Set *fit to the allowed error divided by the tangent's error;
 * 1 or more is good enough. */
static medium_stretch seen_between(const segment *piece, const smooth_span *p, double a, double b,
                                   double *fit) {
    const medium_rule *rule = p->rule;
    smooth s = {.degree = (int)piece->degree, .length = (b - a) * (piece->t1 - piece->t0)};
    /* Where the span is narrower than the error, nothing is known of w. */
    const bool unknown = p->value_error * p->span->inverse >= 1.0;
    double f[4], tangent;
    segment_part(piece, a, b, f);
    for (int i = 0; i <= s.degree; i++)
        s.w[i] = unknown ? 0.5 : coefficient((f[i] - p->span->base) * p->span->inverse);
    complete(p->span, &s);
    const medium_stretch out = seen_at_once(p, &s, &tangent);
    const double asked = rule->share * (1.0 - out.through) + rule->per_length * s.length;
    const double allowed = fmax(asked, MEDIUM_STEP_OF_REST * (out.rgb_error - tangent));
    *fit = tangent <= allowed ? fmax(allowed / tangent, 1.0) : allowed / tangent;
    return out;
}

/* Returns the length of the next step. The tangent's error divided by the allowed error is about
 * proportional to the square of the step. */
static double next_step(double step, double fit) {
    return step * fmin(fmax(MEDIUM_STEP_SHARE * sqrt(fit), MEDIUM_STEP_LEAST), MEDIUM_STEP_MOST);
}

/* Compute [a, b] of a piece step by step. The first step is at most `step` long. */
static medium_stretch seen_by_steps(const segment *piece, const smooth_span *p, double a, double b,
                                    double step) {
    const double most_rgb = p->span->most_rgb;
    medium_stretch seen = medium_nothing();
    while (a < b) {
        const double to = b - a > step ? a + step : b;
        double fit;
        const medium_stretch next = seen_between(piece, p, a, to, &fit);
        step = next_step(to - a, fit);
        if (fit < 1.0 && step > MEDIUM_STEP_SHORTEST)
            continue;
        medium_join(&seen, &next, most_rgb);
        step = fmax(step, MEDIUM_STEP_SHORTEST);
        a = to;
        /* Leave out the rest if hardly any light comes through what is in front of it. */
        const double left = (seen.through + seen.through_error) * most_rgb;
        if (a < b && left <= p->rule->drop) {
            seen.rgb_error += left;
            seen.through_error += seen.through;
            seen.through = 0.0;
            break;
        }
    }
    return seen;
}

/* Returns what is seen of [a, b]. Its values lie in one span, or leave it by at most `off`. */
static medium_stretch seen_in(const piece_walk *walk, const transfer_span *span, double a, double b,
                              double off) {
    const smooth_span p = {walk->rule, span, walk->value_error + 2.0 * off};
    double fit;
    const medium_stretch seen = seen_between(walk->piece, &p, a, b, &fit);
    return fit < 1.0 ? seen_by_steps(walk->piece, &p, a, b, next_step(b - a, fit)) : seen;
}

/* ---- Cuts ---- */

/* A place in a piece; `off`: how far the value there is from the cut's. */
typedef struct cut {
    double at, off;
} cut;

/* Join [from, to], which lies in one span, behind what has been seen. */
static void see(piece_walk *walk, const transfer_span *span, const cut *from, const cut *to) {
    if (!(from->at < to->at) || transfer_is_empty(span))
        return;
    const medium_stretch seen = seen_in(walk, span, from->at, to->at, fmax(from->off, to->off));
    medium_join(&walk->seen, &seen, walk->rule->transfer->most_rgb);
}

/* A part [a, b] of a piece, in which the value goes from fa to fb without turning. */
typedef struct part {
    double a, b, fa, fb;
} part;

/* The value at a place, its first and its second derivative. */
typedef struct value_there {
    double value, slope, bend;
} value_there;

static value_there value_there_of(const segment *s, double at) {
    double b[4];
    value_there v = {0.0, 0.0, 0.0};
    memcpy(b, s->b, sizeof b);
    for (uint32_t left = s->degree; left > 0; left--) {
        v.slope = b[1] - b[0];
        if (left == 2)
            v.bend = (b[2] - b[1]) - v.slope;
        for (uint32_t i = 0; i < left; i++)
            b[i] = (1.0 - at) * b[i] + at * b[i + 1];
    }
    v.value = b[0];
    v.slope *= s->degree;
    v.bend *= s->degree * (s->degree - 1);
    return v;
}

/* Find where the value is within `enough` of v. v is between fa and fb, or outside by so little
 * that it does not matter. Take Halley's steps. Where one leaves the bracket, and every fourth
 * time, take the middle of the bracket instead.
 */
static cut cut_at(const segment *piece, const part *p, double v, double enough) {
    const bool rising = p->fa < p->fb;
    double a = p->a, b = p->b;
    double at = fmin(a + (b - a) * ((v - p->fa) / (p->fb - p->fa)), b);
    for (int i = 0;; i++) {
        const value_there f = value_there_of(piece, at);
        const double off = f.value - v;
        if (fabs(off) <= enough || i == MEDIUM_CUT_STEPS)
            return (cut){at, fabs(off)};
        if (rising == (off < 0.0))
            a = at;
        else
            b = at;
        const double next = at - off * f.slope / (f.slope * f.slope - 0.5 * off * f.bend);
        at = next > a && next < b && i % 4 < 3 ? next : 0.5 * (a + b);
    }
}

/* An upper bound of the n-th root of x in [0, 1]. */
static double root_above(double x, int n) {
    int exponent;
    if (n == 1 || !(x > 0.0))
        return x;
    (void)frexp(x, &exponent);
    return fmin(ldexp(1.0, -((-exponent) / n)), 1.0);
}

/* Returns a bound of the length on which the value is within e of v, as a share of the piece. */
static double length_near(const piece_walk *walk, const part *p, double v, double e) {
    const int n = (int)walk->piece->degree;
    const double most = fmax(fabs(p->fa - v), fabs(p->fb - v));
    double f[4], slope = INFINITY;
    if (most <= e)
        return p->b - p->a;
    segment_part(walk->piece, p->a, p->b, f);
    for (int i = 0; i < n; i++)
        slope = fmin(slope, (p->fb > p->fa ? f[i + 1] - f[i] : f[i] - f[i + 1]) * n);
    const double by_degree = 4.0 * root_above(e / (2.0 * most), n);
    const double by_slope = slope > 0.0 ? 2.0 * e / slope : INFINITY;
    return (p->b - p->a) * fmin(fmin(by_degree, by_slope), 1.0);
}

/* Set *k and *rgb to the most that extinction and colour differ between any two values within e of
 * v. */
static void change_near(const transfer *t, double v, double e, double *k, double *rgb) {
    double lo[4] = {INFINITY, INFINITY, INFINITY, INFINITY}, hi[4] = {0.0};
    for (int i = transfer_find(t, v - e); i < t->spans && t->span[i].from <= v + e; i++) {
        const transfer_span *s = &t->span[i];
        const double at[2] = {in_unit((v - e - s->base) * s->inverse),
                              in_unit((v + e - s->base) * s->inverse)};
        for (int side = 0; side < 2; side++) {
            for (int c = 0; c < 4; c++) {
                const double x = c < 3 ? rgb_at(s, c, at[side])
                                       : (1.0 - at[side]) * s->k[0] + at[side] * s->k[1];
                lo[c] = fmin(lo[c], x);
                hi[c] = fmax(hi[c], x);
            }
        }
    }
    *k = hi[3] - lo[3];
    *rgb = fmax(hi[0] - lo[0], fmax(hi[1] - lo[1], hi[2] - lo[2]));
}

/* Add the error near the upper end of a span, if rates do not bound it there. Rounding, or a cut
 * that is off, may move the value across that end. */
static void add_error_near(piece_walk *walk, const part *p, int span, double off) {
    const segment *piece = walk->piece;
    const transfer *t = walk->rule->transfer;
    const double v = t->span[span].to, e = 2.0 * walk->value_error + off;
    double k, rgb;
    if (transfer_reaches(t, span, e))
        return;
    change_near(t, v, e, &k, &rgb);
    const double length = length_near(walk, p, v, e) * (piece->t1 - piece->t0);
    const double shift = shift_of(k * length);
    walk->near_through += shift;
    walk->near_rgb += shift * t->most_rgb + rgb * fmin(t->most_k * length, 1.0);
}

/* Add the errors near ends of spans that the part's values do not reach, but that its values plus
 * or minus their error do. */
static void add_errors_beside(piece_walk *walk, const part *p, int lowest, int highest) {
    const transfer *t = walk->rule->transfer;
    const double e = walk->value_error;
    for (int k = lowest - 1; k >= 0 && t->span[k].to > fmin(p->fa, p->fb) - e; k--)
        add_error_near(walk, p, k, 0.0);
    for (int k = highest; k + 1 < t->spans && t->span[k].to <= fmax(p->fa, p->fb) + e; k++)
        add_error_near(walk, p, k, 0.0);
}

static void integrate_part(piece_walk *walk, const part *p) {
    const transfer *t = walk->rule->transfer;
    const int up = p->fa < p->fb ? 1 : -1, end = transfer_find(t, p->fb);
    int i = transfer_find(t, p->fa);
    cut from = {p->a, 0.0};
    add_errors_beside(walk, p, i < end ? i : end, i < end ? end : i);
    for (; i != end; i += up) {
        const transfer_span *below = &t->span[up > 0 ? i : i - 1];
        cut to = cut_at(walk->piece, p, below->to, fmax(walk->value_error, below->give));
        /* Cuts that are off may be in the wrong order. */
        if (to.at < from.at)
            to = (cut){from.at, fmax(from.off, to.off)};
        add_error_near(walk, p, (int)(below - t->span), to.off);
        see(walk, &t->span[i], &from, &to);
        from = to;
    }
    see(walk, &t->span[i], &from, &(cut){p->b, 0.0});
}

/* Returns the span that holds all values of the piece, and whose reach holds them with their error.
 * NULL: there is none. */
static const transfer_span *only_span(const transfer *t, const segment *piece, double value_error) {
    double lo = piece->b[0], hi = piece->b[0];
    for (uint32_t i = 1; i <= piece->degree; i++) {
        lo = fmin(lo, piece->b[i]);
        hi = fmax(hi, piece->b[i]);
    }
    const transfer_span *s = &t->span[transfer_find(t, lo)];
    const bool only =
        hi < s->to && lo - value_error >= s->reach[0] && hi + value_error < s->reach[1];
    return only ? s : NULL;
}

void medium_add_ends(const transfer *t, double t_error, medium_stretch *seen) {
    const double shift = shift_of(2.0 * t_error * t->most_k);
    seen->through_error = fmin(seen->through_error + shift, 1.0);
    seen->rgb_error += shift * t->most_rgb;
}

static void integrate_parts(piece_walk *walk) {
    const segment *s = walk->piece;
    double at[2];
    part p = {0.0, 0.0, 0.0, s->b[0]};
    const int turns = s->degree == 3 && !cubic_is_monotone(s->b) ? cubic_extrema(s->b, at) : 0;
    for (int i = 0; i <= turns; i++) {
        p.a = p.b;
        p.fa = p.fb;
        p.b = i < turns ? at[i] : 1.0;
        p.fb = i < turns ? segment_at(s, at[i]) : s->b[s->degree];
        integrate_part(walk, &p);
    }
}

medium_stretch medium_of_piece(const medium_rule *rule, const segment *of) {
    segment piece = *of;
    piece_walk walk = {.rule = rule,
                       .piece = &piece,
                       .value_error = segment_value_error(of, &rule->error),
                       .seen = medium_nothing()};
    segment_flatten(&piece);
    const transfer_span *span = only_span(rule->transfer, &piece, walk.value_error);
    if (span && transfer_is_empty(span))
        return walk.seen;
    if (span)
        see(&walk, span, &(cut){0.0, 0.0}, &(cut){1.0, 0.0});
    else
        integrate_parts(&walk);
    walk.seen.rgb_error += walk.near_rgb;
    walk.seen.through_error += walk.near_through;
    medium_add_ends(rule->transfer, rule->error.t, &walk.seen);
    return walk.seen;
}
