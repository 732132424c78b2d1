/* sample.h - the types a scalar sample has, in inputs and in treelet files. */
#ifndef FORMATS_BASE_SAMPLE_H
#define FORMATS_BASE_SAMPLE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The values are written to files: never renumber. Treelet files hold only samples of the first
 * five types, grids of the first eight. Inputs may have any; see sample_widened(). */
typedef enum sample_type {
    SAMPLE_U8 = 1,
    SAMPLE_I8 = 2,
    SAMPLE_U16 = 3,
    SAMPLE_I16 = 4,
    SAMPLE_F32 = 5,
    SAMPLE_U32 = 6,
    SAMPLE_I32 = 7,
    SAMPLE_F64 = 8,
    SAMPLE_F16 = 9,
    SAMPLE_U64 = 10,
    SAMPLE_I64 = 11
} sample_type;

/* sample_size() - bytes of one sample; 0 for a value that is no type. */
size_t sample_size(sample_type type);

/* sample_name() - "u8", "i16", "f32" ...; "?" for a value that is no type. */
const char *sample_name(sample_type type);

/* sample_parse() - the type of a name as sample_name() gives it, or of the usual long names (uint8,
 * uchar, unsigned char, float32, double ...), in any case; false when unknown. */
bool sample_parse(const char *name, sample_type *out);

/* sample_widened() - the type that a grid uses for an input of this type: f32 for f16, f64 for u64
 * and i64, else the same. */
sample_type sample_widened(sample_type type);

/* sample_computed() - the type of values computed from samples of this type (scaled, or joined from
 * several numbers): f32 where a float holds all samples (8 and 16 bits, f32), else f64. */
sample_type sample_computed(sample_type type);

/* sample_stored() - the type in which a treelet file stores samples of this type: f32 for f16 and
 * for all above 16 bits, else the same. */
sample_type sample_stored(sample_type type);

/* sample_swap() - reverse the bytes of each of count samples. */
void sample_swap(sample_type type, void *samples, size_t count);

/* sample_to_stored() - convert count samples of a grid to sample_stored(type); in and out may be
 * the same buffer. Returns the largest absolute rounding error (0 for types stored as they are).
 * NaN and inf pass through and count as exact; a finite double beyond the range of float becomes
 * inf, and so does the error. */
double sample_to_stored(sample_type type, const void *in, void *out, size_t count);

/* sample_to_doubles() - convert count samples of any type, in native byte order, to doubles.
 * Returns the first sample that a double cannot hold exactly (u64, i64); count when there is
 * none. */
size_t sample_to_doubles(sample_type type, const void *in, double *out, size_t count);

/* sample_is_integer() - whether the type is one of u8 to i32, u64, i64. */
bool sample_is_integer(sample_type type);

/* sample_holds() - whether a sample of this type can have that value: an integer any whole value in
 * its range; a float any value in its range, and any that is not finite. */
bool sample_holds(sample_type type, double value);

/* sample_to_floats() - convert a grid's integers to floats, and those equal to `missing` to NaN. in
 * may lie at the end of out's buffer. Returns the first sample that a float cannot hold exactly;
 * count when there is none. */
size_t sample_to_floats(sample_type type, const void *in, float *out, size_t count, double missing);

/* sample_mark_missing() - turn samples equal to `missing`, in the samples' own precision, into NaN:
 * of floats and doubles in place; integers become floats, and may lie at the end of `samples`.
 * Returns as sample_to_floats(). */
size_t sample_mark_missing(sample_type type, const void *at, void *samples, size_t count,
                           double missing);

/* sample_get() - one sample of a stored type as a float; exact. */
static inline float sample_get(sample_type type, const void *samples, size_t index) {
    switch (type) {
    case SAMPLE_U8: return ((const uint8_t *)samples)[index];
    case SAMPLE_I8: return ((const int8_t *)samples)[index];
    case SAMPLE_U16: return ((const uint16_t *)samples)[index];
    case SAMPLE_I16: return ((const int16_t *)samples)[index];
    case SAMPLE_F32: return ((const float *)samples)[index];
    default: return 0;
    }
}

#endif
