#include "formats/input/text_stream.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/num.h"

enum { TOKEN_MAX = 64 };

static bool is_gap(uint8_t c) {
    return c == ' ' || c == ',' || (c >= '\t' && c <= '\r');
}

/* Read the next token; empty at the end of the stream. */
static status next_token(byte_stream *s, char token[TOKEN_MAX]) {
    size_t length = 0;
    token[0] = 0;
    for (;;) {
        const uint8_t *data;
        size_t size, i;
        status st = byte_stream_peek(s, 1, &data, &size);
        if (st != ST_OK || size == 0)
            return st;
        for (i = 0; i < size && !(is_gap(data[i]) && length > 0); i++) {
            if (is_gap(data[i]))
                continue;
            if (length + 1 == TOKEN_MAX)
                return status_describe(ST_CORRUPT, "%s: byte %llu: expected a number",
                                       byte_stream_name(s),
                                       (unsigned long long)byte_stream_position(s) + i);
            token[length++] = (char)data[i];
            token[length] = 0;
        }
        byte_stream_take(s, i);
        if (i < size)
            return ST_OK;
    }
}

#define STORE(type)                   \
    {                                 \
        type v = (type)value;         \
        memcpy(sample, &v, sizeof v); \
        break;                        \
    }

static bool is_whole_within(double value, double lo, double hi) {
    return value >= lo && value <= hi && value == floor(value);
}

static bool fits(sample_type type, double value) {
    switch (type) {
    case SAMPLE_U8: return is_whole_within(value, 0, UINT8_MAX);
    case SAMPLE_I8: return is_whole_within(value, INT8_MIN, INT8_MAX);
    case SAMPLE_U16: return is_whole_within(value, 0, UINT16_MAX);
    case SAMPLE_I16: return is_whole_within(value, INT16_MIN, INT16_MAX);
    case SAMPLE_U32: return is_whole_within(value, 0, UINT32_MAX);
    case SAMPLE_I32: return is_whole_within(value, INT32_MIN, INT32_MAX);
    default: return true;
    }
}

static void store(sample_type type, double value, void *sample) {
    switch (type) {
    case SAMPLE_U8: STORE(uint8_t)
    case SAMPLE_I8: STORE(int8_t)
    case SAMPLE_U16: STORE(uint16_t)
    case SAMPLE_I16: STORE(int16_t)
    case SAMPLE_U32: STORE(uint32_t)
    case SAMPLE_I32: STORE(int32_t)
    case SAMPLE_F32: STORE(float)
    case SAMPLE_F64: STORE(double)
    default: break;
    }
}

/* Store a 64-bit integer, which a double cannot hold in every case. */
static bool store_wide(sample_type type, const char *token, void *sample) {
    char *end = NULL;
    errno = 0;
    if (!isdigit((unsigned char)token[*token == '-']) || (type == SAMPLE_U64 && *token == '-'))
        return false;
    if (type == SAMPLE_U64) {
        const uint64_t v = strtoull(token, &end, 10);
        memcpy(sample, &v, sizeof v);
    } else {
        const int64_t v = strtoll(token, &end, 10);
        memcpy(sample, &v, sizeof v);
    }
    return *end == 0 && errno == 0;
}

static bool store_token(sample_type type, const char *token, void *sample) {
    double value = 0;
    if (type == SAMPLE_U64 || type == SAMPLE_I64)
        return store_wide(type, token, sample);
    if (type == SAMPLE_F16 || num_double(token, "", &value) != ST_OK || !fits(type, value))
        return false;
    store(type, value, sample);
    return true;
}

status text_stream_read(byte_stream *s, sample_type type, void *samples, size_t count,
                        size_t *got) {
    for (*got = 0; *got < count; ++*got) {
        char token[TOKEN_MAX];
        status st = next_token(s, token);
        if (st != ST_OK || !*token)
            return st;
        if (!store_token(type, token, (char *)samples + *got * sample_size(type)))
            return status_describe(ST_CORRUPT,
                                   "%s: before byte %llu: \"%s\" is no sample of type %s",
                                   byte_stream_name(s), (unsigned long long)byte_stream_position(s),
                                   token, sample_name(type));
    }
    return ST_OK;
}
