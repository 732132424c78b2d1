#include "render/medium_stretch.h"

#include <math.h>
#include <string.h>

#include "formats/base/portable_math.h"
#include "render/cubic.h"

static const double unit = 0x1p-53; /* half an ulp of 1 */

/* ---- Stretches ---- */

void medium_join(medium_stretch *front, const medium_stretch *behind, double most_rgb) {
    const double reaching = front->through + front->through_error;
    front->rgb_error += reaching * behind->rgb_error + front->through_error * most_rgb;
    front->through_error = reaching * behind->through_error +
                           front->through_error * behind->through + unit * front->through;
    for (int c = 0; c < 3; c++)
        front->rgb[c] += front->through * behind->rgb[c];
    front->through *= behind->through;
}

/* ---- Between two cuts ---- */

/* A stretch in one span of the transfer function. */
typedef struct smooth {
    double w[4];     /* Bernstein coefficients of w */
    int degree;      /* 1 or 3 */
    double length;   /* of t */
    double k[4];     /* extinction, likewise */
    double depth;    /* optical, of all of it */
    double variance; /* sum of the differences of w */
} smooth;

/* What does not change while a stretch is halved. */
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

/* What follows from w and the length. */
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

/* How far e^-depth may be off at most where the depth is off by so much. */
static double shift_of(double depth_error) {
    return fmin(1.5 * depth_error, 1.0);
}

/* The whole of it at once: (2), with (3) in *tangent. */
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
    /* Of the depth's own roundings, a share of it, nothing is left but x e^-x < 1. */
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

static void halve(const transfer_span *span, const smooth *s, smooth half[2]) {
    double b[4];
    memcpy(b, s->w, sizeof b);
    half[0] = half[1] = *s;
    for (int i = 0; i <= s->degree; i++) {
        half[0].w[i] = b[0];
        half[1].w[s->degree - i] = b[s->degree - i];
        for (int k = 0; k < s->degree - i; k++)
            b[k] = 0.5 * (b[k] + b[k + 1]);
    }
    for (int i = 0; i < 2; i++) {
        half[i].length = 0.5 * s->length;
        complete(span, &half[i]);
    }
}

enum { HALVINGS_MAX = 60 };

static medium_stretch seen_of(const smooth_span *p, const smooth *s, int halvings) {
    double tangent;
    smooth half[2];
    const medium_rule *rule = p->rule;
    medium_stretch front = seen_at_once(p, s, &tangent);
    const double allowed = rule->share * (1.0 - front.through) + rule->per_length * s->length;
    if (tangent <= allowed || front.rgb_error - tangent > allowed || halvings == 0)
        return front;
    halve(p->span, s, half);
    front = seen_of(p, &half[0], halvings - 1);
    /* Where hardly anything comes through the front, what is behind may be left out. */
    const double left = (front.through + front.through_error) * p->span->most_rgb;
    if (left <= rule->drop) {
        front.rgb_error += left;
        front.through_error += front.through;
        front.through = 0.0;
        return front;
    }
    const medium_stretch back = seen_of(p, &half[1], halvings - 1);
    medium_join(&front, &back, p->span->most_rgb);
    return front;
}

/* ---- Cuts ---- */

typedef struct piece_walk {
    const medium_rule *rule;
    const segment *piece;
    double value_error;
    medium_stretch seen;
} piece_walk;

/* The Bernstein coefficients of the value over [a, b] of a piece. */
static void part_of(const segment *s, double a, double b, double out[4]) {
    /* Its blossom: first what is left of b, then of that what is right of a. */
    const int n = (int)s->degree;
    double p[4], at = b > 0.0 ? a / b : 0.0;
    memcpy(p, s->b, sizeof p);
    for (int i = 0; i <= n; i++) {
        out[i] = p[0];
        for (int k = 0; k < n - i; k++)
            p[k] = (1.0 - b) * p[k] + b * p[k + 1];
    }
    memcpy(p, out, sizeof p);
    for (int i = 0; i <= n; i++) {
        out[n - i] = p[n - i];
        for (int k = 0; k < n - i; k++)
            p[k] = (1.0 - at) * p[k] + at * p[k + 1];
    }
}

/* No polynomial of this degree with 0 <= w <= 1 has others; but where w is nothing but rounding. */
static double coefficient(double w) {
    return w > -4.0 ? fmin(w, 5.0) : -4.0;
}

/* What is seen of a length of t, all of it in a span, with the value's Bernstein coefficients. */
static medium_stretch seen_in(const piece_walk *walk, const transfer_span *span, const double f[4],
                              double length) {
    smooth s = {.degree = (int)walk->piece->degree, .length = length};
    /* Where the span is narrower than the error, nothing is known of w. */
    const bool unknown = walk->value_error * span->inverse >= 1.0;
    for (int i = 0; i <= s.degree; i++)
        s.w[i] = unknown ? 0.5 : coefficient((f[i] - span->base) * span->inverse);
    complete(span, &s);
    const smooth_span p = {walk->rule, span, walk->value_error};
    return seen_of(&p, &s, HALVINGS_MAX);
}

/* [a, b] comes behind what has been seen, all of it in a span. */
static void see(piece_walk *walk, const transfer_span *span, double a, double b) {
    const segment *piece = walk->piece;
    double f[4];
    if (!(a < b) || transfer_is_empty(span))
        return;
    part_of(piece, a, b, f);
    const medium_stretch seen = seen_in(walk, span, f, (b - a) * (piece->t1 - piece->t0));
    medium_join(&walk->seen, &seen, walk->rule->transfer->most_rgb);
}

/* Where the value is v, between a and b, where it is fa and fb, on either side of v. */
static double cut_at(const piece_walk *walk, double v, double a, double fa, double b, double fb) {
    const bool rising = fa < fb;
    double ga = fa - v, gb = fb - v, at = a;
    for (int i = 0; i < 128; i++) {
        /* Two steps of false position that forget one end by halves, then one by the middle. */
        at = i % 3 < 2 && ga != gb ? a - ga * ((b - a) / (gb - ga)) : 0.5 * (a + b);
        if (!(at > a && at < b))
            at = 0.5 * (a + b);
        const double g = segment_at(walk->piece, at) - v;
        if (!(at > a && at < b) || fabs(g) <= walk->value_error)
            break;
        if (rising == (g < 0.0)) {
            a = at;
            ga = g;
            gb *= 0.5;
        } else {
            b = at;
            gb = g;
            ga *= 0.5;
        }
    }
    return at;
}

/* An upper bound of the n-th root of x in [0, 1]. */
static double root_above(double x, int n) {
    int exponent;
    if (n == 1 || !(x > 0.0))
        return x;
    (void)frexp(x, &exponent);
    return fmin(ldexp(1.0, -((-exponent) / n)), 1.0);
}

/* Of a part [a, b] of a piece, in which the value goes from fa to fb without turning: at most so
 * long is what is within e of v. */
static double length_near(const piece_walk *walk, double a, double b, double fa, double fb,
                          double v, double e) {
    const int n = (int)walk->piece->degree;
    const double most = fmax(fabs(fa - v), fabs(fb - v));
    double f[4], slope = INFINITY;
    if (most <= e)
        return b - a;
    part_of(walk->piece, a, b, f);
    for (int i = 0; i < n; i++)
        slope = fmin(slope, (fb > fa ? f[i + 1] - f[i] : f[i] - f[i + 1]) * n);
    const double by_degree = 4.0 * root_above(e / (2.0 * most), n);
    const double by_slope = slope > 0.0 ? 2.0 * e / slope : INFINITY;
    return (b - a) * fmin(fmin(by_degree, by_slope), 1.0);
}

/* How much extinction and colour differ where the value is within e of v. */
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

/* What rounding may move over the end v of a span, in [a, b] as above, if rates do not tell. */
static void add_error_near(piece_walk *walk, const transfer_span *below, double v, double a,
                           double b, double fa, double fb) {
    const segment *piece = walk->piece;
    const transfer *t = walk->rule->transfer;
    const double e = 2.0 * walk->value_error;
    double k, rgb;
    if (below->reach[1] > v + e && below[1].reach[0] < v - e)
        return;
    change_near(t, v, e, &k, &rgb);
    const double length = length_near(walk, a, b, fa, fb, v, e) * (piece->t1 - piece->t0);
    const double shift = shift_of(k * length);
    walk->seen.through_error = fmin(walk->seen.through_error + shift, 1.0);
    walk->seen.rgb_error += shift * t->most_rgb + rgb * fmin(t->most_k * length, 1.0);
}

/* A part [a, b] in which the value goes from fa to fb without turning. */
static void see_part(piece_walk *walk, double a, double b, double fa, double fb) {
    const transfer *t = walk->rule->transfer;
    const double e = walk->value_error;
    const int up = fa < fb ? 1 : -1;
    int i = transfer_find(t, fa);
    double from = a, f_from = fa;
    const int first = transfer_find(t, fmin(fa, fb) - e), last = transfer_find(t, fmax(fa, fb) + e);
    for (int k = first; k < last; k++)
        add_error_near(walk, &t->span[k], t->span[k].to, a, b, fa, fb);
    for (int end = transfer_find(t, fb); i != end; i += up) {
        const double v = up > 0 ? t->span[i].to : t->span[i].from;
        const double to = f_from == v ? from : cut_at(walk, v, from, f_from, b, fb);
        see(walk, &t->span[i], from, to);
        from = to;
        f_from = v;
    }
    see(walk, &t->span[i], from, b);
}

/* How far the value may be off at a given t. */
static double value_error_of(const segment *s, const segments_error *error) {
    double largest = fabs(s->b[0]), step = 0.0;
    for (uint32_t i = 0; i < s->degree; i++) {
        largest = fmax(largest, fabs(s->b[i + 1]));
        step = fmax(step, fabs(s->b[i + 1] - s->b[i]));
    }
    /* The slope is a mean of its Bernstein coefficients; and nothing leaves the range of those. */
    const double by_t = s->degree * step * fmin(error->t / (s->t1 - s->t0), 1.0);
    return error->value + by_t + 16.0 * unit * largest;
}

/* The span that the whole piece is in, and no error leads beyond its reach; NULL: there is none. */
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

/* The ends of the piece are off, too. */
static void add_ends(const medium_rule *rule, medium_stretch *seen) {
    const double shift = shift_of(2.0 * rule->error.t * rule->transfer->most_k);
    seen->through_error = fmin(seen->through_error + shift, 1.0);
    seen->rgb_error += shift * rule->transfer->most_rgb;
}

static void see_parts(piece_walk *walk) {
    double at[4] = {0.0}, value[4];
    int ends = 1;
    if (walk->piece->degree == 3)
        ends += cubic_extrema(walk->piece->b, at + 1);
    at[ends] = 1.0;
    for (int i = 0; i <= ends; i++)
        value[i] = segment_at(walk->piece, at[i]);
    for (int i = 0; i < ends; i++)
        see_part(walk, at[i], at[i + 1], value[i], value[i + 1]);
}

medium_stretch medium_of_piece(const medium_rule *rule, const segment *piece) {
    piece_walk walk = {rule, piece, value_error_of(piece, &rule->error), medium_nothing()};
    const transfer_span *span = only_span(rule->transfer, piece, walk.value_error);
    if (span && transfer_is_empty(span))
        return walk.seen;
    if (span)
        walk.seen = seen_in(&walk, span, piece->b, piece->t1 - piece->t0);
    else
        see_parts(&walk);
    add_ends(rule, &walk.seen);
    return walk.seen;
}
