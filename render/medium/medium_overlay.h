/* medium_overlay.h - what a ray sees of a stretch where several media are at one place: extinctions
 * add, and so does the emitted light (DESIGN 5.13). The rule is that of medium_stretch.h, so these
 * stretches can be joined with others.
 *
 * The value of each medium is a polynomial over the stretch. The stretch is halved until what is
 * seen of it is known well enough, by the best of three ways:
 *
 *   - Every value keeps to one span of its transfer function, and to that span's reach with its
 *     error. Then k = sum of k_i, the optical depth tau and q = sum of c_i k_i are polynomials (of
 *     degrees 3, 4 and 6) in s. As in medium_stretch.h, e^-tau is replaced by its tangent at half
 *     the depth, h = tau(1) / 2, plus half of R = min(1, h^2 / 2). q times this is a polynomial of
 *     degree 10, which six points of Gauss's rule integrate exactly. The error is (integral of q)
 *     R / 2.
 *   - The light is a mean of colours, all between c_min and c_max, times the opacity. Take the
 *     middle; its error is half of c_max - c_min times the opacity.
 *   - For any values: each medium's extinction and colour have a least and a largest value in the
 *     range of its values. The sum of extinctions, and the colour, are bounded by these.
 *
 * Near a cut only the last way works. There (1) of medium_stretch.h cannot be kept, but the error
 * is proportional to the length. An error of at most `enough` is accepted, and so is any error if
 * the values are not known better. It is part of the bound that is returned.
 */
#ifndef RENDER_MEDIUM_MEDIUM_OVERLAY_H
#define RENDER_MEDIUM_MEDIUM_OVERLAY_H

#include "render/medium/medium_stretch.h"

enum { MEDIUM_LAYERS_MAX = 16 };

/* One of the media. */
typedef struct medium_layer {
    const transfer *transfer;
    double b[4];        /* the value over the stretch, of degree 3 */
    double value_error; /* bound of its error, with the rounding of halvings */
    double end_error;   /* likewise of the stretch's ends, in t */
    double light[3];    /* factors of the colours (medium_shade.h); 1 if not shaded */
} medium_layer;

typedef struct medium_overlay_rule {
    double share, per_length, drop; /* as of medium_rule */
    double enough;                  /* error of light that is accepted anywhere */
    double most_rgb;                /* the largest component of any colour */
} medium_overlay_rule;

/* medium_layer_of() - make a layer from the part [a, b], in [0, 1], of a piece. */
medium_layer medium_layer_of(const medium_rule *rule, const segment *piece, double a, double b);

/* medium_of_layers() - what is seen of 1 to MEDIUM_LAYERS_MAX media over a length of t. */
medium_stretch medium_of_layers(const medium_overlay_rule *rule, const medium_layer layers[],
                                int count, double length);

#endif
