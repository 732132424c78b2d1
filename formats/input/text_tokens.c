#include "formats/input/text_tokens.h"

#include <assert.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "formats/input/text_number.h"

static bool is_gap(const text_tokens *t, uint8_t c) {
    return c == ' ' || (c >= '\t' && c <= '\r') || (t->commas && (c == ',' || c == ';'));
}

/* Returns whether a byte belongs to a word. Nearly all of a word's bytes pass the first test. */
static bool is_word(const text_tokens *t, uint8_t c) {
    if (c > '<' && c != (uint8_t)t->comment && c != (uint8_t)t->stop)
        return true;
    return c != 0 && !is_gap(t, c) && c != (uint8_t)t->comment && c != (uint8_t)t->stop;
}

static status fault_in(const text_tokens *t, const char *said) {
    unsigned long long line = t->line, byte = byte_stream_position(t->s);
    return status_describe(ST_CORRUPT, "%s: %s %llu: %s", byte_stream_name(t->s),
                           line ? "line" : "byte", line ? line : byte, said);
}

static status fault_at(const text_tokens *t, const char *expected) {
    char said[500];
    if (t->token[0])
        snprintf(said, sizeof said, "\"%.60s\", expected %s", t->token, expected);
    else
        snprintf(said, sizeof said, "nothing more here, expected %s", expected);
    return fault_in(t, said);
}

status text_tokens_fault(const text_tokens *t, const char *fmt, ...) {
    char expected[400];
    va_list list;
    va_start(list, fmt);
    vsnprintf(expected, sizeof expected, fmt, list);
    va_end(list);
    return fault_at(t, expected);
}

/* Skip to the next word; if one_line, at most to the line feed. */
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
                t->line += t->line > 0;
                comment = false;
            } else if (t->comment && c == (uint8_t)t->comment) {
                comment = true;
            } else if (!comment && !is_gap(t, c)) {
                *found = !t->stop || c != (uint8_t)t->stop;
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

/* Take the word that the stream stands in front of. */
static status take_token(text_tokens *t) {
    const uint8_t *data;
    size_t size, length = 0;
    status st = byte_stream_peek(t->s, TEXT_TOKEN_MAX + 1, &data, &size);
    if (st != ST_OK)
        return st;
    while (length < size && length <= TEXT_TOKEN_MAX && is_word(t, data[length]))
        length++;
    if (length > TEXT_TOKEN_MAX || (length < size && !data[length])) {
        char said[100];
        snprintf(said, sizeof said, "no text at byte %llu",
                 (unsigned long long)byte_stream_position(t->s));
        return fault_in(t, said);
    }
    memcpy(t->token, data, length);
    t->token[length] = 0;
    byte_stream_take(t->s, length);
    return ST_OK;
}

/* The usual case, in one go: blanks without a comment, and a word whose end is in the buffer. */
static status next_in_sight(text_tokens *t, bool *done) {
    const uint8_t *data;
    size_t size, i = 0, lines = 0;
    status st = byte_stream_peek(t->s, TEXT_TOKEN_MAX + 1, &data, &size);
    if (st != ST_OK)
        return st;
    for (; i < size && is_gap(t, data[i]); i++)
        lines += data[i] == '\n';
    size_t from = i;
    while (i < size && is_word(t, data[i]))
        i++;
    size_t length = i - from;
    *done = length > 0 && length <= TEXT_TOKEN_MAX && i < size && data[i];
    if (!*done)
        return ST_OK;
    memcpy(t->token, data + from, length);
    t->token[length] = 0;
    t->line += t->line > 0 ? lines : 0;
    byte_stream_take(t->s, i);
    return ST_OK;
}

status text_tokens_next(text_tokens *t) {
    bool done = false;
    t->token[0] = 0;
    status st = next_in_sight(t, &done);
    if (st != ST_OK || done)
        return st;
    st = skip_gaps(t, false, &done);
    return st == ST_OK && done ? take_token(t) : st;
}

/* Returns whether a word that begins so is no number. nan and inf are numbers. */
static bool starts_text(uint8_t c) {
    bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    return letter && !(c == 'n' || c == 'N' || c == 'i' || c == 'I');
}

/* Count words in what is buffered. Returns how many bytes to skip. */
static size_t skip_in_sight(text_tokens *t, const uint8_t *data, size_t size, uint64_t count,
                            uint64_t *got, bool *inside) {
    for (size_t i = 0; i < size; i++) {
        bool gap = is_gap(t, data[i]);
        bool stop = t->stop && data[i] == (uint8_t)t->stop;
        if (stop || (*inside ? gap && *got == count : starts_text(data[i])))
            return i;
        t->line += t->line > 0 && data[i] == '\n';
        *got += !gap && !*inside;
        *inside = !gap;
    }
    return size;
}

status text_tokens_skip(text_tokens *t, uint64_t count, uint64_t *got) {
    bool inside = false;
    size_t passed = 0, size = 0;
    assert(!t->comment);
    *got = 0;
    while (passed == size && count > 0) {
        const uint8_t *data;
        status st = byte_stream_peek(t->s, 1, &data, &size);
        if (st != ST_OK || size == 0)
            return st;
        passed = skip_in_sight(t, data, size, count, got, &inside);
        byte_stream_take(t->s, passed);
    }
    return ST_OK;
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
        if (length + 1 == size || !*data) {
            char said[100];
            snprintf(said, sizeof said, "expected a text of up to %zu bytes", size - 1);
            return fault_in(t, said);
        }
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
    if (st == ST_OK && !text_number_double(t->token, out))
        return fault_at(t, what);
    return st;
}

status text_tokens_int(text_tokens *t, const char *what, int64_t lo, int64_t hi, int64_t *out) {
    status st = text_tokens_next(t);
    if (st == ST_OK && !text_number_int(t->token, lo, hi, out))
        return fault_at(t, what);
    return st;
}

status text_tokens_double_here(text_tokens *t, const char *what, double *out) {
    bool more;
    status st = text_tokens_more(t, &more);
    if (st == ST_OK && !more) {
        t->token[0] = 0;
        return text_tokens_fault(t, "%s", what);
    }
    return st == ST_OK ? text_tokens_double(t, what, out) : st;
}

status text_tokens_int_here(text_tokens *t, const char *what, int64_t lo, int64_t hi,
                            int64_t absent, int64_t *out) {
    bool more;
    *out = absent;
    status st = text_tokens_more(t, &more);
    return st == ST_OK && more ? text_tokens_int(t, what, lo, hi, out) : st;
}
