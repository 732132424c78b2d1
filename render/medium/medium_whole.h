/* medium_whole.h - media in nodes and treelets whose values hardly differ. A ray's whole passage
 * through such a node is computed at once, by its range of values (M08 4.5; the threshold there
 * does not bound the error, the rule here does).
 *
 * Let the extinction be in [k - d, k + d] where the value is in a range, and each component of the
 * colour in [c - e, c + e]. Over a length l, take k and c: through = e^(-k l), light = c (1 -
 * through). The light of a stretch is a mean of its colours times its opacity, so
 *
 *     error of through   <= D = e^-((k - d) l) - e^(-k l)
 *     error of the light <= e (1 - through) + (c + e) D                                    (1)
 *
 * No light behind a stretch is brighter than b. So a stretch costs the pixel at most its error of
 * light plus b D: call this what it spends. Two neighbours F and B together spend no more than F
 * and through(F) times B: the light of B is at most b times its opacity, and the part of D(F) that
 * meets this light does not meet what is behind B. So the whole keeps the rule of medium_stretch.h
 * if each stretch spends at most share A + per_length l. Now
 *
 *     D = d integral from 0 to l of e^(-(k - d) (l - s)) e^(-k s) ds
 *       <= d min(l, (1 - e^(-k l)) / k)
 *
 * because the first factor is at most 1. With A = 1 - e^(-k l) <= k l, for any l, it is enough that
 *
 *     (b + c + e) d + (e - share) k <= per_length                                           (2)
 *
 * If (2) holds for a range, it holds for each part of it: b is 1 or more and share 1 or less, so
 * moving either end of k lowers (b + c + e) d by at least as much as it may raise the other term.
 * So (2) is tested for a
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

/* medium_whole() - returns which ranges within range[0] .. range[1] are homogeneous; none if
 * range[0] > range[1]. integers: values are whole numbers. */
homogeneous medium_whole(const medium_whole_rule *rule, const double range[2], bool integers);

/* medium_of_range() - returns what is seen of a length on which values are known only to lie in
 * range[0] .. range[1]. */
medium_stretch medium_of_range(const medium_rule *rule, const double range[2], double length);

/* medium_batch_whole() - compute piece i, which has a spread, and store what is seen of it in the
 * batch's columns. */
void medium_batch_whole(medium_batch *m, const segment_columns *pieces, unsigned i);

#endif
