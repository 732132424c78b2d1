#include "prep/import/packed_samples.h"

#include <math.h>
#include <string.h>

/* Numbers are processed as blocks of doubles, so that each loop handles one type. */
enum { BLOCK = 2048 };

void packed_init(packed_samples *p, sample_type type, packed_wide wide) {
    *p = (packed_samples){.type = type, .wide = wide, .components = 1, .scale = 1};
}

/* Round a value to the stored type: fill values may be written in another type. */
static long double as_stored(const packed_samples *p, long double value) {
    return p->type == SAMPLE_F32 ? (long double)(float)value : value;
}

static bool is_fill(const packed_samples *p, long double value) {
    for (int i = 0; i < p->fills; i++)
        if (value == p->fill[i])
            return true;
    return false;
}

bool packed_fill(packed_samples *p, long double value) {
    const long double fill = as_stored(p, value);
    if (fill != fill || is_fill(p, fill))
        return true;
    if (p->fills == PACKED_FILLS)
        return false;
    p->fill[p->fills++] = fill;
    return true;
}

/* Numbers that are combined to a sample's value. */
static uint32_t components(const packed_samples *p) {
    return p->component ? 1 : p->components;
}

static bool is_scaled(const packed_samples *p) {
    return p->scale != 1 || p->offset != 0;
}

static bool has_holes(const packed_samples *p) {
    return p->fills > 0 || p->has_range;
}

bool packed_is_colour(const packed_samples *p) {
    return (p->type == SAMPLE_U8 || p->type == SAMPLE_U16) &&
           (components(p) == 3 || components(p) == 4);
}

sample_type packed_type(const packed_samples *p) {
    const bool whole = sample_is_integer(p->type);
    if (p->out)
        return p->out;
    if (p->wide)
        return SAMPLE_F64;
    if (components(p) == 1 && !is_scaled(p) && !(has_holes(p) && whole))
        return p->type;
    return sample_computed(p->type);
}

static bool is_plain(const packed_samples *p) {
    return !p->wide && p->components == 1 && !is_scaled(p) && !has_holes(p) &&
           packed_type(p) == p->type;
}

size_t packed_bytes(const packed_samples *p) {
    return p->components * sample_size(p->type);
}

/* ---- a block ---- */

/* Load every stride-th number. */
#define LOAD_ALL(stored)                                                \
    for (size_t i = 0; i < count; i++) {                                \
        stored v;                                                       \
        memcpy(&v, (const char *)in + i * stride * sizeof v, sizeof v); \
        out[i] = (double)v;                                             \
    }

static void load(sample_type type, const void *in, size_t stride, double *out, size_t count) {
    switch (type) {
    case SAMPLE_U8: LOAD_ALL(uint8_t) break;
    case SAMPLE_I8: LOAD_ALL(int8_t) break;
    case SAMPLE_U16: LOAD_ALL(uint16_t) break;
    case SAMPLE_I16: LOAD_ALL(int16_t) break;
    case SAMPLE_U32: LOAD_ALL(uint32_t) break;
    case SAMPLE_I32: LOAD_ALL(int32_t) break;
    case SAMPLE_F32: LOAD_ALL(float) break;
    case SAMPLE_F64: LOAD_ALL(double) break;
    default: break; /* importers have no other types */
    }
}

/* Find fill values before conversion: they are often the largest integers, which no double
 * holds. */
static size_t load_wide(const packed_samples *p, const void *in, size_t stride, double *out,
                        size_t count) {
    size_t first = count;
    for (size_t i = 0; i < count; i++) {
        uint64_t bits;
        memcpy(&bits, (const char *)in + i * stride * sizeof bits, sizeof bits);
        const long double v =
            p->wide == PACKED_I64 ? (long double)(int64_t)bits : (long double)bits;
        out[i] = is_fill(p, v) ? NAN : (double)v;
        if (first == count && out[i] == out[i] && (long double)out[i] != v)
            first = i;
    }
    return first;
}

static void mark_fills(const packed_samples *p, double *v, size_t count) {
    for (int k = 0; k < p->fills; k++) {
        const double fill = (double)p->fill[k];
        for (size_t i = 0; i < count; i++)
            v[i] = v[i] == fill ? (double)NAN : v[i];
    }
}

static void mark_range(const packed_samples *p, double *v, size_t count) {
    for (size_t i = 0; i < count; i++)
        v[i] = v[i] >= p->least && v[i] <= p->most ? v[i] : (double)NAN;
}

static void scale(const packed_samples *p, double *v, size_t count) {
    for (size_t i = 0; i < count; i++)
        v[i] = v[i] * p->scale + p->offset;
}

static double luminance(const double *v) {
    return 0.2126 * v[0] + 0.7152 * v[1] + 0.0722 * v[2];
}

static double magnitude(const double *v, uint32_t n) {
    double sum = 0;
    for (uint32_t i = 0; i < n; i++)
        sum += v[i] * v[i];
    return sqrt(sum);
}

static void reduce(const packed_samples *p, double *v, size_t samples) {
    const uint32_t n = components(p);
    for (size_t i = 0; i < samples && n > 1; i++)
        v[i] = packed_is_colour(p) ? luminance(v + i * n) : magnitude(v + i * n, n);
}

#define PUT_ALL(sample)                                   \
    for (size_t i = 0; i < count; i++) {                  \
        const sample s = (sample)v[i];                    \
        memcpy((char *)out + i * sizeof s, &s, sizeof s); \
    }

/* Store values. Integer types only occur if all values are whole and fit. */
static void put(sample_type type, const double *v, void *out, size_t count) {
    switch (type) {
    case SAMPLE_U8: PUT_ALL(uint8_t) break;
    case SAMPLE_I8: PUT_ALL(int8_t) break;
    case SAMPLE_U16: PUT_ALL(uint16_t) break;
    case SAMPLE_I16: PUT_ALL(int16_t) break;
    case SAMPLE_U32: PUT_ALL(uint32_t) break;
    case SAMPLE_I32: PUT_ALL(int32_t) break;
    case SAMPLE_F32: PUT_ALL(float) break;
    case SAMPLE_F64: memcpy(out, v, count * sizeof *v); break;
    default: break; /* importers have no other types */
    }
}

/* Load and mark values. numbers: samples, times components if all are used. Returns as
 * packed_unpack() does, in numbers. */
static size_t load_values(const packed_samples *p, const char *in, double *v, size_t numbers) {
    const size_t stride = p->component ? p->components : 1;
    size_t bad = numbers;
    if (p->component)
        in += (p->component - 1) * sample_size(p->type);
    if (p->wide)
        bad = load_wide(p, in, stride, v, numbers);
    else
        load(p->type, in, stride, v, numbers);
    if (!p->wide)
        mark_fills(p, v, numbers);
    if (p->has_range && !p->valid_values)
        mark_range(p, v, numbers);
    if (is_scaled(p))
        scale(p, v, numbers);
    if (p->has_range && p->valid_values)
        mark_range(p, v, numbers);
    return bad;
}

size_t packed_unpack(const packed_samples *p, const void *in, void *out, size_t count) {
    const uint32_t n = components(p);
    const size_t most = BLOCK / n, width = sample_size(packed_type(p));
    double v[BLOCK];
    if (is_plain(p)) {
        memcpy(out, in, count * width);
        return count;
    }
    for (size_t done = 0, part; done < count; done += part) {
        part = count - done < most ? count - done : most;
        const size_t numbers = part * n;
        const size_t bad = load_values(p, (const char *)in + done * packed_bytes(p), v, numbers);
        if (bad < numbers)
            return done + bad / n;
        reduce(p, v, part);
        put(packed_type(p), v, (char *)out + done * width, part);
    }
    return count;
}

status packed_inexact(const char *file, const char *field, uint32_t first, uint64_t slice,
                      size_t index) {
    return status_describe(ST_UNSUPPORTED,
                           "%s: %s: sample %llu of slice %llu (both counted from 0) is an integer "
                           "that no double holds: 64-bit integers are read as f64, exactly or not "
                           "at all",
                           file, field, (unsigned long long)(index % slice),
                           (unsigned long long)(first + index / slice));
}
