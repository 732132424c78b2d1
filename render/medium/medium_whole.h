/* medium_whole.h - media in nodes and treelets whose values hardly differ: what is seen of the
 * whole way through one at once (M08 4.5, whose threshold promises nothing; the bound is ours).
 *
 * Let the extinction be in [k - d, k + d] where the value is in a range, and each component of the
 * colour in [c - e, c + e]. Over a length l, take k and c: through = e^(-k l), light = c (1 -
 * through). The light of a stretch is a mean of its colours times its opacity, so
 *
 *     error of through   <= D = e^-((k - d) l) - e^(-k l)
 *     error of the light <= e (1 - through) + (c + e) D                                    (1)
 *
 * Neither what is behind a stretch nor what it is in front of is brighter than b. So a stretch
 * spends its error of light plus b D. Two neighbours F and B together spend no more than F and
 * through(F) times B: the light of B is at most b times its opacity, and where D(F) counts for
 * that, it does not for the rest. So the whole keeps the rule of medium_stretch.h if each stretch
 * spends at most share A + per_length l. Now
 *
 *     D = d integral from 0 to l of e^(-(k - d) (l - s)) e^(-k s) ds
 *       <= d min(l, (1 - e^(-k l)) / k)
 *
 * because the first factor is at most 1. With A = 1 - e^(-k l) <= k l, for any l, it is enough that
 *
 *     (b + c + e) d + (e - share) k <= per_length                                           (2)
 *
 * If a range keeps (2), so does each part of it: both ends of k move (b + c + e) d by at least as
 * much as they may move the other term, b being 1 or more, share 1 or less. So (2) is tested for a
 * few ranges only (homogeneous.h), once for all rays, with per_length of the longest ray. Nine
 * tenths of it are allowed; the rest is for products of errors.
 */
#ifndef RENDER_MEDIUM_MEDIUM_WHOLE_H
#define RENDER_MEDIUM_MEDIUM_WHOLE_H

#include "render/medium/medium_batch.h"
#include "stream/homogeneous.h"

/* The condition under which a range is homogeneous. */
typedef struct medium_whole_rule {
    const transfer *transfer;
    double share, per_length; /* of all rays */
    double brightest;         /* b: 1 or more */
    double threshold;         /* above 0: ranges up to this width, instead of (2); errors follow */
} medium_whole_rule;

/* medium_whole() - which values in range[0] .. range[1] are equivalent; range[0] > range[1]: no
 * values. integers: values are whole numbers. */
homogeneous medium_whole(const medium_whole_rule *rule, const double range[2], bool integers);

/* medium_of_range() - what is seen of a length where the only thing known is that values are in
 * range[0] .. range[1]. */
medium_stretch medium_of_range(const medium_rule *rule, const double range[2], double length);

/* medium_batch_whole() - do piece i, which has a spread, and store it in the batch's columns. */
void medium_batch_whole(medium_batch *m, const segment_columns *pieces, unsigned i);

#endif
