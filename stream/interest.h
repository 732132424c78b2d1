/* interest.h - which values of a volume are asked for: a set of intervals. It decides which
 * treelets, nodes and cells are needed; nothing below the integrators knows isovalues.
 *
 * Cells and nodes are judged by the range [min, max] of their samples, which is the range of their
 * interpolant. One rule serves every interval: it is met iff some sample lies at or past its lower
 * end and some sample lies at or before its upper end, where an open end leaves its own value out.
 *
 * - lo < hi: met iff [min, max] and the interval have a value in common. So a constant cell meets
 *   every interval that holds its value.
 * - An isovalue is [v, v): met iff min < v && v <= max, the convention of a surface that changes
 *   side. A constant cell has none, nor has a cell that touches v from above.
 * - [v, v] is the value itself, met iff min <= v && v <= max, as where a constant cell counts.
 *
 * Ends may be infinite. Samples that are NaN or infinite have no range: a cell with one meets
 * nothing, and nothing meets the empty range (inf, -inf).
 */
#ifndef STREAM_INTEREST_H
#define STREAM_INTEREST_H

#include <stdbool.h>

#include "formats/leaf/quantize.h"
#include "stream/homogeneous.h"

enum { INTEREST_MAX = 64 };

typedef struct interest_interval {
    double lo, hi; /* lo < hi; or equal, then lo is closed */
    bool lo_open, hi_open;
} interest_interval;

/* The same test where all values are floats: met iff min < beyond && reach <= max. They are equal
 * for an isovalue. */
typedef struct interest_limits {
    float reach;  /* the least float that is at or past the lower end */
    float beyond; /* the least float past the upper end; inf: there is none */
} interest_limits;

/* Normalised: sorted, none implied by another, none that overlap or touch. An isovalue stays beside
 * an interval that does not imply it: 2 beside (2, 3]. Made by the functions below only. */
typedef struct interest {
    int count;
    interest_interval of[INTEREST_MAX];
    interest_limits limits[INTEREST_MAX]; /* of each */
    homogeneous whole; /* of what meets it, what is taken whole; set after it was made */
} interest;

/* interest_of_intervals() - 0 <= count <= INTEREST_MAX, in any order. */
interest interest_of_intervals(const interest_interval of[], int count);
interest interest_of_isovalues(const double isovalues[], int count);

/* interest_of_all() - every cell without NaN or inf. */
interest interest_of_all(void);

/* interest_same() - the same intervals: the same is met, and means the same. */
bool interest_same(const interest *a, const interest *b);

/* interest_meets() - whether the range min .. max meets any of the intervals. */
bool interest_meets(const interest *in, float min, float max);

/* What of an interest a treelet's own range meets: its samples and its nodes' codes are compared
 * with these. */
typedef struct interest_part {
    int count;
    interest_limits limits[INTEREST_MAX];
    quantized_limits codes[INTEREST_MAX];
} interest_part;

void interest_within(interest_part *part, const interest *in, const quantizer *q);

/* interest_threshold() - the least float (inf included) that reaches v: for every float f,
 * f >= interest_threshold(v) is (double)f >= v. */
float interest_threshold(double v);

#endif
