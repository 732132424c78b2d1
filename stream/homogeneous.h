/* homogeneous.h - ranges of values within which it does not matter which value it is (M08 4.5).
 *
 * A treelet or a node whose values lie in such a range is taken whole: a ray has one piece in it,
 * of the range's middle (segments.h); and such a treelet is not read. Which ranges these are is
 * said by whoever knows what values stand for: for each of a row of bins, how far a range may go
 * that begins there. What lies in a range that is homogeneous is so, too.
 */
#ifndef STREAM_HOMOGENEOUS_H
#define STREAM_HOMOGENEOUS_H

#include <stdbool.h>

enum { HOMOGENEOUS_BINS = 512 };

/* Zeroed: no range is. */
typedef struct homogeneous {
    int bins;     /* at most HOMOGENEOUS_BINS */
    double first; /* where the first one begins, */
    double width; /* and how far it is to the next one; > 0 */
    float until[HOMOGENEOUS_BINS];
} homogeneous;

/* homogeneous_begin() - where bin i begins, at the latest: values may be taken for those of the
 * next bin if they are less than 1e-9 of a bin below it. Widths that are powers of two, and
 * integers, have no rounding. */
static inline double homogeneous_begin(const homogeneous *h, int i) {
    return h->first + i * h->width;
}

/* homogeneous_holds() - whether the range from lo to hi is homogeneous. One value always is, where
 * any range may be. */
static inline bool homogeneous_holds(const homogeneous *h, double lo, double hi) {
    if (h->bins == 0 || !(lo <= hi))
        return false;
    if (lo == hi)
        return true;
    const double at = (lo - h->first) / h->width;
    if (!(at >= 0.0))
        return false;
    return hi <= (double)h->until[at < h->bins ? (int)at : h->bins - 1];
}

/* homogeneous_except() - no range that holds the value and something below it: an isovalue. */
void homogeneous_except(homogeneous *h, double value);

bool homogeneous_same(const homogeneous *a, const homogeneous *b);

#endif
