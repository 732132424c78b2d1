#include "render/medium/medium_doubt.h"

#include <math.h>
#include <string.h>

#include "formats/base/portable_math.h"

/* ---- Bounds ---- */

/* Clamp *x to [lo, hi]. Returns how far it may be off then, if the true value is in [lo, hi]. */
static double bring_within(double *x, double lo, double hi) {
    *x = fmin(fmax(*x, lo), hi);
    return fmax(hi - *x, *x - lo);
}

void medium_doubt_within(const medium_rule *rule, const medium_doubtful *what, double length,
                         medium_stretch *seen) {
    const double rounding = 64.0 * 0x1p-53;
    const transfer_extent x = what->extent;
    const double most = portable_exp(-((what->gaps ? 0.0 : x.k[0]) * length));
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

/* Clamp each component of light to at most most_rgb times the opacity. Returns how far the light
 * may be off then. */
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

medium_doubtful medium_doubtful_of(const transfer *t, const tracer *tr, uint32_t of) {
    medium_doubtful what;
    what.gaps = segment_doubted(tr, of, what.range);
    what.extent = transfer_extent_of(t, what.range[0], what.range[1]);
    return what;
}

static void take_in(double range[2], const double more[2]) {
    range[0] = fmin(range[0], more[0]);
    range[1] = fmax(range[1], more[1]);
}

void medium_doubt_begin(medium_doubt *d, const segment *is, const medium_doubtful *what) {
    const medium_doubt before = *d;
    const bool beside = is->spread == SEGMENT_BESIDE;
    *d = (medium_doubt){.from = is->t0,
                        .to = is->t1,
                        .what = *what,
                        .beside = beside,
                        .bounded = is->spread == SEGMENT_BOUNDED,
                        .guess = medium_nothing()};
    if (!beside)
        return;
    d->what.gaps = true;
    if (!before.beside || !(is->t0 < before.to))
        return;
    d->from = fmax(before.from, is->t0);
    d->to = fmax(before.to, is->t1);
    take_in(d->what.extent.k, before.what.extent.k);
    for (int c = 0; c < 3; c++)
        take_in(d->what.extent.rgb[c], before.what.extent.rgb[c]);
}

bool medium_doubt_take(medium_doubt *d, const medium_rule *rule, double t, medium_stretch *seen) {
    const double until = fmin(t, d->to);
    if (d->bounded) { /* no medium where no piece was */
        d->from = fmax(d->from, until);
        return false;
    }
    if (!(d->from < until) || (!d->beside && t < d->to))
        return false;
    *seen = d->guess;
    medium_doubt_within(rule, &d->what, until - d->from, seen);
    d->from = until;
    return true;
}

bool medium_doubt_bounds(const medium_doubt *d, double t0) {
    return d->bounded && t0 < d->to;
}

/* Widen the errors by (2), the difference between v and the true values. */
static void add_change(const transfer_change *by, double length, medium_stretch *seen) {
    const double rounding = 64.0 * 0x1p-53, depth = by->k * length;
    const double grown = portable_exp(depth) - 1.0 + rounding;
    const double through = fmin(seen->through + seen->through_error, 1.0);
    const double least = fmax(seen->through - seen->through_error, 0.0);
    const double opacity = 1.0 - least,
                 most_opacity = 1.0 - least * portable_exp(-depth) + rounding;
    seen->through_error += through * grown + rounding;
    seen->rgb_error += by->rgb * most_opacity + by->most_rgb * (depth + opacity * grown + rounding);
}

void medium_doubt_near(const medium_doubt *d, const medium_rule *rule, const segment *piece,
                       medium_stretch *seen) {
    const double off = piece->spread + segment_value_error(piece, &rule->error);
    const double length = piece->t1 - piece->t0;
    double lo = piece->b[0], hi = piece->b[0];
    for (uint32_t i = 1; i <= piece->degree; i++) {
        lo = fmin(lo, piece->b[i]);
        hi = fmax(hi, piece->b[i]);
    }
    lo -= off;
    hi += off;
    medium_doubtful what = {.gaps = d->what.gaps};
    what.range[0] = fmin(fmax(lo, d->what.range[0]), d->what.range[1]);
    what.range[1] = fmax(fmin(hi, d->what.range[1]), d->what.range[0]);
    what.extent = transfer_extent_of(rule->transfer, what.range[0], what.range[1]);
    medium_stretch within = *seen, near = *seen;
    medium_doubt_within(rule, &what, length, &within);
    *seen = within;
    const transfer_change by = transfer_change_of(rule->transfer, lo, hi, off);
    if (d->what.gaps || !(by.k * length < 1.0))
        return;
    add_change(&by, length, &near);
    if (near.through_error < within.through_error) {
        seen->through = near.through;
        seen->through_error = near.through_error;
    }
    if (near.rgb_error < within.rgb_error) {
        memcpy(seen->rgb, near.rgb, sizeof near.rgb);
        seen->rgb_error = near.rgb_error;
    }
}

bool medium_doubt_guess(medium_doubt *d, double t1, const medium_stretch *seen) {
    if (d->beside)
        d->from = fmax(d->from, t1);
    if (d->beside || !(d->from < d->to))
        return false;
    medium_join(&d->guess, seen, INFINITY);
    return true;
}
