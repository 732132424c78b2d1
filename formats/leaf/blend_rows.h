/* blend_rows.h - samples between those of two time steps, linear in time. By type and for each ISA;
 * all give the same.
 */
#ifndef FORMATS_LEAF_BLEND_ROWS_H
#define FORMATS_LEAF_BLEND_ROWS_H

#include <math.h>
#include <stddef.h>

#include "formats/base/cpu.h"
#include "formats/base/sample.h"

/* blend_sample() - the sample at `share`, above 0 and below 1, of the way from a to b: in doubles
 * (1 - share) a + share b, each operation rounded, then rounded to a float. NaN is always the same
 * one.
 *
 * No operation can turn the order of two samples round. So with a <= c and b <= d, that of a and b
 * is not above that of c and d. It is never beyond the greater magnitude of a and b: finite samples
 * give a finite one. With a == b it is a: the sum is within 2^-51 of it, relative, and the floats
 * beside a are 2^-25 away or more. */
static inline float blend_sample(float a, float b, double share) {
    const float mixed = (float)((1.0 - share) * (double)a + share * (double)b);
    return isnan(mixed) ? NAN : mixed;
}

/* Blends `count` samples of one type. share 0: those of a as floats; b is not looked at. */
typedef void blend_fn(const void *a, const void *b, double share, float *to, size_t count);

/* blend_rows_for() - the function of an ISA for samples of sample_stored() types. */
blend_fn *blend_rows_for(cpu_isa isa, sample_type type);

#endif
