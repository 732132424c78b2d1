#include "render/medium/medium_whole.h"

#include <math.h>

#include "formats/base/portable_math.h"

static double middle(const double range[2]) {
    return 0.5 * range[0] + 0.5 * range[1];
}

static double half(const double range[2]) {
    return 0.5 * range[1] - 0.5 * range[0];
}

/* ---- Which ranges ---- */

static bool is_homogeneous(const medium_whole_rule *rule, double lo, double hi) {
    const double part = 0.9;
    if (rule->threshold > 0.0)
        return hi - lo <= rule->threshold;
    const transfer_extent x = transfer_extent_of(rule->transfer, lo, hi);
    double brightest = 0.0, spread = 0.0;
    if (x.k[1] == 0.0)
        return true;
    for (int c = 0; c < 3; c++) {
        brightest = fmax(brightest, rule->brightest + x.rgb[c][1]);
        spread = fmax(spread, half(x.rgb[c]));
    }
    return brightest * half(x.k) + (spread - part * rule->share) * middle(x.k) <=
           part * rule->per_length;
}

/* The greatest float that is at most x. */
static float float_below(double x) {
    const float f = (float)x;
    return (double)f > x ? nextafterf(f, -INFINITY) : f;
}

/* Lay out the bins. For integer values they begin at integers. */
static void lay_out(homogeneous *h, const double range[2], bool integers) {
    const double bins = HOMOGENEOUS_BINS - 1, width = (range[1] - range[0]) / bins;
    h->first = range[0];
    h->width = width > 0.0 ? width : 1.0;
    if (integers) {
        h->width = 1.0;
        while (h->width < width)
            h->width *= 2.0;
    }
    h->bins = 1 + (int)fmin(ceil((range[1] - range[0]) / h->width), bins);
}

homogeneous medium_whole(const medium_whole_rule *rule, const double range[2], bool integers) {
    homogeneous h = {0};
    /* Without values, no range is homogeneous. */
    if (!(range[0] <= range[1]))
        return h;
    lay_out(&h, range, integers);
    int last = 0;
    for (int i = 0; i < h.bins; i++) {
        /* See homogeneous_begin(). */
        const double from = homogeneous_begin(&h, i) - (integers ? 0.0 : 1e-6 * h.width);
        last = last > i ? last : i;
        while (last + 1 < h.bins && is_homogeneous(rule, from, homogeneous_begin(&h, last + 1)))
            last++;
        h.until[i] = last > i ? float_below(homogeneous_begin(&h, last)) : -INFINITY;
    }
    return h;
}

/* ---- What is seen ---- */

medium_stretch medium_of_range(const medium_rule *rule, const double range[2], double length) {
    const double rounding = 64.0 * 0x1p-53;
    const transfer_extent x = transfer_extent_of(rule->transfer, range[0], range[1]);
    medium_stretch s = medium_nothing();
    if (x.k[1] == 0.0)
        return s;
    s.through = portable_exp(-(middle(x.k) * length));
    s.through_error = fmax(portable_exp(-(x.k[0] * length)) - s.through, 0.0) + rounding;
    for (int c = 0; c < 3; c++) {
        s.rgb[c] = middle(x.rgb[c]) * (1.0 - s.through);
        s.rgb_error = fmax(s.rgb_error, half(x.rgb[c]) * (1.0 - s.through) +
                                            x.rgb[c][1] * (s.through_error + rounding));
    }
    /* The ends of the length have errors, too. */
    const double shift = fmin(3.0 * rule->error.t * rule->transfer->most_k, 1.0);
    s.through_error = fmin(s.through_error + shift, 1.0);
    s.rgb_error += shift * rule->transfer->most_rgb;
    return s;
}

void medium_batch_whole(medium_batch *m, const segment_columns *pieces, unsigned i) {
    const medium_rule rule = {
        m->transfer, m->share, m->per_length[i], m->drop, {m->t_error[i], m->value_error[i]}};
    double range[2];
    segment_values(pieces->b[0][i], pieces->spread[i], range);
    const medium_stretch seen = medium_of_range(&rule, range, pieces->t1[i] - pieces->t0[i]);
    medium_batch_put(m, i, &seen);
}
