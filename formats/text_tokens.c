#include "formats/text_tokens.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/num.h"
#include "formats/token_stream.h"

static bool is_gap(const text_tokens *t, uint8_t c) {
    return c == ' ' || (c >= '\t' && c <= '\r') || (t->commas && (c == ',' || c == ';'));
}

static status fault_at(const text_tokens *t, const char *expected) {
    if (!t->token[0])
        return status_describe(ST_CORRUPT, "%s: line %llu: nothing more here, expected %s",
                               byte_stream_name(t->s), (unsigned long long)t->line, expected);
    return status_describe(ST_CORRUPT, "%s: line %llu: \"%.60s\", expected %s",
                           byte_stream_name(t->s), (unsigned long long)t->line, t->token, expected);
}

status text_tokens_fault(const text_tokens *t, const char *fmt, ...) {
    char expected[400];
    va_list list;
    va_start(list, fmt);
    vsnprintf(expected, sizeof expected, fmt, list);
    va_end(list);
    return fault_at(t, expected);
}

/* Up to the next word, or to the line feed when this line is all that matters. */
static status skip_gaps(text_tokens *t, bool one_line, bool *found) {
    bool comment = false;
    *found = false;
    for (;;) {
        const uint8_t *data;
        size_t size, i;
        status st = byte_stream_peek(t->s, 1, &data, &size);
        if (st != ST_OK || size == 0)
            return st;
        for (i = 0; i < size; i++) {
            uint8_t c = data[i];
            if (c == '\n') {
                if (one_line)
                    break;
                t->line++;
                comment = false;
            } else if (t->comment && c == (uint8_t)t->comment) {
                comment = true;
            } else if (!comment && !is_gap(t, c)) {
                *found = true;
                break;
            }
        }
        byte_stream_take(t->s, i);
        if (i < size)
            return ST_OK;
    }
}

status text_tokens_more(text_tokens *t, bool *more) {
    return skip_gaps(t, true, more);
}

/* The word in front of which the stream stands. */
static status take_token(text_tokens *t) {
    const uint8_t *data;
    size_t size, length = 0;
    status st = byte_stream_peek(t->s, TEXT_TOKEN_MAX + 1, &data, &size);
    if (st != ST_OK)
        return st;
    while (length < size && length <= TEXT_TOKEN_MAX && data[length] && !is_gap(t, data[length]) &&
           !(t->comment && data[length] == (uint8_t)t->comment))
        length++;
    if (length > TEXT_TOKEN_MAX || (length < size && !data[length]))
        return status_describe(ST_CORRUPT, "%s: line %llu: no text at byte %llu",
                               byte_stream_name(t->s), (unsigned long long)t->line,
                               (unsigned long long)byte_stream_position(t->s));
    memcpy(t->token, data, length);
    t->token[length] = 0;
    byte_stream_take(t->s, length);
    return ST_OK;
}

status text_tokens_next(text_tokens *t) {
    bool found;
    t->token[0] = 0;
    status st = skip_gaps(t, false, &found);
    return st == ST_OK && found ? take_token(t) : st;
}

status text_tokens_end_line(text_tokens *t) {
    bool more;
    t->token[0] = 0;
    status st = skip_gaps(t, true, &more);
    if (st == ST_OK && more) {
        st = take_token(t);
        return st == ST_OK ? fault_at(t, "the end of the line") : st;
    }
    const uint8_t *data;
    size_t size;
    if (st == ST_OK)
        st = byte_stream_peek(t->s, 1, &data, &size);
    if (st == ST_OK && size > 0) {
        byte_stream_take(t->s, 1);
        t->line++;
    }
    return st;
}

status text_tokens_rest(text_tokens *t, char *text, size_t size) {
    bool more;
    size_t length = 0;
    status st = skip_gaps(t, true, &more);
    while (st == ST_OK && more) {
        const uint8_t *data;
        size_t held;
        st = byte_stream_peek(t->s, 1, &data, &held);
        if (st != ST_OK || held == 0 || *data == '\n')
            break;
        if (length + 1 == size || !*data)
            return status_describe(ST_CORRUPT, "%s: line %llu: expected a text of up to %zu bytes",
                                   byte_stream_name(t->s), (unsigned long long)t->line, size - 1);
        text[length++] = (char)*data;
        byte_stream_take(t->s, 1);
    }
    while (length > 0 && is_gap(t, (uint8_t)text[length - 1]))
        length--;
    text[length] = 0;
    return st == ST_OK ? text_tokens_end_line(t) : st;
}

status text_tokens_double(text_tokens *t, const char *what, double *out) {
    status st = text_tokens_next(t);
    if (st == ST_OK && !token_stream_double(t->token, out))
        return fault_at(t, what);
    return st;
}

status text_tokens_int(text_tokens *t, const char *what, int64_t lo, int64_t hi, int64_t *out) {
    status st = text_tokens_next(t);
    if (st == ST_OK && num_int(t->token, "", lo, hi, out) != ST_OK)
        return fault_at(t, what);
    return st;
}
