/* medium_doubt.h - media where a preview misses treelets: what is drawn there, and how far that may
 * be off.
 *
 * The directory says between which values the finest data are, lo and hi, whatever is resident. So
 * on a length l the extinction is between k0 and k1, its least and its greatest value over that
 * range; and where anything is seen, each component of the colour is between c0 and c1. If some of
 * the data may be missing (NaN), k0 is 0. Then
 *
 *     e^-(k1 l) <= through <= e^-(k0 l)
 *     c0 (1 - e^-(k0 l)) <= light <= c1 (1 - e^-(k1 l))                                    (1)
 *
 * for the light of a stretch is a mean of its colours times its opacity. What is drawn is a guess,
 * by coarser treelets or by nothing, brought within (1). Its error is the distance to the further
 * end, and so true whatever the guess is. The rule of medium_stretch.h is not kept; but many doubts
 * in a row are off by no more than there is to be seen (medium_doubt_join()).
 *
 * Where deviations are known, a guess is a piece of a coarser treelet of whose value v the true one
 * is within e (deviation.h, and what the piece's value errs by). Then (1) is of the piece alone,
 * and the range is that of v, widened by e, as far as the directory allows. And if nothing is
 * missing, v itself says more. Let the extinction change by up to d, a component of the colour by
 * up to g where values are up to e apart, and the colour be up to c. With k, T = e^-tau of v, k',
 * T' of the true value,
 *
 *     e^-(d s) T(s) <= T'(s) <= e^(d s) T(s)
 *     c' k' T' - c k T = (c' - c) k' T' + c (k' - k) T' + c k (T' - T)
 *
 * at each s up to l. The integral of k' T' is the opacity A', that of T' is at most l, that of k T
 * is A. So
 *
 *     |T' - T| <= T (e^(d l) - 1)
 *     |light' - light| <= g A' + c (d l + A (e^(d l) - 1))                              (2)
 *
 * beside the error of T and of the light of v. Of (1) and (2) the lesser one is taken, for the two
 * numbers each by itself: what comes through and the light.
 */
#ifndef RENDER_MEDIUM_MEDIUM_DOUBT_H
#define RENDER_MEDIUM_MEDIUM_DOUBT_H

#include "render/medium/medium_stretch.h"

/* What there may be in treelets. */
typedef struct medium_doubtful {
    transfer_extent extent; /* where something is */
    bool gaps;              /* there may be nothing in places */
    double range[2];        /* of values */
} medium_doubtful;

/* A ray in it. Zeroed: in none. */
typedef struct medium_doubt {
    double from, to; /* t: what is in doubt, and was not yet taken; from >= to: nothing */
    medium_doubtful what;
    bool beside;          /* between pieces, which are true; else in place of them, */
    bool bounded;         /* and pieces say how far they are off */
    medium_stretch guess; /* by such pieces, so far */
} medium_doubt;

/* medium_doubtful_of() - of the values of treelet `of` of the tracer's volume. */
medium_doubtful medium_doubtful_of(const transfer *t, const tracer *tr, uint32_t of);

/* medium_doubt_begin() - piece `is` is a doubt about `what`; what is before it has been taken. */
void medium_doubt_begin(medium_doubt *d, const segment *is, const medium_doubtful *what);

/* medium_doubt_take() - what is known to be seen of it before t, where the next piece begins.
 * False: nothing, or not yet. */
bool medium_doubt_take(medium_doubt *d, const medium_rule *rule, double t, medium_stretch *seen);

/* medium_doubt_bounds() - whether a piece that begins at t0 is a guess that says how far it is off.
 * medium_doubt_near() - it is one: *seen, of v alone, becomes what is known of it. */
bool medium_doubt_bounds(const medium_doubt *d, double t0);
void medium_doubt_near(const medium_doubt *d, const medium_rule *rule, const segment *piece,
                       medium_stretch *seen);

/* medium_doubt_guess() - a piece that ends at t1 comes next, of which that is seen. True: it is a
 * guess, and has been taken in. */
bool medium_doubt_guess(medium_doubt *d, double t1, const medium_stretch *seen);

/* medium_doubt_within() - *seen as it is where `what` is on such a length. */
void medium_doubt_within(const medium_rule *rule, const medium_doubtful *what, double length,
                         medium_stretch *seen);

/* medium_doubt_join() - medium_join() where a doubt is among it: no more comes through than all,
 * and no component of light is more than most_rgb times the opacity. */
void medium_doubt_join(medium_stretch *front, const medium_stretch *behind, double most_rgb);

#endif
