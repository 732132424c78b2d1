#include "formats/grid/zarr_filter.h"

#include <endian.h>
#include <math.h>
#include <string.h>

#include "formats/grid/npy.h"
#include "formats/grid/stored_samples.h"

enum { BLOCK = 512, ELEMENT_MAX = 256 };

typedef enum filter_kind { SHUFFLE, DELTA, SCALE, CONVERT, ROWS } filter_kind;

/* The filters, with the keys of the types before and after; NULL: no such key. The order is that of
 * OUTSIDE.md. Those of Zarr come first. */
static const struct {
    const char *id, *plain, *coded;
    filter_kind kind;
} filters[] = {{"shuffle", NULL, NULL, SHUFFLE},
               {"delta", "dtype", "astype", DELTA},
               {"fixedscaleoffset", "dtype", "astype", SCALE},
               {"quantize", "dtype", "astype", CONVERT},
               {"astype", "decode_dtype", "encode_dtype", CONVERT},
               [ZARR_FILTER_ROWS] = {"rows", NULL, NULL, ROWS}};
_Static_assert(sizeof filters / sizeof *filters == ZARR_FILTER_KINDS, "sections store them");
static const char known[] = "shuffle, delta, fixedscaleoffset, quantize and astype";

/* ---- what the JSON says ---- */

static bool read_number(const json_t *filter, const char *key, zarr_number otherwise,
                        zarr_number *out) {
    const json_t *value = json_object_get(filter, key);
    const char *word = json_string_value(value);
    stored_samples s = {.components = 1};
    *out = otherwise;
    if (!value || json_is_null(value))
        return true;
    if (!word || strstr(word, "b1") || !npy_type(word, &s, &out->big_endian) || s.components > 1)
        return false;
    out->type = s.type;
    return true;
}

static bool same_number(zarr_number a, zarr_number b) {
    return a.type == b.type && (a.big_endian == b.big_endian || sample_size(a.type) == 1);
}

/* Returns whether a double holds numbers of the type, so that they can be computed with. */
static bool is_plain(sample_type t) {
    return t != SAMPLE_U64 && t != SAMPLE_I64 && t != SAMPLE_F16;
}

static bool types_suit(const zarr_filter *f) {
    const sample_type a = f->plain.type, b = f->coded.type;
    switch (filters[f->kind].kind) {
    case SHUFFLE:
    case ROWS: return true;
    case DELTA: return sample_is_integer(a) ? sample_is_integer(b) : a == b && is_plain(a);
    default: return is_plain(a) && is_plain(b);
    }
}

static bool scale_suits(const zarr_filter *f) {
    return filters[f->kind].kind != SCALE ||
           (f->scale != 0 && isfinite(f->scale) && isfinite(f->offset));
}

static bool row_suits(const zarr_filter *f) {
    if (filters[f->kind].kind != ROWS)
        return f->row == 0;
    return f->element > 0 && f->row > 0 && f->row % f->element == 0;
}

static status read_filter(const json_t *filter, zarr_number at, const char *json, zarr_filter *f) {
    const char *id = json_string_value(json_object_get(filter, "id"));
    const int rows = ZARR_FILTER_ROWS;
    *f = (zarr_filter){.plain = at, .coded = at};
    while (f->kind < rows && (!id || strcmp(filters[f->kind].id, id) != 0))
        f->kind++;
    if (f->kind == rows)
        return status_describe(ST_UNSUPPORTED, "%s: \"filters\": \"%s\"; supported are %s", json,
                               id ? id : "", known);
    f->scale = json_number_value(json_object_get(filter, "scale"));
    f->offset = json_number_value(json_object_get(filter, "offset"));
    const json_t *size = json_object_get(filter, "elementsize");
    const json_int_t element = size ? json_integer_value(size) : 4;
    f->element = element >= 0 && element <= ELEMENT_MAX ? (uint32_t)element : ELEMENT_MAX + 1;
    const bool typed = filters[f->kind].plain != NULL;
    const bool read = !typed || (read_number(filter, filters[f->kind].plain, at, &f->plain) &&
                                 read_number(filter, filters[f->kind].coded, f->plain, &f->coded));
    if (!read || !types_suit(f) || f->element > ELEMENT_MAX)
        return status_describe(ST_UNSUPPORTED, "%s: \"filters\": %s of such types is not undone",
                               json, id);
    if (!same_number(f->plain, at))
        return status_describe(ST_CORRUPT,
                               "%s: \"filters\": \"%s\": expected numbers of the type that the "
                               "array has there",
                               json, id);
    if (!scale_suits(f))
        return status_describe(ST_CORRUPT, "%s: \"filters\": \"%s\": expected a scale, not 0", json,
                               id);
    return ST_OK;
}

status zarr_filters_read(const json_t *list, zarr_number array, const char *json,
                         zarr_filters *out) {
    status st = ST_OK;
    *out = (zarr_filters){0};
    if (json_array_size(list) > ZARR_FILTERS)
        return status_describe(ST_UNSUPPORTED, "%s: \"filters\": more than %d", json, ZARR_FILTERS);
    for (size_t i = 0; i < json_array_size(list) && st == ST_OK; i++) {
        st = read_filter(json_array_get(list, i), array, json, &out->of[i]);
        array = out->of[i].coded;
        out->count++;
    }
    return st;
}

bool zarr_filters_sound(const zarr_filters *f, zarr_number array) {
    for (int i = 0; i < f->count; array = f->of[i++].coded) {
        const zarr_filter *at = &f->of[i];
        if (at->kind < 0 || at->kind >= ZARR_FILTER_KINDS || at->element > ELEMENT_MAX ||
            !types_suit(at) || !same_number(at->plain, array) || !scale_suits(at) || !row_suits(at))
            return false;
        if (!filters[at->kind].plain && !same_number(at->coded, at->plain))
            return false;
    }
    return true;
}

size_t zarr_filters_width(const zarr_filters *f, zarr_number array, size_t *most) {
    size_t width = sample_size(array.type);
    *most = width;
    for (int i = 0; i < f->count; i++) {
        width = sample_size(f->of[i].coded.type);
        *most = width > *most ? width : *most;
    }
    return width;
}

/* ---- bytes ---- */

static void turn(zarr_number n, void *numbers, size_t count) {
    if (n.big_endian != (__BYTE_ORDER == __BIG_ENDIAN))
        sample_swap(n.type, numbers, count);
}

static bool unshuffle(const zarr_filter *f, size_t bytes, const uint8_t *in, uint8_t *out) {
    const size_t size = f->element > 1 ? f->element : 1, count = bytes / size;
    for (size_t j = 0; j < size; j++)
        for (size_t i = 0; i < count; i++)
            out[i * size + j] = in[j * count + i];
    return count * size == bytes;
}

/* ---- numbers ---- */

/* Returns the bits of a whole number of any width, sign-extended. */
static uint64_t bits_at(sample_type type, const void *numbers, size_t i) {
    switch (type) {
    case SAMPLE_U8: return ((const uint8_t *)numbers)[i];
    case SAMPLE_I8: return (uint64_t)((const int8_t *)numbers)[i];
    case SAMPLE_U16: return ((const uint16_t *)numbers)[i];
    case SAMPLE_I16: return (uint64_t)((const int16_t *)numbers)[i];
    case SAMPLE_U32: return ((const uint32_t *)numbers)[i];
    case SAMPLE_I32: return (uint64_t)((const int32_t *)numbers)[i];
    default: return ((const uint64_t *)numbers)[i];
    }
}

static void put_bits(sample_type type, void *numbers, size_t i, uint64_t bits) {
    switch (sample_size(type)) {
    case 1: ((uint8_t *)numbers)[i] = (uint8_t)bits; break;
    case 2: ((uint16_t *)numbers)[i] = (uint16_t)bits; break;
    case 4: ((uint32_t *)numbers)[i] = (uint32_t)bits; break;
    default: ((uint64_t *)numbers)[i] = bits; break;
    }
}

static void sum_up(const zarr_filter *f, size_t count, const void *in, void *out) {
    const sample_type from = f->coded.type, to = f->plain.type;
    uint64_t whole = 0;
    float single = 0;
    double real = 0;
    for (size_t i = 0; i < count; i++) {
        if (from == SAMPLE_F32)
            ((float *)out)[i] = single = i ? single + ((const float *)in)[i] : *(const float *)in;
        else if (from == SAMPLE_F64)
            ((double *)out)[i] = real = i ? real + ((const double *)in)[i] : *(const double *)in;
        else
            put_bits(to, out, i, whole += bits_at(from, in, i));
    }
}

/* Add the element before to each of a row, whatever its bits mean. */
#define SUM_ROWS(whole)                                        \
    for (size_t at = 0; at < count; at += f->row)              \
        for (size_t i = at + f->element; i < at + f->row; i++) \
            ((whole *)out)[i] = (whole)(((const whole *)out)[i - f->element] + ((whole *)out)[i]);

static bool sum_rows(const zarr_filter *f, size_t count, const void *in, void *out) {
    const size_t width = sample_size(f->plain.type);
    memcpy(out, in, count * width);
    if (count % f->row)
        return false;
    switch (width) {
    case 1: SUM_ROWS(uint8_t) break;
    case 2: SUM_ROWS(uint16_t) break;
    case 4: SUM_ROWS(uint32_t) break;
    default: SUM_ROWS(uint64_t) break;
    }
    return true;
}

/* Store a number as NumPy casts it. Whole numbers are rounded towards 0, must fit 64 bits, and
 * wrap. */
static bool store(sample_type type, double v, void *numbers, size_t i) {
    if (type == SAMPLE_F64)
        ((double *)numbers)[i] = v;
    else if (type == SAMPLE_F32)
        ((float *)numbers)[i] = (float)v;
    else if (fabs(v) < 0x1p63)
        put_bits(type, numbers, i, (uint64_t)(int64_t)v);
    else
        return false;
    return true;
}

/* Returns enc / scale + offset, computed in floats where enc is a float. */
static double unscale(const zarr_filter *f, double v) {
    if (f->coded.type != SAMPLE_F32)
        return v / f->scale + f->offset;
    const float quotient = (float)v / (float)f->scale;
    return (double)(quotient + (float)f->offset);
}

static bool convert(const zarr_filter *f, size_t count, const char *in, void *out) {
    const bool scaled = filters[f->kind].kind == SCALE;
    const size_t width = sample_size(f->coded.type);
    double values[BLOCK];
    bool fits = true;
    for (size_t done = 0, part; done < count; done += part) {
        part = count - done < BLOCK ? count - done : BLOCK;
        sample_to_doubles(f->coded.type, in + done * width, values, part);
        for (size_t i = 0; i < part; i++)
            fits &= store(f->plain.type, scaled ? unscale(f, values[i]) : values[i], out, done + i);
    }
    return fits;
}

/* ---- all of them ---- */

static bool undo(const zarr_filter *f, size_t count, void *in, void *out) {
    bool done = true;
    if (filters[f->kind].kind == SHUFFLE)
        return unshuffle(f, count * sample_size(f->coded.type), in, out);
    turn(f->coded, in, count);
    switch (filters[f->kind].kind) {
    case DELTA: sum_up(f, count, in, out); break;
    case ROWS: done = sum_rows(f, count, in, out); break;
    default: done = convert(f, count, in, out); break;
    }
    turn(f->plain, out, count);
    return done;
}

status zarr_filters_undo(const zarr_filters *f, const char *path, size_t numbers, void *coded,
                         void *plain) {
    void *in = coded, *out = plain;
    for (int i = f->count - 1; i >= 0; i--) {
        if (!undo(&f->of[i], numbers, in, out))
            return status_describe(ST_CORRUPT, "%s: what its filter \"%s\" made does not fit", path,
                                   filters[f->of[i].kind].id);
        void *next = in;
        in = out;
        out = next;
    }
    if (in == coded)
        memcpy(plain, coded, f->count ? numbers * sample_size(f->of[0].plain.type) : 0);
    return ST_OK;
}
