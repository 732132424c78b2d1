/* interest.h - which values of a volume are asked for: a set of intervals. It decides which
 * treelets, nodes and cells are needed; nothing below the integrators knows isovalues.
 *
 * Cells and nodes are judged by the range [min, max] of their samples, which is also the range of
 * their interpolant. One rule serves every interval: it is met iff some sample lies at or past its
 * lower end and some sample lies at or before its upper end. An open end excludes its own value.
 *
 * - lo < hi: met iff [min, max] and the interval have a value in common. So a constant cell meets
 *   every interval that holds its value.
 * - An isovalue is [v, v): met iff min < v && v <= max, the convention for a surface where the
 * value changes side. A constant cell has no surface, nor has a cell that touches v from above.
 * - [v, v] is the value itself, met iff min <= v && v <= max. A constant cell of v meets it.
 *
 * For samples, which are floats, two floats stand for an interval (value_limits.h). Ends may be
 * infinite. A cell with a NaN or infinite sample meets nothing. The empty range (inf, -inf) meets
 * nothing either.
 */
#ifndef STREAM_INTEREST_H
#define STREAM_INTEREST_H

#include <stdbool.h>

#include "formats/leaf/quantize.h"
#include "formats/leaf/value_limits.h"
#include "stream/homogeneous.h"

enum { INTEREST_MAX = 64 };

typedef struct interest_interval {
    double lo, hi; /* lo < hi; or equal, then lo is closed */
    bool lo_open, hi_open;
} interest_interval;

/* Normalised: sorted, and no interval implies, overlaps or touches another. An isovalue stays
 * beside an interval that does not imply it: 2 beside (2, 3]. Only the functions below make one. */
typedef struct interest {
    int count;
    interest_interval of[INTEREST_MAX];
    value_limits limits[INTEREST_MAX]; /* per interval */
    homogeneous whole;                 /* ranges taken whole; the caller sets it afterwards */
} interest;

/* interest_of_intervals() - make an interest of 0 to INTEREST_MAX intervals, in any order. */
interest interest_of_intervals(const interest_interval of[], int count);
interest interest_of_isovalues(const double isovalues[], int count);

/* interest_of_all() - returns the interest that every cell without NaN or inf meets. */
interest interest_of_all(void);

/* interest_same() - returns whether a and b have the same intervals and homogeneous ranges. */
bool interest_same(const interest *a, const interest *b);

/* interest_meets() - returns whether the range min .. max meets any of the intervals. */
bool interest_meets(const interest *in, float min, float max);

/* The part of an interest that a treelet's own range meets. The treelet's samples and its nodes'
 * codes are compared with these limits. */
typedef struct interest_part {
    int count;
    value_limits limits[INTEREST_MAX];
    quantized_limits codes[INTEREST_MAX];
} interest_part;

void interest_within(interest_part *part, const interest *in, const quantizer *q);

#endif
