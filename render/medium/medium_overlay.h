/* medium_overlay.h - what a ray sees of a stretch where several media are at one place: extinctions
 * add, and so does what is emitted (DESIGN 5.13). The rule is that of medium_stretch.h, so such
 * stretches and others make a ray together.
 *
 * The value of each medium is a polynomial over the stretch; the stretch is halved until what is
 * seen of it is known well enough, by the best of three:
 *
 *   - Every value keeps to one span of its transfer function, and to that span's reach with its
 *     error. Then k = sum of k_i, the optical depth tau and q = sum of c_i k_i are polynomials (of
 *     degrees 3, 4 and 6) in s. Of e^-tau the tangent at half the depth h = tau(1) / 2 is taken,
 *     and half of R = min(1, h^2 / 2) added, as there: the integral of q times that is of degree
 *     10, which six points of Gauss's rule integrate exactly, and it errs by (integral of q) R / 2.
 *   - What is seen is a mean of colours, all between c_min and c_max, times the opacity: half the
 *     difference of these times the opacity is the error.
 *   - Wherever the values are, extinction is between the sums of the least and of the largest ones
 *     in the range of each value, and colours are between those there.
 *
 * Near a cut the last of these alone holds. There, (1) of medium_stretch.h cannot be kept, but the
 * error goes with the length: it is let be where it is `enough` or less, or where values are not
 * known better, and counts.
 */
#ifndef RENDER_MEDIUM_MEDIUM_OVERLAY_H
#define RENDER_MEDIUM_MEDIUM_OVERLAY_H

#include "render/medium/medium_stretch.h"

enum { MEDIUM_LAYERS_MAX = 16 };

/* One of the media. */
typedef struct medium_layer {
    const transfer *transfer;
    double b[4];        /* the value over the stretch, of degree 3 */
    double value_error; /* how far it may be off, roundings of halvings included */
    double end_error;   /* likewise the ends of the stretch: of t */
    double light[3];    /* colours are multiplied by (medium_shade.h): 1, where they are not */
} medium_layer;

typedef struct medium_overlay_rule {
    double share, per_length, drop; /* as of medium_rule */
    double enough;                  /* of light */
    double most_rgb;                /* the largest component of any colour */
} medium_overlay_rule;

/* medium_layer_of() - of what a piece is between a and b, in [0, 1] of it. */
medium_layer medium_layer_of(const medium_rule *rule, const segment *piece, double a, double b);

/* medium_of_layers() - what is seen of 1 to MEDIUM_LAYERS_MAX media over a length of t. */
medium_stretch medium_of_layers(const medium_overlay_rule *rule, const medium_layer layers[],
                                int count, double length);

#endif
