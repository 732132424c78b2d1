/* medium_whole.h - media in nodes and treelets whose values hardly differ: what is seen of the
 * whole way through one at once (M08 4.5, whose threshold promises nothing; the bound is ours).
 *
 * Let the extinction be in [k - d, k + d] where the value is in a range, and each component of the
 * colour in [c - e, c + e]. Over a length l, k and c are taken: through = e^(-k l), light = c (1 -
 * through). The light of a stretch is a mean of its colours times its opacity, so
 *
 *     error of through   <= D = e^-((k - d) l) - e^(-k l)
 *     error of the light <= e (1 - through) + (c + e) D                                    (1)
 *
 * What is behind a stretch and what it is in front of are no brighter than b. So a stretch spends
 * its error of light plus b D: two that follow each other, F and B, spend no more together than F
 * does and through(F) times what B does; for the light of B is at most b times its opacity, and
 * where D(F) counts for that, it does not for the rest. So all of it keeps the rule of
 * medium_stretch.h if each stretch spends at most share A + per_length l. Now
 *
 *     D = d integral from 0 to l of e^(-(k - d) (l - s)) e^(-k s) ds <= d min(l, (1 - e^(-k l)) /
 * k)
 *
 * because the first factor is at most 1. With A = 1 - e^(-k l) <= k l, whatever l is, it is enough
 * that
 *
 *     (b + c + e) d + (e - share) k <= per_length                                           (2)
 *
 * If a range keeps that, so does what lies in it: both ends of k move (b + c + e) d by at least as
 * much as they may move the other term, b being 1 or more, share 1 or less. So (2) needs to be
 * known of a few ranges alone (homogeneous.h), once for all rays: per_length is that of the longest
 * one. Nine tenths of it are allowed: products of errors are what the rest is for.
 */
#ifndef RENDER_MEDIUM_MEDIUM_WHOLE_H
#define RENDER_MEDIUM_MEDIUM_WHOLE_H

#include "render/medium/medium_batch.h"
#include "stream/homogeneous.h"

/* What makes a range homogeneous. */
typedef struct medium_whole_rule {
    const transfer *transfer;
    double share, per_length; /* of all rays */
    double brightest;         /* b: 1 or more */
    double
        threshold; /* above 0: instead of (2), ranges so wide are, and errors are what they are */
} medium_whole_rule;

/* medium_whole() - for values in range[0] .. range[1] (none: the first is greater); integers: they
 * are whole numbers. */
homogeneous medium_whole(const medium_whole_rule *rule, const double range[2], bool integers);

/* medium_of_range() - what is seen of a length where values are in range[0] .. range[1], and
 * nothing else is known of them. */
medium_stretch medium_of_range(const medium_rule *rule, const double range[2], double length);

/* medium_batch_whole() - of piece i, which has a spread, into the batch's columns. */
void medium_batch_whole(medium_batch *m, const segment_columns *pieces, unsigned i);

#endif
