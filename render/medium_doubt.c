#include "render/medium_doubt.h"

#include <math.h>

#include "formats/base/portable_math.h"

/* ---- Bounds ---- */

/* How far x may be off that should be in [lo, hi], where it is moved to. */
static double bring_within(double *x, double lo, double hi) {
    *x = fmin(fmax(*x, lo), hi);
    return fmax(hi - *x, *x - lo);
}

void medium_doubt_within(const medium_rule *rule, const double range[2], bool gaps, double length,
                         medium_stretch *seen) {
    const double rounding = 64.0 * 0x1p-53;
    const transfer_extent x = transfer_extent_of(rule->transfer, range[0], range[1]);
    const double most = portable_exp(-((gaps ? 0.0 : x.k[0]) * length));
    const double least = portable_exp(-(x.k[1] * length));
    if (x.k[1] == 0.0) {
        *seen = medium_nothing();
        return;
    }
    seen->through_error = bring_within(&seen->through, least, most) + rounding;
    seen->rgb_error = 0.0;
    for (int c = 0; c < 3; c++) {
        const double off =
            bring_within(&seen->rgb[c], x.rgb[c][0] * (1.0 - most), x.rgb[c][1] * (1.0 - least));
        seen->rgb_error = fmax(seen->rgb_error, off + rounding * x.rgb[c][1]);
    }
    medium_add_ends(rule->transfer, 1.5 * rule->error.t, seen);
}

/* No component of light is more than most_rgb times the opacity: how far it may be off then. */
static double bring_to_light(medium_stretch *seen, double most_rgb) {
    const double least_through = fmax(seen->through - seen->through_error, 0.0);
    const double most = most_rgb * (1.0 - least_through) * (1.0 + 0x1p-40);
    double off = 0.0;
    for (int c = 0; c < 3; c++)
        off = fmax(off, bring_within(&seen->rgb[c], 0.0, most));
    return off;
}

void medium_doubt_join(medium_stretch *front, const medium_stretch *behind, double most_rgb) {
    const double reaching = fmin(front->through + front->through_error, 1.0);
    const double rgb_error = front->rgb_error + reaching * behind->rgb_error;
    const double through_error = reaching * behind->through_error;
    const double error = front->through_error;
    double light = 0.0;
    for (int c = 0; c < 3; c++)
        light = fmax(light, behind->rgb[c]);
    medium_join(front, behind, most_rgb);
    front->through_error =
        fmin(through_error + error * behind->through, fmax(front->through, 1.0 - front->through)) +
        0x1p-52;
    front->rgb_error = fmin(rgb_error + error * light, bring_to_light(front, most_rgb));
}

/* ---- On the way ---- */

void medium_doubt_begin(medium_doubt *d, const tracer *tr, const segment *is) {
    const bool beside = is->spread == SEGMENT_BESIDE, going_on = beside && is->t0 < d->to;
    double range[2];
    const bool gaps = segment_doubted(tr, is->treelet, range) || beside;
    d->range[0] = going_on ? fmin(d->range[0], range[0]) : range[0];
    d->range[1] = going_on ? fmax(d->range[1], range[1]) : range[1];
    d->from = beside && d->beside ? fmax(d->from, is->t0) : is->t0;
    d->to = going_on ? fmax(d->to, is->t1) : is->t1;
    d->gaps = gaps;
    d->beside = beside;
    d->guess = medium_nothing();
}

bool medium_doubt_take(medium_doubt *d, const medium_rule *rule, double t, medium_stretch *seen) {
    const double until = fmin(t, d->to);
    if (!(d->from < until) || (!d->beside && t < d->to))
        return false;
    *seen = d->guess;
    medium_doubt_within(rule, d->range, d->gaps, until - d->from, seen);
    d->from = until;
    return true;
}

bool medium_doubt_guess(medium_doubt *d, double t1, const medium_stretch *seen) {
    if (d->beside)
        d->from = fmax(d->from, t1);
    if (d->beside || !(d->from < d->to))
        return false;
    medium_join(&d->guess, seen, INFINITY);
    return true;
}
