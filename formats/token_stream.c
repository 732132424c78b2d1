#include "formats/token_stream.h"

#include "formats/base/num.h"

static bool is_gap(uint8_t c) {
    return c == ' ' || (c >= '\t' && c <= '\r');
}

/* nan and inf are numbers. */
static bool starts_word(uint8_t c) {
    bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    return letter && !(c == 'n' || c == 'N' || c == 'i' || c == 'I');
}

/* Pass over blanks; *more is false at the end, or before a '<'. */
static status skip_gap(byte_stream *s, bool *more) {
    for (;;) {
        const uint8_t *data;
        size_t size, i = 0;
        status st = byte_stream_peek(s, 1, &data, &size);
        if (st != ST_OK)
            return st;
        while (i < size && is_gap(data[i]))
            i++;
        *more = i < size && data[i] != '<';
        bool ended = i < size || size == 0;
        byte_stream_take(s, i);
        if (ended)
            return ST_OK;
    }
}

status token_stream_next(byte_stream *s, char token[TOKEN_STREAM_MAX]) {
    const uint8_t *data;
    size_t size, length = 0;
    bool more;
    token[0] = 0;
    status st = skip_gap(s, &more);
    if (st != ST_OK || !more)
        return st;
    st = byte_stream_peek(s, TOKEN_STREAM_MAX, &data, &size);
    if (st != ST_OK)
        return st;
    while (length < size && length < TOKEN_STREAM_MAX && !is_gap(data[length]) &&
           data[length] != '<') {
        token[length] = (char)data[length];
        length++;
    }
    if (length == TOKEN_STREAM_MAX)
        return status_describe(ST_CORRUPT, "%s: byte %llu: expected a number, not a long word",
                               byte_stream_name(s), (unsigned long long)byte_stream_position(s));
    token[length] = 0;
    byte_stream_take(s, length);
    return ST_OK;
}

status token_stream_skip(byte_stream *s, uint64_t count, uint64_t *got) {
    for (*got = 0; *got < count; ++*got) {
        bool more, inside = true;
        status st = skip_gap(s, &more);
        const uint8_t *data;
        size_t size;
        if (st == ST_OK && more)
            st = byte_stream_peek(s, 1, &data, &size);
        if (st != ST_OK || !more || starts_word(data[0]))
            return st;
        while (inside) {
            size_t i = 0;
            st = byte_stream_peek(s, 1, &data, &size);
            if (st != ST_OK)
                return st;
            while (i < size && !is_gap(data[i]) && data[i] != '<')
                i++;
            inside = i == size && size > 0;
            byte_stream_take(s, i);
        }
    }
    return ST_OK;
}

/* Both numbers are exact doubles, so one operation rounds once: correctly. Up to 19 digits. */
static bool scale_exactly(uint64_t digits, int exponent, double *out) {
    static const double power[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                   1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                   1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    if (digits > (uint64_t)1 << 53 || exponent < -22 || exponent > 22)
        return false;
    *out = exponent < 0 ? (double)digits / power[-exponent] : (double)digits * power[exponent];
    return true;
}

/* A plain decimal, the usual case; false when it takes strtod() to tell. */
static bool plain_double(const char *at, double *out) {
    bool negative = *at == '-', negative_power;
    uint64_t digits = 0;
    int count = 0, exponent = 0, power = 0, behind = 0;
    at += negative;
    for (; *at >= '0' && *at <= '9'; at++, count++)
        digits = 10 * digits + (uint64_t)(*at - '0');
    if (*at == '.')
        for (at++; *at >= '0' && *at <= '9'; at++, count++, exponent--)
            digits = 10 * digits + (uint64_t)(*at - '0');
    if (count == 0 || count > 19)
        return false;
    if (*at == 'e' || *at == 'E') {
        negative_power = at[1] == '-';
        at += at[1] == '-' || at[1] == '+' ? 2 : 1;
        for (; *at >= '0' && *at <= '9' && behind < 4; at++, behind++)
            power = 10 * power + (*at - '0');
        if (behind == 0)
            return false;
        exponent += negative_power ? -power : power;
    }
    if (*at || !scale_exactly(digits, exponent, out))
        return false;
    *out = negative ? -*out : *out;
    return true;
}

bool token_stream_double(const char *token, double *out) {
    return plain_double(token, out) || num_double(token, "", out) == ST_OK;
}

bool token_stream_whole(const char *token, uint64_t *out) {
    bool negative = *token == '-';
    const char *at = token + negative;
    int count = 0;
    *out = 0;
    for (; *at >= '0' && *at <= '9' && count < 19; at++, count++)
        *out = 10 * *out + (uint64_t)(*at - '0');
    if (negative || (*at >= '0' && *at <= '9')) {
        while (*at >= '0' && *at <= '9')
            at++;
        *out = UINT64_MAX;
    }
    return count > 0 && !*at;
}
