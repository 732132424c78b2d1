/* value_limits.h - an interval of values as two floats, with which ranges of samples are compared.
 *
 * A range [min, max] meets the interval iff some sample lies at or past its lower end and some
 * sample lies at or before its upper end: iff min < beyond && reach <= max. For an isovalue v both
 * are the least float that is at least v: min < v && v <= max, the convention for a surface where
 * the value changes side. The empty range (inf, -inf) meets nothing.
 */
#ifndef FORMATS_LEAF_VALUE_LIMITS_H
#define FORMATS_LEAF_VALUE_LIMITS_H

#include <stdbool.h>

typedef struct value_limits {
    float reach;  /* the least float that is at or past the lower end */
    float beyond; /* the least float past the upper end; inf: there is none */
} value_limits;

static inline bool value_limits_meet(const value_limits *at, float min, float max) {
    return min < at->beyond && at->reach <= max;
}

/* value_limits_threshold() - returns the least float (inf included) that is at least v. So for
 * every float f, f >= value_limits_threshold(v) iff (double)f >= v. */
float value_limits_threshold(double v);

/* value_limits_of_isovalue() - the limits of the isovalue v. */
static inline value_limits value_limits_of_isovalue(double v) {
    const float at = value_limits_threshold(v);
    return (value_limits){.reach = at, .beyond = at};
}

#endif
