#include "formats/input/base64_stream.h"

static bool is_gap(uint8_t c) {
    return c == ' ' || (c >= '\t' && c <= '\r');
}

/* Returns the six bits of a letter; -1 when it is none. */
static int letter_bits(uint8_t c) {
    if (c >= 'A' && c <= 'Z')
        return c - 'A';
    if (c >= 'a' && c <= 'z')
        return c - 'a' + 26;
    if (c >= '0' && c <= '9')
        return c - '0' + 52;
    return c == '+' ? 62 : c == '/' ? 63 : -1;
}

static status fault(const base64_stream *s, size_t ahead, const char *what) {
    return status_describe(ST_CORRUPT, "%s: byte %llu: %s", byte_stream_name(s->from),
                           (unsigned long long)(byte_stream_position(s->from) + ahead), what);
}

/* Take one more letter of a group. Returns false when it cannot stand here. */
static bool take_letter(base64_stream *s, uint8_t c) {
    int bits = c == '=' ? 0 : letter_bits(c);
    if (bits < 0 || (c == '=' && s->letters < 2) || (c != '=' && s->padding > 0))
        return false;
    s->padding += c == '=';
    s->bits = s->bits << 6 | (uint32_t)bits;
    if (++s->letters < 4)
        return true;
    for (int i = 0; i < 3; i++)
        s->held[i] = (uint8_t)(s->bits >> (16 - 8 * i));
    s->begin = 0;
    s->end = 3 - s->padding;
    s->letters = s->padding = 0;
    s->bits = 0;
    return true;
}

/* Take letters up to the end of a group, or of the text. */
static status next_group(base64_stream *s) {
    const uint8_t *data;
    size_t size;
    while (s->begin == s->end && !s->ended) {
        status st = byte_stream_peek(s->from, 1, &data, &size);
        if (st != ST_OK)
            return st;
        size_t i = 0;
        s->ended = size == 0 || data[0] == '<';
        for (; i < size && s->begin == s->end && data[i] != '<'; i++)
            if (!is_gap(data[i]) && !take_letter(s, data[i]))
                return fault(s, i, "expected base64");
        byte_stream_take(s->from, i);
    }
    if (s->ended && s->letters > 0)
        return fault(s, 0, "the base64 text ends inside a group of four letters");
    return ST_OK;
}

/* The common case: decode whole groups without gaps or padding, straight from the stream's buffer.
 */
static status take_plain(base64_stream *s, uint8_t *to, size_t size, size_t *got) {
    const uint8_t *data;
    size_t held, i = 0;
    if (s->letters > 0 || s->begin < s->end || size < 3)
        return ST_OK;
    status st = byte_stream_peek(s->from, 4, &data, &held);
    if (st != ST_OK)
        return st;
    for (; i + 4 <= held && *got + 3 <= size; i += 4) {
        int b[4] = {letter_bits(data[i]), letter_bits(data[i + 1]), letter_bits(data[i + 2]),
                    letter_bits(data[i + 3])};
        if ((b[0] | b[1] | b[2] | b[3]) < 0)
            break;
        to[(*got)++] = (uint8_t)(b[0] << 2 | b[1] >> 4);
        to[(*got)++] = (uint8_t)((b[1] & 15) << 4 | b[2] >> 2);
        to[(*got)++] = (uint8_t)((b[2] & 3) << 6 | b[3]);
    }
    byte_stream_take(s->from, i);
    return ST_OK;
}

status base64_stream_read(base64_stream *s, void *buffer, size_t size, size_t *got) {
    uint8_t *to = buffer;
    *got = 0;
    while (*got < size) {
        if (!s->ended) {
            status st = take_plain(s, to, size, got);
            if (st == ST_OK && *got < size && s->begin == s->end)
                st = next_group(s);
            if (st != ST_OK)
                return st;
        }
        if (s->begin == s->end && s->ended)
            break;
        while (s->begin < s->end && *got < size)
            to[(*got)++] = s->held[s->begin++];
    }
    return ST_OK;
}
