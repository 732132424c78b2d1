#include "render/medium/medium_overlay.h"

#include <math.h>
#include <string.h>

#include "formats/base/portable_math.h"

static const double unit = 0x1p-53; /* half an ulp of 1 */

/* Bound of the relative rounding error of a sum of up to 256 terms of similar magnitude. */
static const double rounding = 256.0 * 0x1p-53;

/* ---- Layers ---- */

medium_layer medium_layer_of(const medium_rule *rule, const segment *piece, double a, double b) {
    medium_layer l = {
        .transfer = rule->transfer, .end_error = 2.0 * rule->error.t, .light = {1.0, 1.0, 1.0}};
    double largest = 0.0, f[4];
    segment_part(piece, a, b, f);
    if (piece->spread == SEGMENT_EVEN) {
        for (int i = 0; i < 4; i++)
            l.b[i] = piece->b[1];
        return l;
    }
    if (piece->degree == 1) {
        l.b[0] = f[0];
        l.b[1] = (2.0 * f[0] + f[1]) / 3.0;
        l.b[2] = (f[0] + 2.0 * f[1]) / 3.0;
        l.b[3] = f[1];
    } else {
        memcpy(l.b, f, sizeof l.b);
    }
    for (int i = 0; i < 4; i++)
        largest = fmax(largest, fabs(l.b[i]));
    l.value_error = segment_value_error(piece, &rule->error) + 256.0 * unit * largest;
    return l;
}

/* Knowledge of a layer's values over a stretch. */
typedef struct layer_view {
    const transfer_span *span; /* that holds all values; NULL: none does */
    bool blurred;              /* halving would not help: the range is not wider than the error */
    transfer_extent extent;    /* of extinction and colour */
} layer_view;

static layer_view view_of(const medium_layer *l) {
    double lo = l->b[0], hi = l->b[0];
    for (int i = 1; i < 4; i++) {
        lo = fmin(lo, l->b[i]);
        hi = fmax(hi, l->b[i]);
    }
    const transfer_span *s = &l->transfer->span[transfer_find(l->transfer, lo)];
    const double e = l->value_error;
    const bool only = hi < s->to && lo - e >= s->reach[0] && hi + e < s->reach[1];
    layer_view view = {only ? s : NULL, hi - lo <= e,
                       transfer_extent_of(l->transfer, lo - e, hi + e)};
    for (int c = 0; c < 3; c++)
        for (int side = 0; side < 2; side++)
            view.extent.rgb[c][side] *= l->light[c];
    return view;
}

static bool is_nothing(const layer_view views[], int count) {
    for (int i = 0; i < count; i++)
        if (views[i].extent.k[1] > 0.0)
            return false;
    return true;
}

/* ---- Extents ---- */

/* Returns the extent of the sum of all layers in which something may be seen. */
static transfer_extent joined(const layer_view views[], int count) {
    transfer_extent all = {.rgb = {{INFINITY, 0.0}, {INFINITY, 0.0}, {INFINITY, 0.0}}};
    for (int i = 0; i < count; i++) {
        const transfer_extent *e = &views[i].extent;
        if (!(e->k[1] > 0.0))
            continue;
        for (int side = 0; side < 2; side++)
            all.k[side] += e->k[side];
        for (int c = 0; c < 3; c++) {
            all.rgb[c][0] = fmin(all.rgb[c][0], e->rgb[c][0]);
            all.rgb[c][1] = fmax(all.rgb[c][1], e->rgb[c][1]);
        }
    }
    return all;
}

/* Take the second or the third way: return the middle between the least and the most that may be
 * seen. */
static medium_stretch seen_between(const transfer_extent *e, double less_through,
                                   double more_through) {
    medium_stretch out = {.through = 0.5 * (less_through + more_through)};
    out.through_error = 0.5 * (more_through - less_through) + rounding;
    for (int c = 0; c < 3; c++) {
        const double least = e->rgb[c][0] * (1.0 - more_through);
        const double most = e->rgb[c][1] * (1.0 - less_through);
        out.rgb[c] = 0.5 * (least + most);
        out.rgb_error = fmax(out.rgb_error, 0.5 * (most - least) + rounding * e->rgb[c][1]);
    }
    return out;
}

static medium_stretch seen_by_extent(const transfer_extent *e, double length) {
    return seen_between(e, portable_exp(-(e->k[1] * length)), portable_exp(-(e->k[0] * length)));
}

/* ---- Polynomials ---- */

/* The sum of all layers, each in its span. */
typedef struct smooth_sum {
    double k[4];      /* extinction, Bernstein coefficients */
    double k_error;   /* from the errors of values */
    double rgb_error; /* likewise: of any colour */
} smooth_sum;

/* Clamp w to [0, 1]: only rounding leads out of it. */
static double weight_in(const transfer_span *s, const medium_layer *l, double value) {
    const bool unknown = l->value_error * s->inverse >= 1.0;
    return unknown ? 0.5 : fmin(fmax((value - s->base) * s->inverse, 0.0), 1.0);
}

static smooth_sum sum_of(const medium_layer layers[], const layer_view views[], int count) {
    smooth_sum sum = {{0.0}, 0.0, 0.0};
    for (int i = 0; i < count; i++) {
        const medium_layer *l = &layers[i];
        const transfer_span *s = views[i].span;
        for (int n = 0; n < 4; n++) {
            const double w = weight_in(s, l, l->b[n]);
            sum.k[n] += (1.0 - w) * s->k[0] + w * s->k[1];
        }
        sum.k_error += l->value_error * s->k_rate + rounding * s->most_k;
        sum.rgb_error = fmax(sum.rgb_error, fmin(l->value_error * s->rgb_rate, s->most_rgb));
    }
    return sum;
}

/* Six points of Gauss's rule on [0, 1], and their weights. */
enum { NODES = 6 };
static const double node[NODES][2] = {{0.033765242898423986094, 0.085662246189585172520},
                                      {0.16939530676686774317, 0.18038078652406930378},
                                      {0.38069040695840154568, 0.23395696728634552370},
                                      {0.61930959304159845432, 0.23395696728634552370},
                                      {0.83060469323313225683, 0.18038078652406930378},
                                      {0.96623475710157601391, 0.085662246189585172520}};

static double bernstein(const double b[], int degree, double s) {
    double p[5];
    memcpy(p, b, sizeof *p * (size_t)(degree + 1));
    for (int left = degree; left > 0; left--)
        for (int i = 0; i < left; i++)
            p[i] = (1.0 - s) * p[i] + s * p[i + 1];
    return p[0];
}

/* Compute q of the head of medium_overlay.h at s. */
static void emission_at(const medium_layer layers[], const layer_view views[], int count, double s,
                        double q[3]) {
    for (int i = 0; i < count; i++) {
        const transfer_span *of = views[i].span;
        const double w = weight_in(of, &layers[i], bernstein(layers[i].b, 3, s));
        const double k = (1.0 - w) * of->k[0] + w * of->k[1];
        for (int c = 0; c < 3; c++)
            q[c] += layers[i].light[c] * (k * ((1.0 - w) * of->rgb[0][c] + w * of->rgb[1][c]));
    }
}

/* Take the first way, for a depth of 2 h < 2: set rgb. Returns the error of the tangent. */
static double integrate(const medium_layer layers[], const layer_view views[], int count,
                        const smooth_sum *sum, double length, double half, double rgb[3]) {
    const double through_half = portable_exp(-half), bend = 0.25 * (half * half);
    double depth[5] = {0.0}, all[3] = {0.0}, most = 0.0;
    for (int i = 0; i < 4; i++)
        depth[i + 1] = depth[i] + 0.25 * length * sum->k[i];
    for (int n = 0; n < NODES; n++) {
        double q[3] = {0.0};
        emission_at(layers, views, count, node[n][0], q);
        const double tau = bernstein(depth, 4, node[n][0]);
        const double reaching = through_half * (1.0 + half - tau) + bend;
        for (int c = 0; c < 3; c++) {
            rgb[c] += node[n][1] * length * q[c] * reaching;
            all[c] += node[n][1] * length * q[c];
        }
    }
    for (int c = 0; c < 3; c++)
        most = fmax(most, all[c]);
    return most * bend;
}

/* Bound of the error of e^-depth for an error of the depth. */
static double shift_of(double depth_error) {
    return fmin(1.5 * depth_error, 1.0);
}

/* Take the better of the first way and the second. *inexact: the part of the error that halving
 * reduces. */
static medium_stretch seen_smooth(const medium_overlay_rule *rule, const medium_layer layers[],
                                  const layer_view views[], int count, double length,
                                  double *inexact) {
    const smooth_sum sum = sum_of(layers, views, count);
    const double depth = fmax(0.25 * (sum.k[0] + sum.k[1] + sum.k[2] + sum.k[3]) * length, 0.0);
    const double through = portable_exp(-depth), depth_error = sum.k_error * length;
    const double shift = shift_of(depth_error) + rounding;
    const transfer_extent extent = joined(views, count);
    medium_stretch out = seen_between(&extent, through, through);
    *inexact = out.rgb_error;
    if (depth < 2.0) {
        double rgb[3] = {0.0};
        const double tangent = integrate(layers, views, count, &sum, length, 0.5 * depth, rgb);
        if (tangent < *inexact) {
            memcpy(out.rgb, rgb, sizeof out.rgb);
            *inexact = tangent;
        }
    }
    out.through_error = depth_error < 0.5 ? through * shift + rounding : 1.0;
    out.rgb_error = *inexact + 2.0 * shift * rule->most_rgb +
                    sum.rgb_error * ((1.0 - through) + rounding) + rounding * rule->most_rgb;
    return out;
}

/* ---- Halving ---- */

static medium_stretch seen_at_once(const medium_overlay_rule *rule, const medium_layer layers[],
                                   const layer_view views[], int count, double length,
                                   double *inexact) {
    const transfer_extent extent = joined(views, count);
    bool smooth = true, blurred = true;
    for (int i = 0; i < count; i++) {
        smooth = smooth && views[i].span;
        blurred = blurred && (views[i].span || views[i].blurred);
    }
    if (smooth)
        return seen_smooth(rule, layers, views, count, length, inexact);
    const medium_stretch out = seen_by_extent(&extent, length);
    *inexact = blurred ? 0.0 : out.rgb_error + out.through_error * rule->most_rgb;
    return out;
}

static void halve(medium_layer front[], medium_layer back[], int count) {
    for (int l = 0; l < count; l++) {
        double b[4];
        memcpy(b, front[l].b, sizeof b);
        back[l] = front[l];
        for (int i = 0; i < 4; i++) {
            front[l].b[i] = b[0];
            back[l].b[3 - i] = b[3 - i];
            for (int k = 0; k < 3 - i; k++)
                b[k] = 0.5 * (b[k] + b[k + 1]);
        }
    }
}

/* VIEWS_MAX bounds the work where halving never reaches the allowed error, as with numbers near the
 * ends of their ranges. Ordinary stretches take less than a tenth of it. */
enum { HALVINGS_MAX = 60, VIEWS_MAX = 1 << 18 };

/* *views_left: how many parts may still be halved. */
static medium_stretch seen_of(const medium_overlay_rule *rule, const medium_layer layers[],
                              int count, double length, int halvings, int *views_left) {
    layer_view views[MEDIUM_LAYERS_MAX];
    medium_layer front[MEDIUM_LAYERS_MAX], back[MEDIUM_LAYERS_MAX];
    double inexact;
    for (int i = 0; i < count; i++)
        views[i] = view_of(&layers[i]);
    if (is_nothing(views, count))
        return medium_nothing();
    medium_stretch seen = seen_at_once(rule, layers, views, count, length, &inexact);
    const double asked =
        rule->share * (1.0 - seen.through) + rule->per_length * length + rule->enough;
    const double allowed = fmax(asked, MEDIUM_STEP_OF_REST * (seen.rgb_error - inexact));
    if (inexact <= allowed || halvings == 0 || --*views_left <= 0)
        return seen;
    memcpy(front, layers, sizeof *front * (size_t)count);
    halve(front, back, count);
    seen = seen_of(rule, front, count, 0.5 * length, halvings - 1, views_left);
    /* Leave out the back half if hardly any light comes through the front half. */
    const double left = (seen.through + seen.through_error) * rule->most_rgb;
    if (left <= rule->drop) {
        seen.rgb_error += left;
        seen.through_error += seen.through;
        seen.through = 0.0;
        return seen;
    }
    const medium_stretch behind =
        seen_of(rule, back, count, 0.5 * length, halvings - 1, views_left);
    medium_join(&seen, &behind, rule->most_rgb);
    return seen;
}

medium_stretch medium_of_layers(const medium_overlay_rule *rule, const medium_layer layers[],
                                int count, double length) {
    int views_left = VIEWS_MAX;
    medium_stretch seen = seen_of(rule, layers, count, length, HALVINGS_MAX, &views_left);
    for (int i = 0; i < count; i++) {
        const double shift = shift_of(layers[i].end_error * layers[i].transfer->most_k);
        seen.through_error = fmin(seen.through_error + shift, 1.0);
        seen.rgb_error += shift * rule->most_rgb;
    }
    return seen;
}
