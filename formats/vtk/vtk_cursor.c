#include "formats/vtk/vtk_cursor.h"

#include <assert.h>
#include <string.h>

#include "formats/input/byte_stream.h"
#include "formats/input/text_number.h"
#include "formats/input/text_tokens.h"
#include "formats/vtk/vtk_bytes.h"

enum { CURSOR_BYTES = 1 << 14 };

struct vtk_cursor {
    mem *m;
    const vtk_array *array;
    size_t width;
    uint64_t left;     /* numbers not yet handed out; VTK_CURSOR_ANY for text of any length */
    uint64_t taken;    /* numbers handed out */
    byte_stream *from; /* source of text and bare bytes */
    text_tokens text;  /* its words */
    vtk_bytes *bytes;  /* source of the other codings */
    size_t begin, end; /* filled part of buffer[], in numbers */
    uint8_t buffer[CURSOR_BYTES];
};

/* ---- opening ---- */

static status too_few(const vtk_cursor *c, uint64_t found, uint64_t wanted) {
    return vtk_array_fault(c->array, ST_CORRUPT, "has %llu numbers, expected %llu",
                           (unsigned long long)found, (unsigned long long)wanted);
}

/* Open bytes whose count the file states. */
static status open_counted(vtk_cursor *c, uint64_t count) {
    status st = vtk_bytes_open(c->m, c->array, &c->bytes);
    if (st != ST_OK)
        return st;
    uint64_t size = vtk_bytes_size(c->bytes);
    if (size % c->width)
        return vtk_array_fault(c->array, ST_CORRUPT, "has %llu bytes, expected a multiple of %zu",
                               (unsigned long long)size, c->width);
    c->left = size / c->width;
    return count == VTK_CURSOR_ANY || count == c->left ? ST_OK : too_few(c, c->left, count);
}

static status open_plain(vtk_cursor *c, uint64_t count) {
    status st = byte_stream_open(c->m, c->array->path, &c->from);
    if (st == ST_OK)
        st = byte_stream_skip(c->from, c->array->at);
    c->left = count;
    c->text = (text_tokens){.s = c->from, .stop = '<'};
    if (st != ST_OK)
        return st;
    /* A number takes a digit and a blank; the last one needs no blank. */
    const uint64_t left = byte_stream_left(c->from);
    uint64_t room = c->array->coding == VTK_TEXT ? left / 2 + 1 : left / c->width;
    return count != VTK_CURSOR_ANY && count > room ? too_few(c, room, count) : ST_OK;
}

static status open_array(vtk_cursor *c, uint64_t count) {
    const vtk_array *a = c->array;
    c->width = vtk_array_width(a->type);
    if (c->width == 0)
        return vtk_array_fault(a, ST_UNSUPPORTED, "strings and packed bits are no numbers here");
    bool plain = a->coding == VTK_TEXT || a->coding == VTK_BARE;
    return plain ? open_plain(c, count) : open_counted(c, count);
}

status vtk_cursor_open(mem *m, const vtk_array *a, uint64_t count, vtk_cursor **out) {
    vtk_cursor *c = mem_zalloc(m, sizeof *c);
    if (!c)
        return ST_NOMEM;
    c->m = m;
    c->array = a;
    status st = open_array(c, count);
    if (st != ST_OK) {
        vtk_cursor_close(c);
        return st;
    }
    *out = c;
    return ST_OK;
}

void vtk_cursor_close(vtk_cursor *c) {
    if (!c)
        return;
    byte_stream_close(c->from);
    vtk_bytes_close(c->bytes);
    mem_free(c->m, c);
}

/* ---- text ---- */

static status next_word(vtk_cursor *c) {
    status st = text_tokens_next(&c->text);
    return st == ST_OK && !c->text.token[0] ? too_few(c, c->taken, c->taken + 1) : st;
}

static status bad_word(const vtk_cursor *c, const char *expected) {
    return vtk_array_fault(c->array, ST_CORRUPT, "before byte %llu: \"%.60s\", expected a %snumber",
                           (unsigned long long)byte_stream_position(c->from), c->text.token,
                           expected);
}

/* Read count numbers of text. out: doubles, or whole numbers. */
static status text_numbers(vtk_cursor *c, size_t count, bool whole, void *out) {
    for (size_t i = 0; i < count; i++, c->taken++) {
        status st = next_word(c);
        const bool good =
            st == ST_OK && (whole ? text_number_whole(c->text.token, (uint64_t *)out + i)
                                  : text_number_double(c->text.token, (double *)out + i));
        if (st == ST_OK && !good)
            st = bad_word(c, whole ? "whole " : "");
        if (st != ST_OK)
            return st;
    }
    return ST_OK;
}

#define WHOLE(type, lo, hi)                                \
    {                                                      \
        int64_t i;                                         \
        bool good = text_number_int(word, (lo), (hi), &i); \
        type v = good ? (type)i : 0;                       \
        memcpy(out, &v, sizeof v);                         \
        return good;                                       \
    }

/* Store a word as a number of the type. Returns false when it is none. */
static bool word_of_type(vtk_type type, const char *word, void *out) {
    double real = 0;
    uint64_t whole = 0;
    switch (type) {
    case VTK_I8: WHOLE(int8_t, INT8_MIN, INT8_MAX)
    case VTK_U8: WHOLE(uint8_t, 0, UINT8_MAX)
    case VTK_I16: WHOLE(int16_t, INT16_MIN, INT16_MAX)
    case VTK_U16: WHOLE(uint16_t, 0, UINT16_MAX)
    case VTK_I32: WHOLE(int32_t, INT32_MIN, INT32_MAX)
    case VTK_U32: WHOLE(uint32_t, 0, UINT32_MAX)
    case VTK_I64: WHOLE(int64_t, INT64_MIN, INT64_MAX)
    case VTK_U64:
        if (*word == '-' || !text_number_whole(word, &whole))
            return false;
        memcpy(out, &whole, sizeof whole);
        return true;
    default: break;
    }
    if (!text_number_double(word, &real))
        return false;
    const float single = (float)real;
    memcpy(out, type == VTK_F32 ? (const void *)&single : &real, vtk_array_width(type));
    return true;
}

static status text_raw(vtk_cursor *c, size_t count, uint8_t *out) {
    for (size_t i = 0; i < count; i++, c->taken++, out += c->width) {
        status st = next_word(c);
        if (st == ST_OK && !word_of_type(c->array->type, c->text.token, out))
            st = vtk_array_fault(c->array, ST_CORRUPT,
                                 "before byte %llu: \"%.60s\", expected a number of its type",
                                 (unsigned long long)byte_stream_position(c->from), c->text.token);
        if (st != ST_OK)
            return st;
    }
    return ST_OK;
}

/* ---- bytes ---- */

static void swap(uint8_t *bytes, size_t width, size_t count) {
    for (size_t i = 0; width > 1 && i < count; i++, bytes += width)
        for (size_t b = 0; b < width / 2; b++) {
            uint8_t kept = bytes[b];
            bytes[b] = bytes[width - 1 - b];
            bytes[width - 1 - b] = kept;
        }
}

/* Read count of the numbers that are left, in native byte order. */
static status read_bytes(vtk_cursor *c, size_t count, void *out) {
    size_t size = count * c->width, got;
    status st;
    if (c->bytes)
        st = vtk_bytes_read(c->bytes, out, size);
    else {
        st = byte_stream_read(c->from, out, size, &got);
        if (st == ST_OK && got < size)
            st = too_few(c, c->taken + got / c->width, c->taken + c->left);
    }
    if (st == ST_OK && c->array->big_endian)
        swap(out, c->width, count);
    return st;
}

/* Fill the empty buffer. */
static status refill(vtk_cursor *c) {
    size_t room = CURSOR_BYTES / c->width;
    size_t count = c->left < room ? (size_t)c->left : room;
    status st = read_bytes(c, count, c->buffer);
    if (st != ST_OK)
        return st;
    c->begin = 0;
    c->end = count;
    return ST_OK;
}

/* Hand out at least one number, at most *count, in the buffer at *from. */
static status some(vtk_cursor *c, size_t *count, const uint8_t **from) {
    status st = c->begin == c->end ? refill(c) : ST_OK;
    if (st != ST_OK)
        return st;
    size_t held = c->end - c->begin;
    *count = *count < held ? *count : held;
    *from = c->buffer + c->begin * c->width;
    c->begin += *count;
    c->taken += *count;
    c->left -= *count;
    return ST_OK;
}

#define ALL(type, convert)                         \
    for (size_t i = 0; i < count; i++) {           \
        type v;                                    \
        memcpy(&v, from + i * sizeof v, sizeof v); \
        out[i] = convert;                          \
    }                                              \
    break

static void to_doubles(vtk_type type, const uint8_t *from, size_t count, double *out) {
    switch (type) {
    case VTK_I8: ALL(int8_t, v);
    case VTK_U8: ALL(uint8_t, v);
    case VTK_I16: ALL(int16_t, v);
    case VTK_U16: ALL(uint16_t, v);
    case VTK_I32: ALL(int32_t, v);
    case VTK_U32: ALL(uint32_t, v);
    case VTK_I64: ALL(int64_t, (double)v);
    case VTK_U64: ALL(uint64_t, (double)v);
    case VTK_F32: ALL(float, (double)v);
    case VTK_F64: ALL(double, v);
    default: break;
    }
}

#define NOT_NEGATIVE (v < 0 ? UINT64_MAX : (uint64_t)v)

static void to_whole(vtk_type type, const uint8_t *from, size_t count, uint64_t *out) {
    switch (type) {
    case VTK_I8: ALL(int8_t, NOT_NEGATIVE);
    case VTK_U8: ALL(uint8_t, v);
    case VTK_I16: ALL(int16_t, NOT_NEGATIVE);
    case VTK_U16: ALL(uint16_t, v);
    case VTK_I32: ALL(int32_t, NOT_NEGATIVE);
    case VTK_U32: ALL(uint32_t, v);
    case VTK_I64: ALL(int64_t, NOT_NEGATIVE);
    case VTK_U64: ALL(uint64_t, v);
    default: break;
    }
}

/* ---- reading ---- */

static status check_left(const vtk_cursor *c, size_t count) {
    return count > c->left ? too_few(c, c->taken + c->left, c->taken + count) : ST_OK;
}

static status read_numbers(vtk_cursor *c, size_t count, bool whole, void *out) {
    status st = check_left(c, count);
    if (st == ST_OK && c->array->coding == VTK_TEXT) {
        c->left -= c->left == VTK_CURSOR_ANY ? 0 : count;
        return text_numbers(c, count, whole, out);
    }
    for (size_t done = 0, part; st == ST_OK && done < count; done += part) {
        const uint8_t *from;
        part = count - done;
        st = some(c, &part, &from);
        if (st == ST_OK && whole)
            to_whole(c->array->type, from, part, (uint64_t *)out + done);
        else if (st == ST_OK)
            to_doubles(c->array->type, from, part, (double *)out + done);
    }
    return st;
}

status vtk_cursor_doubles(vtk_cursor *c, size_t count, double *out) {
    return read_numbers(c, count, false, out);
}

status vtk_cursor_whole(vtk_cursor *c, size_t count, uint64_t *out) {
    assert(vtk_array_whole(c->array->type));
    return read_numbers(c, count, true, out);
}

status vtk_cursor_raw(vtk_cursor *c, size_t count, void *out) {
    assert(c->begin == c->end);
    const bool is_text = c->array->coding == VTK_TEXT;
    const uint64_t before = c->left;
    status st = check_left(c, count);
    if (st == ST_OK)
        st = is_text ? text_raw(c, count, out) : read_bytes(c, count, out);
    c->left -= before == VTK_CURSOR_ANY ? 0 : count;
    c->taken += is_text ? 0 : count;
    return st;
}

status vtk_cursor_finish(vtk_cursor *c) {
    const vtk_array *a = c->array;
    if (a->coding == VTK_TEXT && a->line > 0) {
        status st = text_tokens_next(&c->text);
        if (st != ST_OK || !c->text.token[0])
            return st;
        return vtk_array_fault(a, ST_CORRUPT, "\"%.60s\" behind its last number, expected %llu",
                               c->text.token, (unsigned long long)c->taken);
    }
    return a->coding != VTK_TEXT && c->left > 0 ? too_few(c, c->taken + c->left, c->taken) : ST_OK;
}
