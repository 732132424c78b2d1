#include "formats/base/cli_value.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/num.h"

status cli_int(const char *text, const char *what, int lo, int hi, int *out) {
    int64_t value = 0;
    status st = num_int(text, what, lo, hi, &value);
    if (st == ST_OK)
        *out = (int)value;
    return st;
}

status cli_uint(const char *text, const char *what, uint32_t lo, uint32_t hi, uint32_t *out) {
    int64_t value = 0;
    status st = num_int(text, what, lo, hi, &value);
    if (st == ST_OK)
        *out = (uint32_t)value;
    return st;
}

status cli_finite(const char *text, const char *what, double lo, double hi, double *out) {
    double value = 0.0;
    status st = num_double(text, what, &value);
    if (st != ST_OK)
        return st;
    if (!isfinite(value))
        return status_describe(ST_USAGE, "%s: %s is not a finite number", what, text);
    if (value < lo || value > hi)
        return status_describe(ST_USAGE, "%s: %s is not in %g .. %g", what, text, lo, hi);
    *out = value;
    return ST_OK;
}

status cli_positive(const char *text, const char *what, double *out) {
    double value;
    const status st = num_double(text, what, &value);
    if (st == ST_OK && !(value > 0 && isfinite(value)))
        return status_describe(ST_USAGE, "%s: \"%s\": expected a number above 0", what, text);
    if (st == ST_OK)
        *out = value;
    return st;
}

status cli_vector(const char *text, const char *what, int count, double *out) {
    status st = num_doubles(text, what, ",", count, out);
    for (int i = 0; i < count && st == ST_OK; i++)
        if (!isfinite(out[i]))
            st =
                status_describe(ST_USAGE, "%s: \"%s\" has a number that is not finite", what, text);
    return st;
}

static status parse_dims(const char *text, const char *what, uint32_t lo, uint32_t hi, int count,
                         uint32_t out[3]) {
    double sizes[3];
    status st = num_doubles(text, what, ", x", count, sizes);
    for (int a = 0; a < count && st == ST_OK; a++) {
        if (!(sizes[a] >= lo && sizes[a] <= hi && sizes[a] == floor(sizes[a])))
            return status_describe(ST_USAGE, "%s: \"%s\": expected whole numbers from %u to %u",
                                   what, text, lo, hi);
        out[a] = (uint32_t)sizes[a];
    }
    return st;
}

status cli_dims(const char *text, const char *what, uint32_t lo, uint32_t hi, uint32_t out[3]) {
    return parse_dims(text, what, lo, hi, 3, out);
}

status cli_dims_or_one(const char *text, const char *what, uint32_t lo, uint32_t hi,
                       uint32_t out[3], int *count) {
    *count = text[strcspn(text, ", x")] ? 3 : 1;
    memset(out, 0, 3 * sizeof *out);
    return parse_dims(text, what, lo, hi, *count, out);
}

status cli_sample_type(const char *text, sample_type *out) {
    if (sample_parse(text, out))
        return ST_OK;
    return status_describe(
        ST_USAGE, "--type: \"%s\" is none of u8 i8 u16 i16 u32 i32 u64 i64 f16 f32 f64", text);
}

/* Print "a|b" as "a, b". */
static const char *list_words(const char *words, char *out, size_t room) {
    size_t n = 0;
    for (const char *at = words; *at && n + 3 < room; at++) {
        out[n++] = *at == '|' ? ',' : *at;
        if (*at == '|')
            out[n++] = ' ';
    }
    out[n] = 0;
    return out;
}

status cli_word(const char *text, const char *what, const char *words, int *index) {
    const size_t size = strlen(text);
    const char *at = words;
    for (int i = 0;; i++) {
        const size_t n = strcspn(at, "|");
        if (n == size && memcmp(at, text, n) == 0) {
            *index = i;
            return ST_OK;
        }
        if (!at[n])
            break;
        at += n + 1;
    }
    char list[256];
    return status_describe(ST_USAGE, "%s: \"%s\" is none of %s", what, text,
                           list_words(words, list, sizeof list));
}
