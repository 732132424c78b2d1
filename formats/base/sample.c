#include "formats/base/sample.h"

#include <byteswap.h>
#include <float.h>
#include <math.h>
#include <string.h>
#include <strings.h>

static const struct {
    const char *name;
    size_t size;
    sample_type stored, widened;
} types[] = {
    [SAMPLE_U8] = {"u8", 1, SAMPLE_U8, SAMPLE_U8},
    [SAMPLE_I8] = {"i8", 1, SAMPLE_I8, SAMPLE_I8},
    [SAMPLE_U16] = {"u16", 2, SAMPLE_U16, SAMPLE_U16},
    [SAMPLE_I16] = {"i16", 2, SAMPLE_I16, SAMPLE_I16},
    [SAMPLE_F32] = {"f32", 4, SAMPLE_F32, SAMPLE_F32},
    [SAMPLE_U32] = {"u32", 4, SAMPLE_F32, SAMPLE_U32},
    [SAMPLE_I32] = {"i32", 4, SAMPLE_F32, SAMPLE_I32},
    [SAMPLE_F64] = {"f64", 8, SAMPLE_F32, SAMPLE_F64},
    [SAMPLE_F16] = {"f16", 2, SAMPLE_F32, SAMPLE_F32},
    [SAMPLE_U64] = {"u64", 8, SAMPLE_F32, SAMPLE_F64},
    [SAMPLE_I64] = {"i64", 8, SAMPLE_F32, SAMPLE_F64},
};
enum { TYPES = sizeof types / sizeof types[0] };

static const struct {
    const char *name;
    sample_type type;
} synonyms[] = {
    {"uint8", SAMPLE_U8},
    {"uint8_t", SAMPLE_U8},
    {"uchar", SAMPLE_U8},
    {"unsigned char", SAMPLE_U8},
    {"byte", SAMPLE_U8},
    {"int8", SAMPLE_I8},
    {"int8_t", SAMPLE_I8},
    {"char", SAMPLE_I8},
    {"signed char", SAMPLE_I8},
    {"uint16", SAMPLE_U16},
    {"uint16_t", SAMPLE_U16},
    {"ushort", SAMPLE_U16},
    {"unsigned short", SAMPLE_U16},
    {"unsigned short int", SAMPLE_U16},
    {"int16", SAMPLE_I16},
    {"int16_t", SAMPLE_I16},
    {"short", SAMPLE_I16},
    {"short int", SAMPLE_I16},
    {"signed short", SAMPLE_I16},
    {"signed short int", SAMPLE_I16},
    {"uint32", SAMPLE_U32},
    {"uint32_t", SAMPLE_U32},
    {"uint", SAMPLE_U32},
    {"unsigned int", SAMPLE_U32},
    {"int32", SAMPLE_I32},
    {"int32_t", SAMPLE_I32},
    {"int", SAMPLE_I32},
    {"signed int", SAMPLE_I32},
    {"float", SAMPLE_F32},
    {"float32", SAMPLE_F32},
    {"double", SAMPLE_F64},
    {"float64", SAMPLE_F64},
    {"half", SAMPLE_F16},
    {"float16", SAMPLE_F16},
    {"uint64", SAMPLE_U64},
    {"uint64_t", SAMPLE_U64},
    {"ulonglong", SAMPLE_U64},
    {"unsigned long long", SAMPLE_U64},
    {"unsigned long long int", SAMPLE_U64},
    {"int64", SAMPLE_I64},
    {"int64_t", SAMPLE_I64},
    {"longlong", SAMPLE_I64},
    {"long long", SAMPLE_I64},
    {"long long int", SAMPLE_I64},
    {"signed long long", SAMPLE_I64},
    {"signed long long int", SAMPLE_I64},
};

static bool is_type(sample_type type) {
    return (int)type > 0 && (int)type < TYPES;
}

size_t sample_size(sample_type type) {
    return is_type(type) ? types[type].size : 0;
}

const char *sample_name(sample_type type) {
    return is_type(type) ? types[type].name : "?";
}

bool sample_parse(const char *name, sample_type *out) {
    for (int t = 1; t < TYPES; t++)
        if (strcasecmp(name, types[t].name) == 0) {
            *out = (sample_type)t;
            return true;
        }
    for (size_t i = 0; i < sizeof synonyms / sizeof synonyms[0]; i++)
        if (strcasecmp(name, synonyms[i].name) == 0) {
            *out = synonyms[i].type;
            return true;
        }
    return false;
}

sample_type sample_widened(sample_type type) {
    return is_type(type) ? types[type].widened : type;
}

sample_type sample_computed(sample_type type) {
    return sample_size(type) <= 2 || type == SAMPLE_F32 ? SAMPLE_F32 : SAMPLE_F64;
}

sample_type sample_stored(sample_type type) {
    return is_type(type) ? types[type].stored : type;
}

/* The buffers have no type of their own. So each access goes through memcpy, which compiles to
 * plain moves. */
#define SWAP_ALL(type, swap)                                  \
    for (size_t i = 0; i < count; i++) {                      \
        type v;                                               \
        memcpy(&v, (char *)samples + i * sizeof v, sizeof v); \
        v = swap(v);                                          \
        memcpy((char *)samples + i * sizeof v, &v, sizeof v); \
    }

void sample_swap(sample_type type, void *samples, size_t count) {
    switch (sample_size(type)) {
    case 2: SWAP_ALL(uint16_t, bswap_16) break;
    case 4: SWAP_ALL(uint32_t, bswap_32) break;
    case 8: SWAP_ALL(uint64_t, bswap_64) break;
    default: break;
    }
}

/* A double holds any u32, i32 and float exactly, so this difference is the rounding error itself.
 * NaN compares false and is skipped. So is an input inf: its difference is NaN. */
#define ROUND_ALL(type)                                        \
    for (size_t i = 0; i < count; i++) {                       \
        type v;                                                \
        memcpy(&v, (const char *)in + i * sizeof v, sizeof v); \
        float f = (float)v;                                    \
        double error = fabs((double)f - (double)v);            \
        if (error > worst)                                     \
            worst = error;                                     \
        memcpy((char *)out + i * sizeof f, &f, sizeof f);      \
    }

double sample_to_stored(sample_type type, const void *in, void *out, size_t count) {
    double worst = 0;
    switch (type) {
    case SAMPLE_U32: ROUND_ALL(uint32_t) break;
    case SAMPLE_I32: ROUND_ALL(int32_t) break;
    case SAMPLE_F64: ROUND_ALL(double) break;
    default:
        if (in != out)
            memcpy(out, in, count * sample_size(type));
        break;
    }
    return worst;
}

#define DOUBLE_ALL(type, as_double)                            \
    for (size_t i = 0; i < count; i++) {                       \
        type v;                                                \
        memcpy(&v, (const char *)in + i * sizeof v, sizeof v); \
        out[i] = as_double(v);                                 \
    }

/* Convert an IEEE 754 binary16: 1 bit of sign, 5 of exponent, 10 of mantissa. */
static double of_half(uint16_t h) {
    const uint32_t sign = (uint32_t)(h & 0x8000) << 16, exponent = h >> 10 & 31, bits = h & 0x3ff;
    if (exponent == 0)
        return (sign ? -0x1p-24 : 0x1p-24) * bits;
    const uint32_t single = sign | (exponent == 31 ? 255 : exponent + 112) << 23 | bits << 13;
    float f;
    memcpy(&f, &single, sizeof f);
    return (double)f;
}

/* The first integer that a double cannot hold: more than 53 bits from its first set bit to its
 * last. */
static size_t first_inexact(sample_type type, const void *in, size_t count) {
    for (size_t i = 0; i < count; i++) {
        uint64_t v;
        memcpy(&v, (const char *)in + i * sizeof v, sizeof v);
        if (type == SAMPLE_I64 && v >> 63)
            v = -v;
        if (v >> 53 && __builtin_clzll(v) + __builtin_ctzll(v) < 11)
            return i;
    }
    return count;
}

size_t sample_to_doubles(sample_type type, const void *in, double *out, size_t count) {
    switch (type) {
    case SAMPLE_U8: DOUBLE_ALL(uint8_t, ) break;
    case SAMPLE_I8: DOUBLE_ALL(int8_t, ) break;
    case SAMPLE_U16: DOUBLE_ALL(uint16_t, ) break;
    case SAMPLE_I16: DOUBLE_ALL(int16_t, ) break;
    case SAMPLE_F32: DOUBLE_ALL(float, (double)) break;
    case SAMPLE_U32: DOUBLE_ALL(uint32_t, ) break;
    case SAMPLE_I32: DOUBLE_ALL(int32_t, ) break;
    case SAMPLE_F64: DOUBLE_ALL(double, ) break;
    case SAMPLE_F16: DOUBLE_ALL(uint16_t, of_half) break;
    case SAMPLE_U64: DOUBLE_ALL(uint64_t, (double)) return first_inexact(type, in, count);
    case SAMPLE_I64: DOUBLE_ALL(int64_t, (double)) return first_inexact(type, in, count);
    }
    return count;
}

bool sample_is_integer(sample_type type) {
    return is_type(type) && type != SAMPLE_F16 && type != SAMPLE_F32 && type != SAMPLE_F64;
}

bool sample_holds(sample_type type, double value) {
    static const double range[TYPES][2] = {
        [SAMPLE_U8] = {0, UINT8_MAX},
        [SAMPLE_I8] = {INT8_MIN, INT8_MAX},
        [SAMPLE_U16] = {0, UINT16_MAX},
        [SAMPLE_I16] = {INT16_MIN, INT16_MAX},
        [SAMPLE_U32] = {0, UINT32_MAX},
        [SAMPLE_I32] = {INT32_MIN, INT32_MAX},
        [SAMPLE_F32] = {-FLT_MAX, FLT_MAX},
        [SAMPLE_F64] = {-DBL_MAX, DBL_MAX},
        [SAMPLE_F16] = {-65504, 65504},
        [SAMPLE_U64] = {0, 0x1p64 - 2048},
        [SAMPLE_I64] = {-0x1p63, 0x1p63 - 1024},
    };
    const bool whole = sample_is_integer(type);
    if (!isfinite(value))
        return !whole;
    return value >= range[type][0] && value <= range[type][1] && (!whole || value == rint(value));
}

#define FLOAT_ALL(type)                                        \
    for (size_t i = 0; i < count; i++) {                       \
        type v;                                                \
        memcpy(&v, (const char *)in + i * sizeof v, sizeof v); \
        const bool no_data = (double)v == missing;             \
        const float f = no_data ? NAN : (float)v;              \
        if (!no_data && (double)f != (double)v && i < first)   \
            first = i;                                         \
        memcpy((char *)out + i * sizeof f, &f, sizeof f);      \
    }

size_t sample_to_floats(sample_type type, const void *in, float *out, size_t count,
                        double missing) {
    size_t first = count;
    switch (type) {
    case SAMPLE_U8: FLOAT_ALL(uint8_t) break;
    case SAMPLE_I8: FLOAT_ALL(int8_t) break;
    case SAMPLE_U16: FLOAT_ALL(uint16_t) break;
    case SAMPLE_I16: FLOAT_ALL(int16_t) break;
    case SAMPLE_U32: FLOAT_ALL(uint32_t) break;
    case SAMPLE_I32: FLOAT_ALL(int32_t) break;
    default: break;
    }
    return first;
}

size_t sample_mark_missing(sample_type type, const void *at, void *samples, size_t count,
                           double missing) {
    float *f = samples;
    double *d = samples;
    if (type != SAMPLE_F32 && type != SAMPLE_F64)
        return sample_to_floats(type, at, f, count, missing);
    for (size_t i = 0; type == SAMPLE_F32 && i < count; i++)
        f[i] = f[i] == (float)missing ? NAN : f[i];
    for (size_t i = 0; type == SAMPLE_F64 && i < count; i++)
        d[i] = d[i] == missing ? (double)NAN : d[i];
    return count;
}
