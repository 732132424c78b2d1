/* packed_samples.h - decodes samples as array files store them: packed, with fill values, in 64
 * bits, several numbers per place. Tells the sample types that they become.
 *
 * value = stored * scale + offset, in double, rounded once. Stored numbers that equal a fill value,
 * or lie outside of the valid range, become NaN. Samples that need none of this stay unchanged.
 */
#ifndef PREP_IMPORT_PACKED_SAMPLES_H
#define PREP_IMPORT_PACKED_SAMPLES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/sample.h"
#include "formats/base/status.h"

/* 64-bit integers have no sample_type: they become f64. */
typedef enum packed_wide { PACKED_NARROW, PACKED_I64, PACKED_U64 } packed_wide;

enum { PACKED_FILLS = 16, PACKED_COMPONENTS = 64 };

typedef struct packed_samples {
    sample_type type; /* of a stored number; SAMPLE_F64 if wide */
    packed_wide wide;
    sample_type out;      /* 0: chosen by packed_type(); else this type, which must hold all
                             values */
    uint32_t components;  /* numbers per sample, side by side: 1 .. PACKED_COMPONENTS */
    uint32_t component;   /* the one to take: 1, 2, ..; 0: all */
    double scale, offset; /* see packed_init() */
    long double fill[PACKED_FILLS]; /* as stored, exact in a long double */
    int fills;
    double least, most; /* the valid range: of values if valid_values, else of stored numbers */
    bool has_range, valid_values;
} packed_samples;

/* packed_init() - set up plain numbers of a type: one per sample, no scaling. */
void packed_init(packed_samples *p, sample_type type, packed_wide wide);

/* packed_fill() - add a fill value. One that is there and NaN are ignored. false: these would be
 * more than PACKED_FILLS. */
bool packed_fill(packed_samples *p, long double value);

/* packed_type() - the type that samples become:
 *   as they are         integers of 8 to 32 bits, f32, f64
 *   f64                 integers of 64 bits
 *   sample_computed()   scaled; integers with fill values or a valid range; all of several
 *                       components: their magnitude, or of 3 and 4 of type u8 or u16 the luminance
 *                       (ITU-R BT.709 of the first three) */
sample_type packed_type(const packed_samples *p);

/* packed_is_colour() - returns whether the components are combined to a luminance. */
bool packed_is_colour(const packed_samples *p);

/* packed_bytes() - bytes of a stored sample, with all its components. */
size_t packed_bytes(const packed_samples *p);

/* packed_unpack() - unpack count samples to packed_type(); out has room for them and is not `in`.
 * Returns the first sample with an integer that no double holds; count: there is none. */
size_t packed_unpack(const packed_samples *p, const void *in, void *out, size_t count);

/* packed_inexact() - ST_UNSUPPORTED for the sample that packed_unpack() returned. `index` counts in
 * the slices from `first` on, of `slice` samples each. */
status packed_inexact(const char *file, const char *field, uint32_t first, uint64_t slice,
                      size_t index);

#endif
