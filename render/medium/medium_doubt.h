/* medium_doubt.h - media where a preview misses treelets: what is drawn there, and a bound of its
 * error.
 *
 * The directory gives the least and the greatest of the finest values, lo and hi, whatever is
 * resident. So on a length l the extinction is between k0 and k1, its least and its greatest value
 * over that range; and where anything is seen, each component of the colour is between c0 and c1.
 * If some of the data may be missing (NaN), k0 is 0. Then
 *
 *     e^-(k1 l) <= through <= e^-(k0 l)
 *     c0 (1 - e^-(k0 l)) <= light <= c1 (1 - e^-(k1 l))                                    (1)
 *
 * because the light of a stretch is a mean of its colours times its opacity. A guess is drawn, from
 * coarser treelets or from nothing, and brought within (1). Its error is the distance to the
 * further end, which is a true bound whatever the guess is. The rule of medium_stretch.h is not
 * kept; but many doubts in a row are off by no more than there is to be seen (medium_doubt_join()).
 *
 * Where deviations are known, a guess is a piece of a coarser treelet. The true value is within e
 * of the piece's value v; e is the deviation (deviation.h) and the error of v. Then (1) holds for
 * the piece alone, and the range is that of v, widened by e, within the directory's range. And if
 * no data are missing, v itself bounds more. Let the extinction change by up to d, a component of
 * the colour by up to g where values are up to e apart, and the colour be up to c. With k, T =
 * e^-tau of v, k', T' of the true value,
 *
 *     e^-(d s) T(s) <= T'(s) <= e^(d s) T(s)
 *     c' k' T' - c k T = (c' - c) k' T' + c (k' - k) T' + c k (T' - T)
 *
 * at each s up to l. The integral of k' T' is the opacity A', the integral of T' is at most l, and
 * the integral of k T is A. So
 *
 *     |T' - T| <= T (e^(d l) - 1)
 *     |light' - light| <= g A' + c (d l + A (e^(d l) - 1))                              (2)
 *
 * beside the error of T and of the light of v. The lesser of the bounds (1) and (2) is taken,
 * separately for what comes through and for the light.
 */
#ifndef RENDER_MEDIUM_MEDIUM_DOUBT_H
#define RENDER_MEDIUM_MEDIUM_DOUBT_H

#include "render/medium/medium_stretch.h"

/* What treelets may hold. */
typedef struct medium_doubtful {
    transfer_extent extent; /* of places that hold something */
    bool gaps;              /* places may hold nothing */
    double range[2];        /* of values */
} medium_doubtful;

/* A ray's doubt. Zeroed: none. */
typedef struct medium_doubt {
    double from, to; /* t: in doubt, and not yet taken; from >= to: nothing is */
    medium_doubtful what;
    bool beside;          /* the doubt is between pieces, which are true; else in place of them, */
    bool bounded;         /* and pieces bound how far they are off */
    medium_stretch guess; /* joined from such pieces so far */
} medium_doubt;

/* medium_doubtful_of() - what treelet `of` of the tracer's volume may hold. */
medium_doubtful medium_doubtful_of(const transfer *t, const tracer *tr, uint32_t of);

/* medium_doubt_begin() - begin a doubt: piece `is`, about `what`. Everything before it must have
 * been taken. */
void medium_doubt_begin(medium_doubt *d, const segment *is, const medium_doubtful *what);

/* medium_doubt_take() - set *seen to what is known of the doubt before t, where the next piece
 * begins. Returns false if there is nothing, or not yet. */
bool medium_doubt_take(medium_doubt *d, const medium_rule *rule, double t, medium_stretch *seen);

/* medium_doubt_bounds() - whether a piece that begins at t0 is a guess that bounds how far it is
 * off. medium_doubt_near() - for such a piece: turn *seen, of v alone, into what is known of the
 * true values. */
bool medium_doubt_bounds(const medium_doubt *d, double t0);
void medium_doubt_near(const medium_doubt *d, const medium_rule *rule, const segment *piece,
                       medium_stretch *seen);

/* medium_doubt_guess() - offer the next piece, which ends at t1, and what is seen of it. Returns
 * true if it is a guess, and has been taken. */
bool medium_doubt_guess(medium_doubt *d, double t1, const medium_stretch *seen);

/* medium_doubt_within() - bring *seen within (1) for `what` on a length, and set its errors. */
void medium_doubt_within(const medium_rule *rule, const medium_doubtful *what, double length,
                         medium_stretch *seen);

/* medium_doubt_join() - medium_join() where a doubt is involved. Limits the errors: no more than
 * all light comes through, and no component of light is more than most_rgb times the opacity. */
void medium_doubt_join(medium_stretch *front, const medium_stretch *behind, double most_rgb);

#endif
