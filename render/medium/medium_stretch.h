/* medium_stretch.h - what a ray sees of a stretch of a medium: emission and absorption, with a
 * bound on the error (M08 2.2.2 for the integral; the bound is ours).
 *
 * A stretch is computed by itself. The result is its light, as if nothing were in front of it, and
 * the share of light that comes through it. medium_join() joins two neighbours into one stretch.
 *
 * The rule. A stretch with opacity A = 1 - T and length l may have an error of
 *
 *     share * A + per_length * l                                              (1)
 *
 * If two neighbours F and B keep it, so does the whole: its error is e(F) + T(F) e(B), its opacity
 * is A(F) + T(F) A(B), and T(F) l(B) <= l(B). So a piece is independent of what is in front of it.
 * The lengths l sum up to at most the ray's length L. So a pixel's error is at most share +
 * per_length L, plus what is left out at the end (medium_rule.drop), plus rounding.
 *
 * A piece of a ray in a cell (segments.h) is cut where its value passes a point of the transfer
 * function. Between two cuts, with s in [0, 1], the value is a polynomial, and so is w(s) = (f(s) -
 * base) / width; colour c = c0 + w dc and extinction k = k0 + w dk too. The optical depth tau(s) is
 * the integral of k. By parts,
 *
 *     integral of c k e^-tau = c(0) - c(1) e^-tau(1) + dc J,     J = integral of w' e^-tau ds (2)
 *
 * Replace e^-tau by its tangent at half the depth h = tau(1) / 2. The tangent is too small by 0 to
 * 1 - (1 + h) e^-h <= R = min(1, h^2 / 2), so half of R is added. (Where h is 1 or more, 1/2 alone
 * is enough.) Then J is the integral of a polynomial, which can be computed exactly, and
 *
 *     error <= |dc| (integral of |w'|) R / 2                                            (3)
 *
 * where the sum of the differences of w's Bernstein coefficients bounds the integral of |w'|. If
 * this error is more than (1) allows, and more than half of what rounding adds, the stretch is
 * walked in steps. By (3) the error of a short step falls with the third power of its length, the
 * allowed error with the first. So the error of one step gives the length of the next, as in
 * solvers of differential equations.
 *
 * Rounding. The value has the error that segments.h says, and the slope times the error of t. Where
 * the transfer function is continuous, that moves w by the error / width, the depth by that times
 * dk l, the colour by that times dc.
 *
 * Cuts. At a cut the value differs from v by a known `off`. Where the transfer function is
 * continuous, a stretch between two cuts leaves its span by off at most. Beyond the span's end y',
 * its line is used all the same. At the value y this adds an error of the rate times |y - y'|. The
 * true value differs from y' by at most off plus the value's own error e. So e + 2 off takes the
 * place of e. Where the transfer function is not continuous, a moved cut matters more: around it,
 * where the value is within 2 e + off of the point,
 * colour and extinction may be those beyond the point. The length of that stretch is bounded by the
 * derivative, or by Chebyshev's polynomials where the derivative vanishes: a polynomial p of degree
 * n with |p| <= e on an interval of length m, and |p| = M somewhere on one of length l around it,
 * has M <= e/2 (4 l / m)^n.
 */
#ifndef RENDER_MEDIUM_MEDIUM_STRETCH_H
#define RENDER_MEDIUM_MEDIUM_STRETCH_H

#include "render/look/transfer.h"
#include "render/ray/segments.h"

/* "What is seen" of a stretch, here and in the other files of media. */
typedef struct medium_stretch {
    double rgb[3];        /* its light */
    double through;       /* the share of light that comes through it */
    double rgb_error;     /* bound for each component */
    double through_error; /* likewise */
} medium_stretch;

static inline medium_stretch medium_nothing(void) {
    return (medium_stretch){.through = 1.0};
}

typedef struct medium_rule {
    const transfer *transfer;
    double share, per_length; /* see (1) */
    double drop;              /* light that may be left out inside a piece, once per span */
    segments_error error;     /* of the pieces */
} medium_rule;

/* medium_join() - put `behind` behind *front. No light of `behind` is over most_rgb. */
static inline void medium_join(medium_stretch *front, const medium_stretch *behind,
                               double most_rgb) {
    const double reaching = front->through + front->through_error;
    /* The light of `behind` is at most most_rgb, and at most what was found and its error. */
    double light = behind->rgb[0];
    light = light < behind->rgb[1] ? behind->rgb[1] : light;
    light = light < behind->rgb[2] ? behind->rgb[2] : light;
    light = light < most_rgb ? light : most_rgb;
    front->rgb_error += reaching * behind->rgb_error + front->through_error * light;
    front->through_error = reaching * behind->through_error +
                           front->through_error * behind->through + 0x1p-53 * front->through;
    for (int c = 0; c < 3; c++)
        front->rgb[c] += front->through * behind->rgb[c];
    front->through *= behind->through;
}

/* medium_of_piece() - what is seen of a piece in a filled volume. t is world length. */
medium_stretch medium_of_piece(const medium_rule *rule, const segment *piece);

/* ---- For vectors ---- */

/* medium_add_ends() - add the errors of the piece's ends, which are off by up to t_error. */
void medium_add_ends(const transfer *t, double t_error, medium_stretch *seen);

/* The most steps in search of a cut; 54 of them take the middle. */
enum { MEDIUM_CUT_STEPS = 216 };

/* Where rounding alone exceeds what (1) allows, the tangent's error may be this share of it. A step
 * of length h has the error a h^3 + q h + r: tangent, value, rounding. Along the ray that is (a h^2
 * + q + r / h), least where a h^3 = r / 2. So no step is shorter than is useful, and asking for a
 * smaller error never gives a larger one. */
#define MEDIUM_STEP_OF_REST 0.5

/* Steps through a span. SHARE: a step is this share of the greatest length that would do, for
 * safety. LEAST, MOST: limits of the factor from one step to the next. SHORTEST: the least step,
 * for a piece of length 1. */
#define MEDIUM_STEP_SHARE    0.9
#define MEDIUM_STEP_LEAST    0.0625
#define MEDIUM_STEP_MOST     4.0
#define MEDIUM_STEP_SHORTEST 0x1p-46

/* The integral of w' tau, of degrees 2 and 4, by Bernstein coefficients: C(2, i) C(4, j) /
 * (C(6, i + j) 7), times the 3 of w'. */
#define MEDIUM_MOMENT                                                     \
    {                                                                     \
        {3.0 / 7.0, 2.0 / 7.0, 6.0 / 35.0, 3.0 / 35.0, 1.0 / 35.0},       \
            {1.0 / 7.0, 8.0 / 35.0, 9.0 / 35.0, 8.0 / 35.0, 1.0 / 7.0}, { \
            1.0 / 35.0, 3.0 / 35.0, 6.0 / 35.0, 2.0 / 7.0, 3.0 / 7.0      \
        }                                                                 \
    }

#endif
