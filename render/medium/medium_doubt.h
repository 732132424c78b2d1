/* medium_doubt.h - media where a preview misses treelets: a guess is drawn there, with a bound of
 * its error.
 *
 * Also for an absent treelet, the directory gives the least and the greatest value of the finest
 * level, lo and hi. Let k0 and k1 be the least and the greatest extinction of values from lo to hi,
 * c0 and c1 likewise for a component of the colour where anything is seen. If data may be missing
 * there (NaN), k0 is 0. Then on a length l
 *
 *     e^-(k1 l) <= through <= e^-(k0 l)
 *     c0 (1 - e^-(k0 l)) <= light <= c1 (1 - e^-(k1 l))                                    (1)
 *
 * because the light of a stretch is a mean of its colours times its opacity. A guess is drawn, from
 * coarser treelets or from nothing, and clamped to (1). Its error is the distance to the further
 * end of (1): a true bound, whatever the guess is. The rule of medium_stretch.h is not kept. But
 * even many doubts in a row are off by no more than could be seen at all (medium_doubt_join()).
 *
 * Where deviations are known, a guess is a piece of a coarser treelet. The true value is within e
 * of the piece's value v; e is the deviation (deviation.h) and the error of v. Then (1) holds for
 * the piece alone, with a smaller range: of v, widened by e, and cut to the directory's range. If
 * no data are missing, a second bound follows from v itself. For values up to e apart, let
 * extinction differ by up to d, and a component of the colour by up to g; let it be c at most.
 * Write k and T = e^-tau for v, k' and T' for the true value. Then
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
 * plus the error of T and of the light as computed from v. The smaller of the bounds (1) and (2) is
 * used, chosen for `through` and for the light separately.
 */
#ifndef RENDER_MEDIUM_MEDIUM_DOUBT_H
#define RENDER_MEDIUM_MEDIUM_DOUBT_H

#include "render/medium/medium_stretch.h"

/* What an absent treelet may hold, or several that overlap on a ray. */
typedef struct medium_doubtful {
    transfer_extent extent; /* of places that hold something */
    bool gaps;              /* places may hold nothing */
    double range[2];        /* of values */
} medium_doubtful;

/* A ray's doubt. Zeroed: none. */
typedef struct medium_doubt {
    double from, to; /* t of the part in doubt that is not yet taken; from >= to: none */
    medium_doubtful what;
    bool beside;          /* pieces there are true, the doubt is between them; else guesses, */
    bool bounded;         /* and the spread of each guess bounds its error */
    medium_stretch guess; /* the guesses so far, joined */
} medium_doubt;

/* medium_doubtful_of() - what treelet `of` of the tracer's volume may hold. */
medium_doubtful medium_doubtful_of(const transfer *t, const tracer *tr, uint32_t of);

/* medium_doubt_begin() - begin the doubt that piece `is` announces; `what`: what its treelet may
 * hold. Call medium_doubt_take() for everything before it first. */
void medium_doubt_begin(medium_doubt *d, const segment *is, const medium_doubtful *what);

/* medium_doubt_take() - take the part of the doubt before t, the start of the next piece, and set
 * *seen to what is known of it. Returns false if there is no such part, or the doubt goes on at t
 * and is taken as a whole later. */
bool medium_doubt_take(medium_doubt *d, const medium_rule *rule, double t, medium_stretch *seen);

/* medium_doubt_bounds() - whether a piece that begins at t0 is a guess whose spread bounds its
 * error. */
bool medium_doubt_bounds(const medium_doubt *d, double t0);

/* medium_doubt_near() - for such a piece. *seen: on entry computed from the guess's values v alone;
 * on return what is known of the true values, by (1) and (2). */
void medium_doubt_near(const medium_doubt *d, const medium_rule *rule, const segment *piece,
                       medium_stretch *seen);

/* medium_doubt_guess() - tell the doubt of the next piece, which ends at t1, and of what is seen of
 * it. Returns true if the piece is a guess: then it has been joined to d->guess. */
bool medium_doubt_guess(medium_doubt *d, double t1, const medium_stretch *seen);

/* medium_doubt_within() - clamp *seen to (1), for `what` on a length, and set its errors. */
void medium_doubt_within(const medium_rule *rule, const medium_doubtful *what, double length,
                         medium_stretch *seen);

/* medium_doubt_join() - as medium_join(), for rays with doubts. Also limits errors to what is
 * possible: `through` is at most 1, and light at most most_rgb times the opacity. */
void medium_doubt_join(medium_stretch *front, const medium_stretch *behind, double most_rgb);

#endif
