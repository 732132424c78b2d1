/* packed_samples.h - samples as files of arrays keep them: packed, with holes, in 64 bits, several
 * a place; and the sample types that they become.
 *
 * value = stored * scale + offset, in double, rounded once. Stored numbers that equal a fill value,
 * or lie outside of the valid range, become NaN. What needs none of this stays as it is.
 */
#ifndef PREP_IMPORT_PACKED_SAMPLES_H
#define PREP_IMPORT_PACKED_SAMPLES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/sample.h"
#include "formats/base/status.h"

/* Integers of 64 bits have no sample_type: they are handed out as f64. */
typedef enum packed_wide { PACKED_NARROW, PACKED_I64, PACKED_U64 } packed_wide;

enum { PACKED_FILLS = 4, PACKED_COMPONENTS = 64 };

typedef struct packed_samples {
    sample_type type; /* of a stored number; with wide SAMPLE_F64 */
    packed_wide wide;
    sample_type out;      /* 0: what packed_type() says below; else that: it must hold all values */
    uint32_t components;  /* numbers a sample, side by side: 1 .. PACKED_COMPONENTS */
    uint32_t component;   /* which of them: 1, 2, ..; 0: of all */
    double scale, offset; /* see packed_init() */
    long double fill[PACKED_FILLS]; /* as stored: what a long double holds exactly */
    int fills;
    double least, most; /* the valid range; of values where valid_values, else of stored numbers */
    bool has_range, valid_values;
} packed_samples;

/* packed_init() - numbers of a type, one a sample, that are what they are. */
void packed_init(packed_samples *p, sample_type type, packed_wide wide);

/* packed_fill() - one more fill value; those beyond PACKED_FILLS and NaN change nothing. */
void packed_fill(packed_samples *p, long double value);

/* packed_type() - what samples become:
 *   as they are         integers of 8 to 32 bits, f32, f64
 *   f64                 integers of 64 bits
 *   sample_computed()   scaled; integers with fill values or a valid range; all of several
 *                       components: their magnitude, or of 3 and 4 of type u8 or u16 the luminance
 *                       (ITU-R BT.709 of the first three) */
sample_type packed_type(const packed_samples *p);

/* packed_is_colour() - of all components together: the luminance. */
bool packed_is_colour(const packed_samples *p);

/* packed_bytes() - of a stored sample, with all its components. */
size_t packed_bytes(const packed_samples *p);

/* packed_unpack() - count samples of packed_type(); out holds as many and is not `in`. Returns the
 * first sample with an integer that no double holds; count where there is none. */
size_t packed_unpack(const packed_samples *p, const void *in, void *out, size_t count);

/* packed_inexact() - ST_UNSUPPORTED for the sample that packed_unpack() returned: `index` among
 * those of slices from `first` on, which have so many samples. */
status packed_inexact(const char *file, const char *field, uint32_t first, uint64_t slice,
                      size_t index);

#endif
