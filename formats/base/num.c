#include "formats/base/num.h"

#include <errno.h>
#include <locale.h>
#include <math.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The C locale, made once and kept: the program may have set another one. */
static locale_t plain;
static pthread_once_t plain_once = PTHREAD_ONCE_INIT;

static void make_plain(void) {
    plain = newlocale(LC_ALL_MASK, "C", (locale_t)0);
}

static locale_t plain_locale(void) {
    pthread_once(&plain_once, make_plain);
    return plain;
}

/* Whether a number may start here: strtod() and strtoll() would skip blanks. */
static bool starts_number(const char *text) {
    return *text && !strchr(" \t\n\v\f\r", *text);
}

/* Parse the double that a text starts with. Returns its end, or NULL where there is none. *out is
 * +-inf when it is too large. */
static const char *scan_double(const char *text, double *out) {
    if (!starts_number(text))
        return NULL;
    char *end = NULL;
    *out = strtod_l(text, &end, plain_locale());
    return end == text ? NULL : end;
}

static bool says_infinity(const char *text) {
    text += *text == '-' || *text == '+';
    return *text == 'i' || *text == 'I';
}

status num_double(const char *text, const char *what, double *out) {
    double value = 0;
    const char *end = scan_double(text, &value);
    if (!end || *end)
        return status_describe(ST_USAGE, "%s: \"%s\" is not a number", what, text);
    if (isinf(value) && !says_infinity(text))
        return status_describe(ST_USAGE, "%s: \"%s\" is too large for a double", what, text);
    *out = value;
    return ST_OK;
}

status num_int(const char *text, const char *what, int64_t lo, int64_t hi, int64_t *out) {
    char *end = NULL;
    errno = 0;
    long long value = starts_number(text) ? strtoll(text, &end, 10) : 0;
    if (!end || end == text || *end)
        return status_describe(ST_USAGE, "%s: \"%s\" is not a whole number", what, text);
    if (errno == ERANGE || value < lo || value > hi)
        return status_describe(ST_USAGE, "%s: \"%s\" is not in %lld .. %lld", what, text,
                               (long long)lo, (long long)hi);
    *out = value;
    return ST_OK;
}

/* The factor of a size's suffix: "", "K", "M", "G", "T", each also with "B" or "iB"; 0 for anything
 * else. */
static double size_unit(const char *suffix) {
    static const char letters[] = "KMGT";
    double unit = 1;
    const char *at = *suffix ? strchr(letters, *suffix & ~0x20) : NULL;
    if (at) {
        unit = ldexp(1, 10 * (int)(at - letters + 1));
        suffix++;
        suffix += *suffix == 'i';
    }
    suffix += *suffix == 'B';
    return *suffix ? 0 : unit;
}

status num_size(const char *text, const char *what, uint64_t *out) {
    double value = 0;
    const char *end = scan_double(text, &value);
    double unit = end && isfinite(value) ? size_unit(end) : 0;
    if (unit == 0 || value < 0)
        return status_describe(ST_USAGE, "%s: \"%s\" is not a size, such as 500000, 256M or 1.5G",
                               what, text);
    if (value * unit >= 0x1p63)
        return status_describe(ST_USAGE, "%s: \"%s\" is too large", what, text);
    *out = (uint64_t)(value * unit);
    return ST_OK;
}

/* Copy one field of a list: up to the next separator. Skip blanks around it if they are separators.
 * Returns where the field ends. */
static const char *take_field(const char *text, const char *separators, char *field, size_t room) {
    const char *blanks = strchr(separators, ' ') ? " \t" : "";
    text += strspn(text, blanks);
    size_t length = strcspn(text, separators);
    if (*blanks)
        length = strcspn(text, " \t") < length ? strcspn(text, " \t") : length;
    size_t kept = length < room ? length : room - 1;
    memcpy(field, text, kept);
    field[kept] = 0;
    text += length;
    return text + strspn(text, blanks);
}

status num_doubles(const char *text, const char *what, const char *separators, int count,
                   double *out) {
    const char *rest = text;
    for (int i = 0; i < count; i++) {
        char field[64];
        const char *start = rest;
        rest = take_field(rest, separators, field, sizeof field);
        double value = 0;
        const char *end = scan_double(field, &value);
        if (!end || *end)
            return status_describe(ST_USAGE, "%s: \"%s\" is not a list of %d numbers", what, text,
                                   count);
        out[i] = value;
        /* Skip a separator other than blanks only between two fields, never behind the last. */
        bool parted = rest > start && *rest && !strchr(" \t", *rest) && strchr(separators, *rest);
        if (parted && i + 1 < count)
            rest++;
    }
    if (*rest)
        return status_describe(ST_USAGE, "%s: \"%s\" is not a list of %d numbers", what, text,
                               count);
    return ST_OK;
}

static const char *print(double value, bool is_float, char buffer[NUM_TEXT_MAX]) {
    locale_t before = uselocale(plain_locale());
    for (int digits = 1; digits <= 17; digits++) {
        snprintf(buffer, NUM_TEXT_MAX, "%.*g", digits, value);
        const double read = strtod(buffer, NULL);
        if ((is_float ? (double)(float)read : read) == value || isnan(value))
            break;
    }
    /* Print 80, not 8e+01: use an exponent only where the digits would be many. */
    if (fabs(value) < 1e15 && strstr(buffer, "e+"))
        snprintf(buffer, NUM_TEXT_MAX, "%.0f", value);
    uselocale(before);
    return buffer;
}

const char *num_print(double value, char buffer[NUM_TEXT_MAX]) {
    return print(value, false, buffer);
}

const char *num_print_float(float value, char buffer[NUM_TEXT_MAX]) {
    return print((double)value, true, buffer);
}

void num_print_list(char *text, size_t room, const double *x, int count) {
    size_t n = 0;
    text[0] = 0;
    for (int i = 0; i < count; i++) {
        char number[NUM_TEXT_MAX];
        const size_t length = strlen(num_print(x[i], number));
        if (n + length + 2 > room)
            break;
        if (n)
            text[n++] = ',';
        memcpy(text + n, number, length + 1);
        n += length;
    }
}
