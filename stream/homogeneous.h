/* homogeneous.h - ranges of values within which the exact value does not matter (M08 4.5).
 *
 * A treelet or node whose values lie in a homogeneous range is taken whole: a ray has one piece in
 * it, with the middle of the range (segments.h). A whole treelet is not read. The caller, who knows
 * what values stand for, gives the ranges: for each bin of values, how far a range that begins
 * there may go. Every part of a homogeneous range is homogeneous, too.
 */
#ifndef STREAM_HOMOGENEOUS_H
#define STREAM_HOMOGENEOUS_H

#include <stdbool.h>

enum { HOMOGENEOUS_BINS = 512 };

/* Zeroed: no range is homogeneous. */
typedef struct homogeneous {
    int bins;     /* at most HOMOGENEOUS_BINS */
    double first; /* where the first bin begins */
    double width; /* of a bin; > 0 */
    float until[HOMOGENEOUS_BINS];
} homogeneous;

/* homogeneous_begin() - returns where bin i begins. By rounding, a value that is lower by less than
 * 1e-9 of a bin's width may be counted in bin i, too. Nothing is rounded if bin widths are powers
 * of two or values are integers. */
static inline double homogeneous_begin(const homogeneous *h, int i) {
    return h->first + i * h->width;
}

/* homogeneous_holds() - returns whether the range from lo to hi is homogeneous. A single value
 * always is, unless there are no bins. */
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

/* homogeneous_except() - exclude all ranges that hold an isovalue and anything below it. */
void homogeneous_except(homogeneous *h, double value);

bool homogeneous_same(const homogeneous *a, const homogeneous *b);

#endif
